"""Jobs and their keys, and what the command line says about them."""

from __future__ import annotations

from dataclasses import fields, replace

import pytest
from bench_helpers import jobs
from remac_bench.errors import UsageError
from remac_bench.playing import agents
from remac_bench.playing.job_lists import make_jobs, parse_names, parse_seeds

from remac_env.errors import OptionError, UnknownNameError
from remac_env.options import Options


def test_a_key_never_changes() -> None:
    """Were it to, every folder of records would be run anew."""
    (job,) = jobs("REMAC", seeds=range(7, 8), handover="search")
    assert job.key == "97b062f44fd9"


def test_whatever_changes_an_episode_changes_the_key() -> None:
    (job,) = jobs("RE", seeds=range(1))
    others = [
        replace(job, method="REMAC"),
        replace(job, task="DefrostInBowl"),
        replace(job, seed=1),
        replace(job, iterations=1),
        replace(job, agent={"checker": "none"}),
        *(replace(job, options=replace(job.options, **change)) for change in changes()),
    ]
    keys = [entry.key for entry in [job, *others]]
    assert len(set(keys)) == len(keys)


def changes() -> list[dict]:
    """Another valid value for each of the kitchen's options that can change an episode."""
    values = {
        "robots": 2,
        "backend": "physics",
        "style": "coastal",
        "layout": "one_wall_large",
        "starts": "mixed",
        "obs": "state+images",
        "text": "states",
        "feedback": "reason",
        "wording": 1,
        "perception_noise": 0.01,
        "image_size": 64,
        "cameras": "station",
        "max_rounds": 9,
        "reward": "progress",
        "masks": "feasible",
        "obs_format": "flat",
        "failure_rate": 0.5,
        "grade": 2,
        "template": "washed fruit",
        "quirks": 1,
        "knowledge": "seen",
        "body": "short",
    }
    timed = {"clock": "events"}, {"clock": "events", "think": "fixed:5"}, {"clock": "events", "max_seconds": 60.0}
    timed += ({"clock": "events", "interrupts": True},)
    learned = ({"backend": "physics", "skills": "learned"},)
    told = set(values).union(*timed, *learned)
    untold = {field.name for field in fields(Options)} - told - {"naming", "render_mode"}
    assert not untold, f"no other value is given here for {untold}"
    return [*({name: value} for name, value in values.items()), *timed, *learned]


def test_looking_at_an_episode_does_not_change_the_key() -> None:
    (job,) = jobs(seeds=range(1))
    assert replace(job, options=replace(job.options, render_mode="rgb_array")).key == job.key


def test_defaults_that_are_spelt_out_are_no_other_job() -> None:
    assert jobs(planner="literal", retries=2)[0].key == jobs()[0].key
    assert jobs(planner="oracle")[0].key != jobs()[0].key


def test_robots_and_iterations_default_to_the_method() -> None:
    found = {job.method: (job.options.robots, job.iterations) for job in jobs("BASE,CC,RE,REMAC")}
    assert found == {"BASE": (1, 0), "CC": (1, 0), "RE": (1, 2), "REMAC": (2, 2)}


def test_iterations_given_are_for_methods_with_a_memory() -> None:
    made = make_jobs(
        tasks=["HeatOnStove"],
        methods=["CC", "RE"],
        seeds=[0],
        kitchen={"backend": "symbolic"},
        agent={},
        robots=2,
        iterations=1,
    )
    assert [(job.label, job.iterations) for job in made] == [
        ("CC (robots=2)", 0),
        ("RE (iterations=1, robots=2)", 1),
    ]


@pytest.mark.parametrize(
    ("text", "seeds"), [("0:3", [0, 1, 2]), ("5", [5]), ("4, 0,4", [4, 0]), ("1:3,9", [1, 2, 9])]
)
def test_seeds(text: str, seeds: list[int]) -> None:
    assert parse_seeds(text) == seeds


@pytest.mark.parametrize("text", ["", "3:3", "a", "-1", "1:", ":4", "1:2:3", "1.5", "1,,2"])
def test_seeds_that_are_none(text: str) -> None:
    with pytest.raises(UsageError, match="valid"):
        parse_seeds(text)


def test_names() -> None:
    assert parse_names(" BASE, CC,BASE ", "methods") == ["BASE", "CC"]
    with pytest.raises(UsageError, match="methods"):
        parse_names(" , ", "methods")


def test_a_role_with_options() -> None:
    assert agents.role("truth") == "truth"
    assert agents.role("noisy, miss=0.2,word=x") == {"name": "noisy", "miss": 0.2, "word": "x"}
    with pytest.raises(UsageError, match="option=value"):
        agents.role("noisy,miss")


@pytest.mark.parametrize(
    "agent",
    [{"planner": "nobody"}, {"checker": "noisy,miss=7"}, {"handover": "x.y:Z"}, {"retries": -1},
     {"max_seconds": float("inf")}, {"max_money": float("nan")}, {"model": "vllm:m,max_tokens=0"}],
)
def test_bad_agents_come_out_before_any_work(agent: dict) -> None:
    with pytest.raises((UnknownNameError, OptionError), match="valid|imported"):
        jobs("REMAC", **agent)
