"""Code from outside runs in processes of its own: each attack fails there, and works without."""

from __future__ import annotations

import base64
import json
import os
import re
import signal
import struct
import tracemalloc
import zlib
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bench_helpers import jobs, odd_scene, read, start, timeless, wait_for
from remac_bench.errors import UsageError
from remac_bench.playing.runner import RunSummary, Settings, run_jobs
from remac_bench.report import read_rows

from remac_agents.isolation.codec import loads
from remac_agents.roles.request_json import png

HERE = Settings(workers=0)


def slow(*values: object) -> Any:
    """A case that only the long tests play; a sibling of its kind is among the fast ones."""
    return pytest.param(*values, marks=pytest.mark.long)


def found(folder: Path, listed: list[Any], settings: Settings = HERE) -> list[Any]:
    """What the spies wrote down while these jobs were played."""
    assert run_jobs(listed, folder / "out", settings).infrastructure == ()
    lines = (folder / "found.jsonl").read_text().splitlines()
    return [json.loads(line) for line in lines]


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where spies write."""
    monkeypatch.setenv("SPY_FOLDER", str(tmp_path))
    monkeypatch.setenv("ODD_SCENE", odd_scene())
    return tmp_path


@pytest.mark.parametrize("spy", ["WalksFrames", "CollectsGarbage", "Remembers"])
def test_attacks_that_work_without_isolation(folder: Path, spy: str) -> None:
    listed = jobs(seeds=range(2), planner=f"spying_planners:{spy}")
    assert any(found(folder, listed))
    assert {entry.isolated for entry in read(folder / "out")} == {False}
    assert {row.agent for row in read_rows(folder / "out")} == {f"BASE (isolated=false, planner=spying_planners:{spy})"}


@pytest.mark.parametrize(
    "spy", ["WalksFrames", slow("CollectsGarbage"), slow("ReadsModules"), "ReadsRequests", slow("Remembers")]
)
def test_attacks_that_isolation_withstands(folder: Path, spy: str) -> None:
    listed = jobs(seeds=range(2), planner=f"spying_planners:{spy}", isolated=True)
    assert found(folder, listed) == [[], []]
    assert {entry.isolated for entry in read(folder / "out")} == {True}
    assert {row.agent for row in read_rows(folder / "out")} == {f"BASE (planner=spying_planners:{spy})"}


def test_a_request_leads_to_no_start_in_this_process_either(folder: Path) -> None:
    assert found(folder, jobs(seeds=range(2), planner="spying_planners:ReadsRequests")) == [[], []]


def test_who_declares_it_is_given_rules_and_truth(folder: Path) -> None:
    listed = jobs(seeds=range(1), planner="spying_planners:Told", isolated=True)
    assert found(folder, listed) == [["Rules", "WorldState", "All", False]]
    (entry,) = read(folder / "out")
    assert "planner" in entry.truth_readers and "planner" in entry.rule_readers


ROLES = {
    "planner": "remac_agents.planners.literal:LiteralPlanner",
    "conditions": "remac_agents.conditions.rule:RuleConditions",
    "checker": "remac_agents.checkers.truth:TruthChecker",
    "adjuster": "remac_agents.adjusters.rule:RuleAdjuster",
    "reflector": "remac_agents.reflectors.rule:RuleReflector",
    "handover": "remac_agents.handovers.reflections:ReflectionHandover",
    "summariser": "remac_agents.summarisers.rule:RuleSummariser",
}
PLAYED = ("outcomes", "worlds", "initial_plan", "final_plan", "pre_checks", "post_checks", "reflections", "success")


@pytest.mark.parametrize("method", [slow("CC"), "REMAC", slow("REFLECT")])
def test_every_role_answers_the_same_in_a_process_of_its_own(folder: Path, method: str) -> None:
    given = {**ROLES, **({"planner": f"{ROLES['planner']},mends=true"} if method == "REFLECT" else {})}
    run_jobs(jobs(method, seeds=range(1), isolated=True, **given), folder / "apart", HERE)
    run_jobs(jobs(method, seeds=range(1)), folder / "here", HERE)
    apart, here = timeless(read(folder / "apart")), timeless(read(folder / "here"))
    assert [entry["error"] for entry in apart] == [None] * len(here)
    assert [{name: entry[name] for name in PLAYED} for entry in apart] == [
        {name: entry[name] for name in PLAYED} for entry in here
    ]


@pytest.mark.parametrize(
    ("deed", "type_", "message"),
    [
        slow("leaves", "RoleDiedError", "the process of the roles ended with status 0"),
        ("fails", "RoleDiedError", "the process of the roles ended with status -11"),
        slow("exits", "SystemExit", "enough"),
        ("stops", "KeyboardInterrupt", ""),
        slow("deep", "Deep", ""),
        slow("odd", "Odd", "<unprintable Odd>"),
        slow("half", "Half", "half a pair: \\ud83d"),
        slow("sour", "", ""),
        slow("sour row", "", ""),
        slow("counts", "JobTimeoutError", "timeout: the job was not through after 5 s (--job-seconds)"),
    ],
)
def test_what_roles_do_in_their_process_costs_their_episode(folder: Path, deed: str, type_: str, message: str) -> None:
    settings = Settings(workers=0, job_seconds=5.0)
    listed = jobs("CC", seeds=range(3), planner=f"odd_planners:Misbehaves,deed={deed}", isolated=True)
    assert run_jobs(listed, folder, settings) == RunSummary(0, 3, ())
    scored = {entry.seed: entry for entry in read(folder) if entry.scored}
    assert {seed: entry.success for seed, entry in scored.items()} == {0: True, 1: False, 2: True}
    error = scored[1].error
    if type_ and error is not None:
        assert (error.kind, error.type, error.message) == ("agent", type_, message)
    assert (error is not None) == (type_ != "") or error is None or error.kind == "agent"


def test_a_role_that_died_lives_again_in_the_next_iteration(folder: Path) -> None:
    planner = "odd_planners:Misbehaves,deed=leaves"
    run_jobs(jobs("RE", seeds=range(1, 2), planner=planner, isolated=True), folder, HERE)
    assert [entry.error.type for entry in read(folder) if entry.error] == ["RoleDiedError"] * 3


def test_what_a_role_started_ends_with_its_job(folder: Path) -> None:
    """Else it could tell the next job what happened in this one."""
    run_jobs(jobs(seeds=range(1), planner="odd_planners:LeavesBehind", isolated=True), folder / "out", HERE)
    wait_for(lambda: not processes_of(folder))


@pytest.mark.parametrize("size", [(4, 4), (60_000, 60_000)])
def test_a_picture_is_no_larger_than_it_says(size: tuple[int, int]) -> None:
    """An answer that bursts the worker's memory would count as nobody's fault."""
    honest = png(np.zeros((4, 4, 3), np.uint8))
    bomb = zlib.compress(bytes(50_000_000))
    data = honest[:16] + struct.pack(">II", *size) + honest[24:33] + struct.pack(">I", len(bomb)) + b"IDAT" + bomb
    tracemalloc.start()
    with suppress(ValueError):
        loads(json.dumps({"$": "png", "data": base64.b64encode(data).decode()}).encode())
    assert tracemalloc.get_traced_memory()[1] < 5_000_000
    tracemalloc.stop()


@pytest.mark.long
def test_processes_and_threads_isolate_too(folder: Path) -> None:
    listed = jobs(seeds=range(2), planner="spying_planners:CollectsGarbage", isolated=True)
    assert found(folder, listed, Settings(workers=1)) == [[], []]
    assert found(folder / ".", listed, Settings(workers=2, engine="threads", fresh=True)) == [[]] * 4


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("1 / 0", "ZeroDivisionError: division by zero, mine.py:1 in <module>"),
        ("import os\nos._exit(3)", "RoleDiedError: planner: the process ended while it was importing"),
        slow("raise KeyboardInterrupt", "KeyboardInterrupt"),
    ],
)
def test_what_cannot_be_made_is_said_before_anything_is_played(folder: Path, text: str, told: str) -> None:
    (folder / "mine.py").write_text(text)
    with pytest.raises(UsageError, match=re.escape(told)):
        jobs(planner=f"{folder / 'mine.py'}:plan", isolated=True)


@pytest.mark.long
def test_a_killed_runner_leaves_no_process_behind(folder: Path) -> None:
    arguments = ("--methods", "BASE", "--tasks", "HeatOnStove", "--seeds", "1", "--backend", "symbolic", "--jobs", "1")
    planner = ("--planner", "odd_planners:Misbehaves,deed=hangs", "--out", str(folder / "out"))
    runner = start("bench", "run", *arguments, *planner, env={"ODD_SCENE": odd_scene(), "SPY_FOLDER": str(folder)})
    try:
        wait_for(lambda: len(processes_of(folder)) >= 4)  # runner, worker, fork server, and the role
    finally:
        runner.send_signal(signal.SIGKILL)
        runner.communicate()
    wait_for(lambda: not processes_of(folder))


def processes_of(folder: Path) -> list[int]:
    """Processes that were started for a test, known by the folder in their environment."""
    found = []
    for path in Path("/proc").glob("[0-9]*/environ"):
        try:
            told = path.read_bytes().split(b"\0")
            if f"SPY_FOLDER={folder}".encode() in told and int(path.parent.name) != os.getpid():
                found.append(int(path.parent.name))
        except OSError:
            continue
    return found
