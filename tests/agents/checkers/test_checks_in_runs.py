"""Runs of the benchmark with a checker that looks: pictures follow from the roles, and entries say who checks."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from chaos_server import ChaosServer, says
from remac_bench import judging
from remac_bench.errors import UsageError
from remac_bench.judging.episodes import setting
from remac_bench.playing import sight, suites
from remac_bench.playing.agents import Access
from remac_bench.playing.job_lists import make_jobs
from remac_bench.playing.jobs import Job
from remac_bench.playing.runner import Settings, run_jobs
from remac_bench.records import Record
from remac_bench.store import Store

import remac_agents
import remac_env
from remac_agents.methods import METHODS
from remac_agents.roles import Verdict, View
from remac_env.errors import OptionError
from remac_env.rules.conditions import Condition

EYES, BLIND = "openai:o3", "deepseek:deepseek-reasoner"
TASK = "DefrostInBowl"


def jobs(methods: str, agent: dict[str, Any], *, url: str | None = None, **kitchen: Any) -> list[Job]:
    return make_jobs(
        tasks=[TASK],
        methods=methods.split(","),
        seeds=range(1),
        kitchen={"backend": "symbolic", **kitchen},
        agent=agent,
        access=Access(base_url=url),
    )


def options_of(methods: str, agent: dict[str, Any], **kitchen: Any) -> dict[str, tuple[str, int]]:
    return {job.method: (job.options.obs, job.options.image_size) for job in jobs(methods, agent, **kitchen)}


@pytest.mark.parametrize("agent", [{"model": EYES}, {"checker": EYES}, {"model": BLIND, "checker": EYES}])
def test_pictures_follow_from_who_looks(agent: dict[str, Any]) -> None:
    looked = ("state+images", 512)
    assert options_of("BASE,SMART-LLM,CC,CAPE,BASE-BEST", agent) == {
        "BASE": ("state", 128),
        "SMART-LLM": ("state", 128),
        "CC": looked,
        "CAPE": looked,
        "BASE-BEST": ("state", 128),
    }
    assert options_of("CC", agent, image_size=64) == {"CC": ("state+images", 64)}
    with pytest.raises(UsageError, match=r"obs 'state' is not valid for a checker .*valid: state\+images"):
        jobs("CC", agent, obs="state")


def test_who_needs_small_pictures_is_drawn_small_ones() -> None:
    assert options_of("BASE,CC", {"checker": "vision"}) == {"BASE": ("state", 128), "CC": ("state+images", 96)}
    assert options_of("CC", {"checker": "vision"}, image_size=256) == {"CC": ("state+images", 256)}


@pytest.mark.parametrize("agent", [{}, {"checker": "noisy"}, {"model": BLIND}, {"model": EYES, "checker": "truth"}])
def test_nobody_draws_for_who_does_not_look(agent: dict[str, Any]) -> None:
    assert options_of("CC", agent) == {"CC": ("state", 128)}
    assert options_of("CC", agent, obs="state+images", image_size=32) == {"CC": ("state+images", 32)}


def test_pictures_follow_in_suites_too() -> None:
    (smoke,) = [suites.load("smoke")]
    seen = {(job.method, job.options.obs, job.options.image_size) for job in smoke.jobs([{"model": EYES}])}
    assert {obs for method, obs, _ in seen if not sight.checks(method)} <= {"state"}
    assert {(obs, size) for method, obs, size in seen if sight.checks(method)} == {("state+images", 512)}
    blind = smoke.jobs([{"model": BLIND}])
    assert all(("checker=truth" in job.label) is sight.checks(job.method) for job in blind)


def test_who_never_checks_has_no_checker() -> None:
    url = "http://127.0.0.1:9/v1"
    for told in ("custom:m", "custom:m,images=false"):
        for job in jobs("BASE,SMART-LLM,BASE-BEST", {"model": told}, url=url):
            assert "checker" not in job.label and not job.viewers and job.options.obs == "state"
            assert sight.checked_by(failed(job)) == ""
        (checks,) = jobs("CC", {"model": told}, url=url)
        assert sight.checked_by(failed(checks))


def failed(job: Job) -> Record:
    """A record of this job without any check."""
    facts: dict[str, Any] = {"task": job.task, "starts": "paper", "seed": job.seed, "robots": 1, "backend": "symbolic"}
    facts |= {"iteration": 0, "scored": True, "success": False, "options": {"agent": dict(job.agent)}}
    return Record(job=job.key, agent=job.label, method=job.method, **facts)


class Counting:
    """A checker that notes that it was asked, and finds everything false."""

    def __init__(self) -> None:
        self.asked = 0

    def check(self, conditions: Sequence[Condition], view: View) -> list[Verdict]:
        self.asked += 1
        return [Verdict(condition, False) for condition in conditions]


@pytest.mark.parametrize("name", METHODS)
def test_a_method_says_truly_whether_it_checks(name: str) -> None:
    checker = Counting()
    env = remac_env.parallel_env(TASK, backend="symbolic", robots=METHODS[name].robots, max_rounds=12)
    agent = remac_agents.make(name, planner="literal", checker=checker)
    observations, infos = env.reset(seed=0)
    agent.reset(observations, infos)
    while env.agents:
        observations, _, _, _, infos = env.step(agent.act(observations, infos))
    assert bool(checker.asked) is METHODS[name].checks


def test_eyes_can_be_given_and_taken_by_an_option_of_the_model() -> None:
    url = "http://127.0.0.1:9/v1"
    (blind,) = jobs("CC", {"model": "custom:m,images=false"}, url=url)
    assert blind.agent["checker"] == "truth" and blind.options.obs == "state"
    (seeing,) = jobs("CC", {"model": "custom:m"}, url=url)
    assert "checker" not in seeing.agent and seeing.options.obs == "state+images"
    with pytest.raises(OptionError, match="takes no images"):
        jobs("CC", {"checker": "custom:m,images=false"}, url=url)


def test_an_entry_says_who_checks_where_its_model_cannot() -> None:
    labels = {job.method: job.label for job in jobs("BASE,CC", {"model": BLIND})}
    assert labels == {"BASE": f"BASE (model={BLIND})", "CC": f"CC (checker=truth, model={BLIND})"}
    (seeing,) = jobs("CC", {"model": EYES})
    assert seeing.label == f"CC (model={EYES})"
    (same,) = jobs("CC", {"model": BLIND, "checker": "truth"})
    assert same.key == jobs("CC", {"model": BLIND})[0].key
    (offline,) = jobs("CC", {})
    assert dict(offline.agent) == {} and offline.viewers == ()


def unsure(user: str) -> str:
    return json.dumps({"verdicts": [None] * len(re.findall(r"^\d+\. ", user, re.M))})


def played(folder: Path, *agents: dict[str, Any], methods: str = "BASE,CC") -> list[Record]:
    """Records of agents whose looking checker never can tell."""

    def act(connection: Any, asked: Any) -> None:
        told = asked.body["messages"][-1]["content"]
        says(unsure(told if isinstance(told, str) else told[0]["text"]))(connection, asked)

    with ChaosServer() as server:
        server.script = [act]
        made = [job for agent in agents for job in jobs(methods, agent, url=server.url, image_size=16)]
        summary = run_jobs(made, folder, Settings(workers=0))
        assert not summary.infrastructure
    return Store(folder).read()


def test_a_checker_that_cannot_tell_ends_with_an_audit_of_that(tmp_path: Path) -> None:
    base, cc = sorted(played(tmp_path, {"checker": "custom:eyes"}), key=lambda record: record.method)
    assert (cc.error, cc.success, base.success) == (None, False, False)
    assert [list(turn.values())[0].subtask for turn in cc.outcomes] == [
        list(turn.values())[0].subtask for turn in base.outcomes
    ]
    assert any(exchange.pictures for exchange in cc.exchanges)
    assert {check.verdict for check in cc.pre_checks} >= {None}
    assert "null" in cc.line()
    assert setting(base) == setting(cc)  # who looks is the agent's own matter
    board = judging.board([base, cc])
    (audit,) = [sheet for sheet in board.sheets if sheet.key == "audit"]
    row = audit.rows[0]
    felt = sum(check.verdict is not None for check in (*cc.pre_checks, *cc.post_checks))
    assert row["verdicts"].value == felt and row["cannot_tell"].value > felt
