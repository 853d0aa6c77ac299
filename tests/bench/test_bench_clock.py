"""Runs under the event clock: what records say, that they are verified, and that tables keep the clocks apart."""

from __future__ import annotations

from pathlib import Path
from socket import socket
from time import sleep

import numpy as np
import pytest
from chaos_server import Act, Asked, ChaosServer, says
from remac_bench.errors import UsageError
from remac_bench.judging.episodes import idle_share, setting, share_of
from remac_bench.judging.times import time_sheets
from remac_bench.playing.agents import Access
from remac_bench.playing.jobs import Job
from remac_bench.playing.suites import load
from remac_bench.playing.timing import StepBook, replayed
from remac_bench.playing.worker import Work, play_job
from remac_bench.proof.again import check_job, read_job
from remac_bench.proof.rounds import check_rounds
from remac_bench.records import Record

import remac_env
from remac_env.options import Options
from remac_env.thinking import Thought


def play(method: str = "BASE", *, robots: int = 2, **options: object) -> Record:
    made = {"backend": "symbolic", "robots": robots, "clock": "events"} | options
    job = Job(method=method, task="OpenMicrowavePnP", seed=1, options=Options(**made))  # type: ignore[arg-type]
    (record,) = play_job(Work(job=job, folder="", video="none"))
    assert record.error is None, record.error
    return record


def test_a_record_says_who_did_what_when() -> None:
    record = play("CC", robots=2, think="fixed:1.5", starts="mixed")
    assert record.clock == "events" and record.orders and record.success
    kinds = {span.kind for span in record.timeline}
    assert {"subtask", "thought", "wait"} <= kinds
    for robot in ("robot_0", "robot_1"):
        spans = [span for span in record.timeline if span.who == robot]
        assert spans and all(one.ended <= other.began + 1e-6 for one, other in zip(spans, spans[1:], strict=False))
        assert spans[0].began == 0.0 and spans[-1].ended == pytest.approx(record.sim_seconds)
    whole = record.robots * record.sim_seconds
    shares = [share_of(record, kind) for kind in ("subtask", "wait", "thought")]
    assert sum(shares) == pytest.approx(1.0) and whole > 0  # type: ignore[arg-type]
    assert idle_share(record) == shares[1]
    told = [entry for step in record.outcomes for entry in step.values()]
    assert len(told) == sum(span.kind in ("subtask", "wait") and span.status != "cut" for span in record.timeline)
    assert {"clock=events", "think=fixed:1.5"} <= set(setting(record).split(", "))


@pytest.mark.parametrize("think", ["off", "fixed:2"])
def test_a_record_is_verified(think: str) -> None:
    record = play(think=think)
    assert list(check_job([record])) == [] and list(check_rounds([record])) == []


def test_what_is_not_so_is_found() -> None:
    record = play(think="fixed:2")
    later = record.timeline[2].model_copy(update={"ended": record.timeline[2].ended + 1.0})
    forged = record.model_copy(update={"timeline": [*record.timeline[:2], later, *record.timeline[3:]]})
    assert any("timeline" in told for told in check_rounds([forged]))
    first = dict(record.orders[0])
    robot = next(iter(first))
    first[robot] = first[robot].model_copy(update={"command": "wait"})
    forged = record.model_copy(update={"orders": [first, *record.orders[1:]]})
    assert list(check_rounds([forged]))


def test_rounds_say_nothing_of_it() -> None:
    record = play(clock="rounds")
    assert record.clock == "rounds" and record.orders == [] and record.timeline == []
    assert "clock" not in setting(record)
    line = record.line()
    assert Record.model_validate_json(line) == record


def test_round_based_methods_take_as_long_as_with_rounds() -> None:
    for method in ("BASE", "CC"):
        timed, rounds = play(method), play(method, clock="rounds")
        assert timed.sim_seconds == rounds.sim_seconds and timed.success == rounds.success
        assert timed.final_plan == rounds.final_plan and timed.subtasks_done == rounds.subtasks_done


@pytest.mark.parametrize("think", ["fixed:1", "fixed:7"])
def test_a_method_in_step_does_not_get_out_of_step_by_thinking(think: str) -> None:
    timed, free = play("CC", think=think, max_seconds=600.0), play("CC")
    assert timed.success and timed.final_plan == free.final_plan
    thoughts = [span for span in timed.timeline if span.kind == "thought"]
    assert thoughts and all(span.ended - span.began == float(think[6:]) for span in thoughts)


def test_records_lie_beside_each_other(tmp_path: Path) -> None:
    one, other = play(), play(clock="rounds")
    assert one.job != other.job and setting(one) != setting(other)


def test_the_table_of_times_says_what_becomes_of_it() -> None:
    played = [play("REACT", think="fixed:2"), play("BASE"), play("BASE", clock="rounds")]
    sheet, thinking = time_sheets(played, folder="x")
    rows = {(row["agent"].text, row["setting"].text.count("think")): row for row in sheet.rows}
    thoughtful, base = rows["REACT", 1], rows["BASE (robots=2)", 0]
    assert thoughtful["asks"].text == "when ready" and base["asks"].text == "in step"
    assert thoughtful["thinking"].value > 0.0 and base["thinking"].value == 0.0
    assert base["idle"].value == idle_share(played[1]) and "met" not in base
    assert {row["think"].text for row in thinking.rows} == {"off", "fixed:2"}
    assert time_sheets(played[2:], folder="x") == []


def test_a_table_says_what_asynchrony_saves_and_what_thinking_costs() -> None:
    rounds, free, slow = play("CC", clock="rounds"), play("CC"), play("CC", think="fixed:2")
    slower = slow.options | {"kitchen": {**slow.options["kitchen"], "think": "fixed:90"}}
    late = slow.model_copy(update={"options": slower, "success": False})
    sooner = rounds.model_copy(update={"sim_seconds": rounds.sim_seconds + 7.0})
    _, sheet = time_sheets([sooner, late, slow, free], folder="x")
    assert [row["think"].text for row in sheet.rows] == ["off", "fixed:2", "fixed:90"]
    assert sheet.rows[0]["saves"].value == pytest.approx(sooner.sim_seconds - free.sim_seconds)
    assert sheet.rows[1]["costs"].value == pytest.approx(slow.sim_seconds - free.sim_seconds)
    assert sheet.rows[1]["late"].value == 0.0 and sheet.rows[2]["late"].value == 1.0
    assert "costs" not in sheet.rows[2] and "saves" not in sheet.rows[1]


def test_a_makespan_stands_beside_the_shortest() -> None:
    options = Options(backend="symbolic", clock="events", robots=1, layout="one_wall_large")
    job = Job(method="CC", task="OpenMicrowavePnP", seed=1, options=options)
    (record,) = play_job(Work(job=job, folder="", video="none", optimum=True))
    assert record.optimum_seconds == 44.0 == record.optimum_seconds_lower and record.optimum_rounds is None
    sheet, _ = time_sheets([record], folder="x")
    assert sheet.rows[0]["best"].value == pytest.approx(record.sim_seconds / 44.0)


def test_a_suite_by_the_event_clock_has_its_tasks(tmp_path: Path) -> None:
    suite = load("timed")
    assert {task for block in suite.blocks for task in block.tasks} > {"FallingDoor", "HeatOnStove"}
    text = 'name = "x"\nversion = 1\nmethods = ["BASE"]\n[[jobs]]\ntasks = ["FallingDoor"]\nseeds = "0:1"\n'
    (tmp_path / "x.toml").write_text(text, "utf-8")
    with pytest.raises(UsageError, match="FallingDoor"):
        load(str(tmp_path / "x.toml"))


def test_stops_are_written_down_and_played_again() -> None:
    kitchen = {"robots": 2, "backend": "symbolic", "clock": "events", "interrupts": True, "think": "tokens:5"}
    env, book, chance = remac_env.parallel_env("OpenMicrowavePnP", **kitchen), StepBook(), np.random.default_rng(3)
    _, infos = env.reset(seed=1)
    first = infos
    while env.agents and len(book.orders) < 80:
        actions = {robot: int(chance.choice(np.flatnonzero(env.action_mask(robot)))) for robot in env.agents}
        thoughts = {robot: Thought(tokens=int(chance.integers(900))) for robot in env.agents}
        book.order(env, actions, infos, thoughts)
        _, _, _, _, infos = env.step(actions)
        book.ended(env, actions, infos)
    assert any(order.command == "stop" for told in book.orders for order in told.values())
    seen, world = env.timeline, env.world
    _, infos = env.reset(seed=1)
    assert infos.keys() == first.keys()
    for told in book.orders:
        tokens, thoughts = replayed(env, told, infos)
        for robot, thought in thoughts.items():
            env.note_thought(robot, thought)
        _, _, _, _, infos = env.step(tokens)
    assert env.timeline == seen and env.world == world


def test_thinking_that_was_recorded_takes_as_long_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CUSTOM_API_KEY", "sk-test")
    cassette, answer = str(tmp_path / "asked.jsonl"), says("Thought: go.\nPlan: [navigate to counter]")
    options = Options(backend="symbolic", clock="events", robots=2, think="recorded", max_seconds=20.0)
    with ChaosServer([answer]) as server:
        access = Access(base_url=server.url, cassette=cassette)
        job = Job(method="REACT", task="OpenMicrowavePnP", seed=1, options=options, agent={"model": "custom:m"},
                  access=access)  # fmt: skip
        (record,) = play_job(Work(job=job, folder="", video="none", optimum=False))
    thoughts = [span for span in record.timeline if span.kind == "thought"]
    assert thoughts and all(span.ended > span.began for span in thoughts)
    assert list(check_job([record], cassette=cassette)) == []
    slower = record.model_copy(update={"sim_seconds": record.sim_seconds + 0.001})
    assert any("sim_seconds" in each for each in check_job([slower], cassette=cassette))


REPLIES = ((412, 0.03), (1875, 0.08), (96, 0.0), (2604, 0.11))
"""Tokens and seconds of answers: short, with reasoning, one word, with much reasoning."""


def thinks(tokens: int, seconds: float) -> Act:
    """An answer that took its tokens and its time."""
    usage = {"prompt_tokens": 900, "completion_tokens": tokens, "total_tokens": 900 + tokens}
    answer = says("Thought: on.\nPlan: [navigate to counter]", usage=usage)

    def act(connection: socket, asked: Asked) -> None:
        sleep(seconds)
        answer(connection, asked)

    return act


@pytest.mark.parametrize(
    "think", ["tokens:10", *(pytest.param(each, marks=pytest.mark.long) for each in ("tokens:300", "recorded"))]
)
def test_what_a_model_wrote_and_took_is_what_its_commands_cost(
    think: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CUSTOM_API_KEY", "sk-test")
    cassette = str(tmp_path / "asked.jsonl")
    options = Options(backend="symbolic", clock="events", robots=1, think=think, max_seconds=150.0)
    with ChaosServer([thinks(*reply) for reply in REPLIES]) as server:
        access = Access(base_url=server.url, cassette=cassette)
        job = Job(method="REACT", task="OpenMicrowavePnP", seed=1, options=options, agent={"model": "custom:m"},
                  access=access)  # fmt: skip
        (record,) = play_job(Work(job=job, folder="", video="none", optimum=False))
    told = [span for span in record.timeline if span.kind == "thought" and span.status != "cut"]
    costs = [span.ended - span.began for span in told][: len(REPLIES)]
    if think == "recorded":
        assert len(costs) == 4 and all(cost >= took for cost, (_, took) in zip(costs, REPLIES, strict=True))
    else:
        rate = float(think.partition(":")[2])
        wanted = [tokens / 1000 * rate for tokens, _ in REPLIES][: len(costs)]
        assert costs == pytest.approx(wanted) and len(costs) == (4 if rate == 10 else 1)
    assert list(check_job([record], cassette=cassette)) == [], "played again without the server, it is the same"
    dearer = {"seconds": 0.5} if think == "recorded" else {"tokens": 1}
    first = next(iter(record.orders[0].values()))
    changed = first.model_copy(update={name: getattr(first, name) + more for name, more in dearer.items()})
    forged = record.model_copy(update={"orders": [{**record.orders[0], "robot_0": changed}, *record.orders[1:]]})
    assert list(check_job([forged], cassette=cassette)) != []


def test_a_job_read_again_has_the_roles_that_look_at_pictures() -> None:
    options = Options(backend="symbolic", obs="state+images", image_size=64)
    job = Job(method="CC", task="OpenMicrowavePnP", seed=1, options=options, viewers=("checker",))
    record = play().model_copy(update={"options": job.facts, "clock": "rounds", "method": "CC"})
    assert read_job(record) == job
