"""The command `remac`, through typer's runner and as a real process."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import pytest
from bench_helpers import TASKS, read, record, start
from remac_bench.cli import app
from remac_bench.console import plain
from remac_bench.playing.lock import locked
from remac_bench.store import Store
from typer.testing import CliRunner


def remac(*arguments: str, env: dict[str, str] | None = None) -> Any:
    """The result of a command."""
    return CliRunner().invoke(app, list(arguments), env=env)


def test_oracle_prints_the_shortest_plans() -> None:
    found = []
    for robots in ("1", "2"):
        for task in TASKS:
            result = remac("oracle", "--task", task, "--robots", robots, "--seed", "3")
            assert result.exit_code == 0, result.output
            answer = json.loads(result.stdout)
            assert set(answer["plan"]) == {f"robot_{index}" for index in range(int(robots))}
            assert max(len(row) for row in answer["plan"].values()) == answer["rounds"]
            found.append(answer["rounds"])
    assert found == [6, 6, 9, 9, 4, 4, 6, 6]


def test_oracle_says_null_where_there_is_no_plan() -> None:
    result = remac("oracle", "--task", "HeatOnStove", "--max-rounds", "3")
    assert result.exit_code == 0
    assert json.loads(result.stdout) == {"rounds": None, "proof": "rounds", "lower": 6, "plan": None}


PAN_INTO_MICROWAVE = '''
import remac_env
from remac_env.tasks.goals import All, Inside, Released
from remac_env.tasks.spec import Role, TaskSpec

remac_env.register_task(TaskSpec(
    name="PanIntoMicrowave",
    wordings=("place the {vessel} into the microwave",) * 3,
    goal=All(Inside("{vessel}", "microwave"), Released("{vessel}")),
    roles=(Role("vessel", ("pan",)),),
    fixtures=("counter", "microwave", "stove"),
    verbs={"place": ()},
))
'''


def test_starts_without_a_plan_are_refused_before_anything_is_played(tmp_path: Path) -> None:
    """A pan is too big for the microwave: no run of it says anything about a planner."""
    (tmp_path / "pan.py").write_text(PAN_INTO_MICROWAVE)
    common = ("bench", "run", "--methods", "BASE", "--seeds", "0:1", "--backend", "symbolic", "--jobs", "0")
    more = ("--import", str(tmp_path / "pan.py"), "--out", str(tmp_path / "out"))
    result = remac(*common, "--tasks", "OpenCabinetPnP,PanIntoMicrowave", *more)
    assert result.exit_code == 2
    assert "no plan reaches the goal" in result.output and "PanIntoMicrowave, seed 0" in result.output
    assert not (tmp_path / "out" / "records.jsonl").exists()


def test_tasks_lists_them() -> None:
    entries = json.loads(remac("tasks", "--json").stdout)
    assert [entry["name"] for entry in entries if entry["in_table"]] == list(TASKS)
    assert all(entry["styles"] and entry["layouts"] for entry in entries)
    assert "OpenCabinetPnP" in remac("tasks").stdout


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (("oracle", "--task", "Nope"), "HeatOnStove"),
        (("oracle", "--task", "HeatOnStove", "--robots", "5"), "1, 2, 3, 4"),
        (("oracle", "--task", "HeatOnStove", "--style", "x"), "modern_1"),
        (("oracle", "--task", "HeatOnStove", "--import", "no_such_module"), "no_such_module"),
        (("bench", "run", "--out", "x", "--tasks", "Nope"), "OpenCabinetPnP"),
        (("bench", "run", "--out", "x", "--methods", "NOPE"), "BASE, CC, RE, REMAC"),
        (("bench", "run", "--out", "x", "--planner", "nope"), "literal"),
        (("bench", "run", "--out", "x", "--checker", "nope"), "truth"),
        (("bench", "run", "--out", "x", "--handover", "nope"), "reflections"),
        (("bench", "run", "--out", "x", "--backend", "nope"), "physics, symbolic"),
        (("bench", "run", "--out", "x", "--layout", "nope"), "one_wall_large"),
        (("bench", "run", "--out", "x", "--wording", "4"), "1, 2, 3"),
        (("bench", "run", "--out", "x", "--seeds", "x"), "0:10"),
        (("bench", "run", "--out", "x", "--iterations", "-1"), "0 or more"),
        (("bench", "run", "--out", "x", "--jobs", "-1"), "0 (in this process) or more"),
        (("bench", "run", "--out", "x", "--video", "nope", "--backend", "symbolic"), "failed"),
        (("bench", "run", "--out", "x", "--suite", "dev"), "timed, or a FILE.toml"),
        (("bench", "run", "--tasks", "HeatOnStove"), "--out is missing"),
        (("bench", "run", "--suite", "smoke", "--seeds", "0:3"), "--seeds does not go with suite"),
        (("bench", "run", "--suite", "smoke", "--wording", "1"), "--wording does not go with suite"),
        (("bench", "run", "--suite", "smoke", "--replay"), "needs --cassette"),
        (("bench", "run", "--suite", "smoke", "--engine", "nope"), "auto, processes, threads, ray"),
        (("bench", "run", "--suite", "smoke", "--address", "x"), "is for --engine ray"),
        (("bench", "verify", "x"), "no finished jobs"),
        (("bench", "report", "x"), "no folder 'x'"),
        (("demo", "--seeds", "x"), "0:10"),
    ],
)
def test_mistakes_get_one_line_with_the_valid_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], named: str
) -> None:
    monkeypatch.chdir(tmp_path)
    result = remac(*arguments)
    assert result.exit_code == 2
    assert result.stderr.startswith("error: ")
    assert result.stderr.count("\n") == 1
    assert named in result.stderr
    assert not list(tmp_path.rglob("records.jsonl"))


def test_a_folder_in_use_is_refused_in_one_line(tmp_path: Path) -> None:
    with locked(tmp_path):
        result = remac("bench", "run", "--out", str(tmp_path), "--seeds", "0", "--backend", "symbolic")
    assert result.exit_code == 1
    assert f"in use by another runner (process {os.getpid()} on " in result.stderr
    assert result.stderr.count("\n") == 1
    assert not (tmp_path / "records.jsonl").exists()


def test_names_of_users_cannot_reach_the_terminal_raw() -> None:
    result = remac("oracle", "--task", "\x1b]0;owned\x07\nx")
    assert result.exit_code == 2
    assert "\x1b" not in result.stderr
    assert "\x07" not in result.stderr
    assert plain("\x1b]0;owned\x07\n\tx  y\u202e") == "]0;owned x y"


def test_report_of_an_empty_folder(tmp_path: Path) -> None:
    result = remac("bench", "report", str(tmp_path))
    assert result.exit_code == 2
    assert "no records" in result.stderr


def test_report_escapes_what_records_say(tmp_path: Path) -> None:
    Store(tmp_path).append([record(agent="[red]x|y[/red]")])
    assert "[red]x|y[/red]" in remac("bench", "report", str(tmp_path)).stdout
    assert r"| [red]x\|y[/red] |" in remac("bench", "report", str(tmp_path), "--markdown").stdout


def test_run_and_report_with_flags(tmp_path: Path) -> None:
    arguments = ("bench", "run", "--out", str(tmp_path), "--tasks", "HeatOnStove", "--methods", "CC,REMAC")
    more = ("--seeds", "0:1", "--backend", "symbolic", "--jobs", "0", "--handover", "search", "--optimum")
    flags = ("--starts", "mixed", "--checker", "noisy,false_alarm=0,miss=0", "--agent-max-rounds", "25")
    result = remac(*arguments, *more, *flags, "--max-rounds", "28", "--iterations", "3")
    assert result.exit_code == 0, result.output
    entries = read(tmp_path)
    assert {(entry.method, entry.iteration) for entry in entries if entry.scored} == {("CC", 0), ("REMAC", 3)}
    assert {entry.starts for entry in entries} == {"mixed"}
    assert all(entry.optimum_rounds for entry in entries)
    options = entries[0].options
    assert options["kitchen"]["max_rounds"] == 28
    assert options["agent"] == {
        "checker": "noisy,false_alarm=0,miss=0",
        "handover": "search",
        "max_rounds": 25,
    }
    table = remac("bench", "report", str(tmp_path), "--markdown").stdout
    assert "**Results: symbolic, mixed starts, max_rounds=28**" in table
    assert "| HeatOnStove | CC (checker=noisy" in table


def test_demo_runs_everything_and_begins_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    arguments = ("demo", "--backend", "symbolic", "--no-video", "--seeds", "0:1", "--out", str(tmp_path))
    for _ in range(2):
        result = remac(*arguments, "--jobs", "0")
        assert result.exit_code == 0, result.output
        assert "16 jobs played, 0 found finished" in result.stdout
        assert (tmp_path / "leaderboard.html").is_file()
        monkeypatch.setattr("remac_bench.commands.demo.show_pages", lambda *given, **more: None)  # once is enough
    entries = [entry for entry in read(tmp_path) if entry.scored]
    assert len(entries) == 16
    assert len({(entry.task, entry.style, entry.layout) for entry in entries}) == 4
    assert "16 found finished" in remac(*arguments, "--jobs", "0", "--resume").stdout


def test_doctor_names_keys_and_never_shows_them() -> None:
    result = remac("doctor", "--json", env={"OPENAI_API_KEY": "sk-do-not-tell", "DEEPSEEK_API_KEY": ""})
    findings = {finding["name"]: finding for finding in json.loads(result.stdout)}
    assert findings["OPENAI_API_KEY"]["value"] == "set"
    assert findings["DEEPSEEK_API_KEY"]["value"] == "not set"
    assert "do-not-tell" not in result.output
    assert {"Python", "cores", "memory", "MuJoCo", "OpenGL", "robosuite", "torch", "h5py", "ray"} <= set(findings)
    assert all(finding["purpose"] for finding in findings.values() if finding["name"] != "system")
    assert "do-not-tell" not in remac("doctor", env={"OPENAI_API_KEY": "sk-do-not-tell"}).output


def test_the_real_command_and_a_task_from_outside(tmp_path: Path) -> None:
    """In worker processes too, a task that a file registers is known."""
    (tmp_path / "more_tasks.py").write_text(
        "from dataclasses import replace\n"
        "import remac_env\n"
        "from remac_env.tasks import get\n"
        "remac_env.register_task(replace(get('HeatOnStove'), name='WarmOnStove'))\n",
        "utf-8",
    )
    extension = ("--import", str(tmp_path / "more_tasks.py"))
    process = start(
        *("bench", "run", "--out", str(tmp_path / "out"), "--tasks", "WarmOnStove", "--methods", "CC"),
        *("--seeds", "0:2", "--backend", "symbolic", "--jobs", "2", *extension),
    )
    out, told = process.communicate(timeout=120)
    assert process.returncode == 0, told
    assert "WarmOnStove" in out
    assert "100%" in out
    assert {entry.task for entry in read(tmp_path / "out")} == {"WarmOnStove"}


def test_the_real_command_says_mistakes_without_a_traceback() -> None:
    process = start("oracle", "--task", "Nope")
    out, told = process.communicate(timeout=60)
    assert (process.returncode, out) == (2, "")
    assert told.startswith("error: unknown task 'Nope'; valid: ")


def test_the_tally_tells_failures_rate_and_money() -> None:
    from remac_bench.commands.progress import Tally

    tally = Tally()
    tally.add([record(), record(success=False), record(scored=False, success=False)])
    assert tally.told(2.0) == "1 failed, 1.5/s"
    broken = {"kind": "infrastructure", "type": "EndpointError", "message": "down"}
    tally.add([record(scored=False, success=False, error=broken, usage={"calls": 3, "money": 0.419, "unpriced": 0})])
    assert tally.told(2.0) == "1 failed, 1 broken, 2.0/s, $0.42"
    tally.add([record(usage={"calls": 1, "unpriced": 1})])
    assert tally.told(0.0) == "1 failed, 1 broken, $0.42+"


@pytest.mark.long
def test_leaderboard_is_the_same_command(tmp_path: Path) -> None:
    import subprocess
    import sys

    root = Path(__file__).parents[2]
    done = subprocess.run(
        [sys.executable, str(root / "benchmarks" / "leaderboard.py"), "--suite", "smoke", "--jobs", "0"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": f"{root}{os.pathsep}{root / 'benchmarks'}"},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert {entry.suite for entry in read(tmp_path / "results" / "smoke")} == {"smoke"}
