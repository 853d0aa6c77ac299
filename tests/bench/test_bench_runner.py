"""Jobs played by the runner, in this process and in others."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from bench_helpers import TASKS, jobs, odd_scene, read, timeless
from remac_bench.metrics import summarise
from remac_bench.playing.runner import RunSummary, Settings, run_jobs
from remac_bench.report import read_rows

from remac_env.envs.parallel import KitchenParallelEnv
from remac_env.errors import RenderingError

HERE = Settings(workers=0)


def test_the_staircase_of_the_four_methods(tmp_path: Path) -> None:
    """BASE fails on the hidden constraint, CC recovers by a longer plan, RE plans it, REMAC shares it."""
    run_jobs(jobs("BASE,CC,RE,REMAC", tasks=",".join(TASKS)), tmp_path, HERE)
    rows = {(row.task, row.method): row for row in read_rows(tmp_path)}
    assert all(rows[task, "BASE"].tsr == 0.0 for task in TASKS)
    assert all(rows[task, method].tsr == 1.0 for task in TASKS for method in ("CC", "RE", "REMAC"))
    assert [rows[task, "RE"].ipl for task in TASKS] == [6, 6, 9, 9]
    assert [rows[task, "REMAC"].ipl for task in TASKS] == [4, 4, 7, 7]
    for task in TASKS:
        assert rows[task, "CC"].fpl > rows[task, "RE"].fpl > rows[task, "REMAC"].fpl  # type: ignore[operator]


def test_a_record_holds_what_was_played(tmp_path: Path) -> None:
    run_jobs(jobs("CC", seeds=range(3, 4)), tmp_path, replace(HERE, optimum=True))
    (entry,) = read(tmp_path)
    assert (entry.seed, entry.success, entry.end, entry.scored, entry.error) == (
        3,
        True,
        "success",
        True,
        None,
    )
    assert entry.digest is not None
    assert len(entry.digest) == 12
    assert entry.optimum_rounds == 9
    assert entry.rounds == len(entry.outcomes) >= 9
    assert entry.sim_seconds > 0
    assert entry.progress == 1.0
    assert entry.final_plan_length == len(entry.final_plan["robot_0"]) > entry.initial_plan_length
    played = [outcome["robot_0"].subtask for outcome in entry.outcomes]
    assert played == entry.final_plan["robot_0"]
    assert entry.truth_readers == ["checker"]
    assert {check.verdict == check.truth for check in entry.pre_checks} == {True}
    assert any(not check.verdict for check in entry.pre_checks)
    assert set(entry.versions) == {"remac", "code", "python", "mujoco", "numpy"}
    assert entry.options["kitchen"]["backend"] == "symbolic"


def test_iterations_are_played_in_order_with_a_memory_of_the_job(tmp_path: Path) -> None:
    run_jobs(jobs("REMAC", seeds=range(2)), tmp_path, HERE)
    entries = read(tmp_path)
    for seed in (0, 1):
        played = [entry for entry in entries if entry.seed == seed]
        assert [(e.iteration, e.scored) for e in played] == [(0, False), (1, False), (2, True)]
        assert [e.initial_plan_length for e in played] == [5, 9, 7]
        assert len({e.digest for e in played}) == 1
        assert [len(e.initial_plan) for e in played] == [1, 1, 2]


@pytest.mark.long
def test_processes_and_their_number_change_nothing(tmp_path: Path) -> None:
    """Of a run that was killed and went on in two processes test_bench_kill.py holds the same."""
    listed = jobs("CC,RE", tasks="HeatOnStove,OpenCabinetPnP")
    run_jobs(listed, tmp_path / "here", HERE)
    run_jobs(listed[::-1], tmp_path / "two", Settings(workers=2))
    assert timeless(read(tmp_path / "here")) == timeless(read(tmp_path / "two"))


def test_finished_jobs_are_not_run_again(tmp_path: Path) -> None:
    assert run_jobs(jobs(seeds=range(2)), tmp_path, HERE) == RunSummary(0, 2, ())
    before = (tmp_path / "records.jsonl").read_bytes()
    assert run_jobs(jobs(seeds=range(2)), tmp_path, HERE) == RunSummary(2, 0, ())
    assert (tmp_path / "records.jsonl").read_bytes() == before
    assert run_jobs(jobs(seeds=range(3)), tmp_path, HERE) == RunSummary(2, 1, ())
    assert run_jobs(jobs(seeds=range(1)), tmp_path, replace(HERE, fresh=True)) == RunSummary(0, 1, ())
    assert len(read(tmp_path)) == 1


def test_a_crashing_planner_is_a_failure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENAI_API_KEY", "sk-very-secret-value")
    listed = jobs("RE", seeds=range(1), planner="bench_planners:Crashes")
    assert run_jobs(listed, tmp_path, HERE).infrastructure == ()
    entries = read(tmp_path)
    assert [(e.iteration, e.success, e.scored) for e in entries] == [
        (0, False, False),
        (1, False, False),
        (2, False, True),
    ]
    error = entries[-1].error
    assert error is not None
    assert (error.kind, error.type) == ("agent", "ZeroDivisionError")
    assert error.message == "planned by zero with <OPENAI_API_KEY>"
    assert "bench_planners.py" in error.where[-1]
    assert "sk-very" not in (tmp_path / "records.jsonl").read_text("utf-8")
    (row,) = summarise(entries)
    assert (row.n, row.tsr, row.crashed, row.infrastructure) == (1, 0.0, 1, 0)


def test_a_crash_in_one_iteration_does_not_end_the_job(tmp_path: Path) -> None:
    run_jobs(jobs("RE", seeds=range(1), planner="bench_planners:CrashesOnce"), tmp_path, HERE)
    entries = read(tmp_path)
    assert [entry.error is None for entry in entries] == [False, True, True]
    assert entries[-1].success


def test_malformed_actions_are_the_agents_fault(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import remac_agents

    monkeypatch.setattr(remac_agents.Agent, "act", lambda self, obs, infos: {"robot_0": 0.5})
    run_jobs(jobs(seeds=range(1)), tmp_path, HERE)
    (entry,) = read(tmp_path)
    assert entry.error is not None
    assert (entry.error.kind, entry.error.type, entry.scored) == ("agent", "ActionError", True)


def test_an_error_of_the_kitchen_is_not_scored_and_run_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole, calls = KitchenParallelEnv.step, []

    def step(self: KitchenParallelEnv, actions: Any) -> Any:
        calls.append(actions)
        if len(calls) == 20:  # in the second iteration
            raise OSError("disk on fire")
        return whole(self, actions)

    monkeypatch.setattr(KitchenParallelEnv, "step", step)
    summary = run_jobs(jobs("RE", seeds=range(1)), tmp_path, HERE)
    assert summary.infrastructure == ("HeatOnStove, RE, seed 0: OSError: disk on fire",)
    entries = read(tmp_path)
    assert [(e.iteration, e.scored, e.infrastructure_error) for e in entries] == [
        (0, False, False),
        (1, False, True),
    ]
    assert entries[-1].rounds > 0
    assert [(row.n, row.infrastructure) for row in summarise(entries)] == [(0, 1)]
    assert run_jobs(jobs("RE", seeds=range(1)), tmp_path, HERE) == RunSummary(0, 1, ())
    assert [(row.n, row.tsr, row.infrastructure) for row in read_rows(tmp_path)] == [(1, 1.0, 0)]


def test_a_kitchen_that_cannot_begin_leaves_no_report_of_the_episode_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole, calls = KitchenParallelEnv.reset, []

    def reset(self: KitchenParallelEnv, **given: Any) -> Any:
        calls.append(given)
        if len(calls) == 2:
            raise OSError("no start")
        return whole(self, **given)

    monkeypatch.setattr(KitchenParallelEnv, "reset", reset)
    run_jobs(jobs("RE", seeds=range(1)), tmp_path, HERE)
    last = read(tmp_path)[-1]
    assert (last.iteration, last.rounds, last.initial_plan, last.final_plan_length) == (1, 0, {}, None)


@pytest.mark.few(1)
@pytest.mark.parametrize("workers", [1, 2])
def test_an_agent_that_ends_its_worker_twice_has_crashed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, workers: int
) -> None:
    monkeypatch.setenv("ODD_SCENE", odd_scene(1))
    listed = jobs("CC", seeds=range(5), planner="bench_planners:EndsProcess")
    summary = run_jobs(listed, tmp_path, Settings(workers=workers))
    assert summary == RunSummary(0, 5, ())
    scored = {entry.seed: entry for entry in read(tmp_path) if entry.scored}
    assert {seed: entry.success for seed, entry in scored.items()} == {0: True, 1: False, 2: True, 3: True, 4: True}
    error = scored[1].error
    assert error is not None
    assert (error.kind, error.type) == ("agent", "WorkerDiedError")
    assert error.message == "the worker process ended with status 9, 2 times in a row"


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("planner", "scored", "broken"),
    [("KillsItself", 2, ("seed 1: WorkerDiedError: the worker process was killed",)), ("EndsProcessOnce", 3, ())],
)
def test_a_worker_that_dies_once_or_is_killed_says_nothing_of_the_agent(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, planner: str, scored: int, broken: tuple[str, ...]
) -> None:
    monkeypatch.setenv("BENCH_PLANNER_FOLDER", str(tmp_path))
    monkeypatch.setenv("ODD_SCENE", odd_scene(1))
    listed = jobs("CC", seeds=range(3), planner=f"bench_planners:{planner}")
    summary = run_jobs(listed, tmp_path / "out", Settings(workers=2))
    assert summary.played == 3
    assert len(summary.infrastructure) == len(broken)
    assert all(part in told for part, told in zip(broken, summary.infrastructure, strict=True))
    assert [entry.success for entry in read(tmp_path / "out") if entry.scored] == [True] * scored


def test_a_video_that_fails_is_told_and_spoils_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(self: KitchenParallelEnv) -> None:
        raise RenderingError("no light in here")

    monkeypatch.setattr(KitchenParallelEnv, "start_recording", refuse)
    run_jobs(jobs("CC", seeds=range(1)), tmp_path, replace(HERE, video="all"))
    (entry,) = read(tmp_path)
    assert entry.success
    assert entry.video is not None
    assert (entry.video.path, entry.video.error) == (None, "RenderingError: no light in here")


@pytest.mark.parametrize(
    ("video", "expected"),
    [
        ("none", []),
        ("all", [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2)]),
        ("first", [(0, 2)]),
        ("failed", [(0, 0), (1, 0)]),
    ],
)
def test_which_episodes_are_filmed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, video: str, expected: list
) -> None:
    monkeypatch.setattr(KitchenParallelEnv, "start_recording", lambda self: None)
    monkeypatch.setattr(KitchenParallelEnv, "save_recording", lambda self, path: path.write_bytes(b"film"))
    listed = jobs("RE", seeds=range(2), planner="bench_planners:CrashesOnce")
    run_jobs(listed, tmp_path, replace(HERE, video=video))
    filmed = [entry for entry in read(tmp_path) if entry.video is not None]
    assert [(entry.seed, entry.iteration) for entry in filmed] == expected
    files = {str(path.relative_to(tmp_path)) for path in tmp_path.glob("videos/*.webm")}
    assert files == {entry.video.path for entry in filmed if entry.video is not None}
    assert len(files) == len(expected)
