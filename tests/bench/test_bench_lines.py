"""Command lines: every number, every option given twice, every file to be written, every odd terminal."""

from __future__ import annotations

import inspect
import json
import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin, get_type_hints

import numpy as np
import pytest
import typer
from bench_helpers import ROOT, read
from remac_bench.cli import app
from remac_bench.command import Command, joined
from remac_bench.console import console
from remac_bench.flags import parsed
from remac_bench.store import Store
from test_bench_cli import remac
from typer.testing import CliRunner

import remac_agents
import remac_env
from remac_env.errors import OptionError
from remac_env.option_rows import Real, Whole

NO_NUMBERS = ("nan", "inf", "-inf", "-1", "1e400", "0x10", "", "12a", "9" * 5000, "true", "\u0663.\u0663.")
"""Texts that are no valid value of any of our numbers."""


def commands(group: typer.Typer = app, words: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Every command: its words, and typer's entry of it."""
    for entry in group.registered_commands:
        yield (*words, entry.name or entry.callback.__name__), entry
    for part in group.registered_groups:
        yield from commands(part.typer_instance, (*words, part.name))


def options(callback: Callable[..., Any]) -> Iterator[tuple[str, tuple[type, ...], Any]]:
    """Every option of a command: how it is written, its types, and typer's entry of it."""
    hints = get_type_hints(callback, include_extras=True)
    for name in inspect.signature(callback).parameters:
        if hasattr(hints[name], "__metadata__"):
            kind, info = get_args(hints[name])
            if isinstance(info, typer.models.OptionInfo):
                words = [word for word in (info.default, *(info.param_decls or ())) if isinstance(word, str)]
                flag = next((word for word in words if word.startswith("--")), None)
                yield (flag or f"--{name.replace('_', '-')}").partition("/")[0], kinds(kind), info


def kinds(annotation: Any) -> tuple[Any, ...]:
    """The types that an annotation allows."""
    return get_args(annotation) if get_origin(annotation) in (Union, UnionType) else (annotation,)


COMMANDS = dict(commands())
OPTIONS = [(words, *option) for words, entry in COMMANDS.items() for option in options(entry.callback)]
NUMBERS = [(words, flag) for words, flag, kinds, _ in OPTIONS if {int, float} & set(kinds)]
SINGLE = [(words, flag, kinds) for words, flag, kinds, _ in OPTIONS if not any("list" in str(k) for k in kinds)]


def one_line(result: Any) -> str:
    """What a command that was refused said."""
    assert result.exit_code == 2, (result.exit_code, result.output, result.exception)
    lines = result.stderr.strip().splitlines()
    assert len(lines) == 1 and lines[0].startswith("error: ") and len(lines[0]) < 600, result.stderr
    return lines[0]


def test_the_commands_are_all_here() -> None:
    assert len(COMMANDS) >= 14 and ("bench", "run") in COMMANDS
    assert all(issubclass(entry.cls, Command) for entry in COMMANDS.values()), "app.command(cls=Command)"
    assert len(NUMBERS) > 25 and len(SINGLE) > 80


# -- numbers that are none (19) -------------------------------------------------------------------------------------


@pytest.mark.parametrize(("words", "flag"), NUMBERS, ids=[" ".join((*words, flag)) for words, flag in NUMBERS])
def test_a_number_that_is_none_is_refused_with_the_range(words: tuple[str, ...], flag: str) -> None:
    for text in NO_NUMBERS:
        told = one_line(remac(*words, f"{flag}={text}"))
        assert flag in told and "valid: " in told, told
        span = told.partition("valid: ")[2]
        assert "number" in span or span[0].isdigit(), told


def test_a_number_without_a_range_would_be_found_out() -> None:
    """Or else the test above would prove nothing."""
    loose = typer.Typer()

    @loose.command(cls=Command)
    def play(seconds: float = 1.0, rounds: Annotated[float, typer.Option(**parsed(Real(1.0)))] = 2.0) -> None:
        """Play."""

    assert CliRunner().invoke(loose, ["--seconds", "inf"]).exit_code == 0
    assert "valid: a number, 1 or more" in one_line(CliRunner().invoke(loose, ["--rounds", "inf"]))
    assert CliRunner().invoke(loose, ["--rounds", "1.5"]).exit_code == 0


def test_numbers_that_are_some_are_taken() -> None:
    taken = typer.Typer()

    @taken.command(cls=Command)
    def play(
        seconds: Annotated[float | None, typer.Option(**parsed(Real(0.0, 9.5)))] = None,
        rounds: Annotated[int, typer.Option(**parsed(Whole(1, 3)))] = 2,
    ) -> None:
        """Play."""
        typer.echo(f"{seconds!r} {rounds!r}")

    assert CliRunner().invoke(taken, []).output == "None 2\n"
    assert CliRunner().invoke(taken, ["--seconds", "9", "--rounds", "3"]).output == "9.0 3\n"
    assert "valid: 1, 2, 3" in one_line(CliRunner().invoke(taken, ["--rounds", "4"]))


@pytest.mark.parametrize(
    ("role", "name", "option"),
    [
        ("checker", "noisy", "miss"), ("checker", "noisy", "false_alarm"), ("planner", "random", "steps"),
        ("handover", "search", "max_states"), ("planner", "http://127.0.0.1:1/plan", "seconds"),
        ("planner", "http://127.0.0.1:1/plan", "most_bytes"),
    ],
)  # fmt: skip
def test_numbers_in_options_of_roles(role: str, name: str, option: str, tmp_path: Path) -> None:
    for wrong in (float("nan"), float("inf"), -1, True, "0x10", "nan", None):
        with pytest.raises(OptionError, match=f"{option} .* is not valid; valid: "):
            remac_agents.make("CC", **{role: {"name": name, option: wrong}})
    for text in ("nan", "NaN", "Infinity", "-1", "1e400", "0x10", "true"):
        told = one_line(
            remac("bench", "run", "--out", str(tmp_path / "x"), "--backend", "symbolic", "--seeds", "0", f"--{role}",
                  f"{name},{option}={text}")
        )  # fmt: skip
        assert option in told and "valid: " in told
    assert not (tmp_path / "x").exists()
    remac_agents.make("CC", **{role: {"name": name, option: np.float32(1) if option == "miss" else np.int64(1)}})


# -- an option given twice (13) -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "flag", "kinds"), SINGLE, ids=[" ".join((*words, flag)) for words, flag, _ in SINGLE]
)
def test_an_option_given_twice_is_refused(words: tuple[str, ...], flag: str, kinds: tuple[type, ...]) -> None:
    twice = [flag, flag] if bool in kinds else [f"{flag}=1", f"{flag}=2"]
    assert one_line(remac(*words, *twice)) == f"error: {flag} is given twice; valid: once"
    if bool not in kinds:
        assert "given twice" in one_line(remac(*words, flag, "1", f"{flag}=1")), "the same value, too"


def test_a_flag_and_its_opposite_are_the_same_option_given_twice() -> None:
    assert "--pages is given twice" in one_line(remac("bench", "report", "x", "--pages", "--no-pages"))
    assert "--jobs is given twice" in one_line(remac("bench", "run", "-j", "1", "--jobs", "2"))


def test_lists_given_twice_add_up(tmp_path: Path) -> None:
    result = remac(
        "bench", "run", "--out", str(tmp_path), "--backend", "symbolic", "--jobs", "0", "--tasks", "HeatOnStove",
        "--tasks", "OpenCabinetPnP,HeatOnStove", "--methods", "BASE", "--methods", "CC", "--seeds", "0",
        "--seeds", "3:5",
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    seen = {(record.task, record.method, record.seed) for record in read(tmp_path)}
    tasks, methods = ("HeatOnStove", "OpenCabinetPnP"), ("BASE", "CC")
    assert seen == {(task, method, seed) for task in tasks for method in methods for seed in (0, 3, 4)}


@pytest.mark.long
def test_lists_of_experiments_and_demos_add_up(tmp_path: Path) -> None:
    file = tmp_path / "x.json"
    result = remac(
        "experiment", "validity", "--planner", "literal", "--planner", "noop", "--n", "1", "--json", str(file),
        "--tasks", "HeatOnStove", "--tasks", "OpenCabinetPnP", "--robots", "1", "--robots", "2", "--starts", "paper",
        "--starts", "mixed",
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    assert len(json.loads(file.read_text())["trials"]) == 16
    result = remac("demo", "--out", str(tmp_path / "d"), "--backend", "symbolic", "--no-video", "--seeds", "0",
                   "--seeds", "1", "-j", "0")  # fmt: skip
    assert result.exit_code == 0 and {record.seed for record in read(tmp_path / "d")} == {0, 1}


@pytest.mark.parametrize("kind", ["tasks", "methods", "seeds"])
def test_an_empty_part_of_a_list_is_refused(kind: str, tmp_path: Path) -> None:
    good = {"tasks": "HeatOnStove", "methods": "CC", "seeds": "1"}[kind]
    told = one_line(remac("bench", "run", "--out", str(tmp_path), f"--{kind}", good, f"--{kind}", ""))
    assert kind in told and joined(["a", "b,c"], "x") == "a,b,c"


# -- files that cannot be written (12) ------------------------------------------------------------------------------

WRITERS: dict[str, tuple[str, ...]] = {
    "bench run": ("bench", "run", "--tasks", "HeatOnStove", "--seeds", "0", "--planner", "{planner}", "--out", "{to}"),
    "a suite": ("bench", "run", "--suite", "smoke", "--planner", "{planner}", "--out", "{to}"),
    "a cassette": ("bench", "run", "--tasks", "HeatOnStove", "--seeds", "0", "--model", "custom:m", "--base-url",
                   "http://127.0.0.1:9/v1", "--out", "{out}", "--cassette", "{to}"),
    "demo": ("demo", "--seeds", "0", "--out", "{to}"),
    "experiment": ("experiment", "validity", "--planner", "{planner}", "--n", "1", "--json", "{to}"),
    "submit": ("bench", "submit", "{records}", "--name", "Crew", "--contact", "crew@example.org", "--out", "{to}"),
    "report": ("bench", "report", "{records}", "--csv", "{to}.csv"),
    "report into a folder": ("bench", "report", "{records}", "--csv", "{to}"),
}  # fmt: skip
"""Every command that writes, with a planner that must not be asked."""

_PLANNER = """
from pathlib import Path

def plan(request):
    Path({asked!r}).write_text("asked")
    return []
"""


@pytest.fixture
def words(tmp_path: Path) -> dict[str, str]:
    """What stands for the names in WRITERS; `to` lies behind a file, where no folder can be made."""
    (tmp_path / "file").write_text("no folder")
    planner = tmp_path / "planner.py"
    planner.write_text(_PLANNER.format(asked=str(tmp_path / "asked")))
    records = tmp_path / "records"
    assert remac("bench", "run", "--out", str(records), "--tasks", "HeatOnStove", "--methods", "BASE", "--seeds", "0",
                 "--backend", "symbolic", "-j", "0").exit_code == 0  # fmt: skip
    return {
        "to": str(tmp_path / "file" / "deep" / "x"), "planner": f"{planner}:plan", "records": str(records),
        "out": str(tmp_path / "out"),
    }  # fmt: skip


@pytest.mark.parametrize("name", WRITERS)
def test_what_cannot_be_written_is_refused_before_anything_is_asked(
    name: str, words: dict[str, str], tmp_path: Path
) -> None:
    before = sorted(tmp_path.rglob("*"))
    told = one_line(remac(*(word.format(**words) for word in WRITERS[name])))
    assert "deep" in told and ("Not a directory" in told or "exists" in told), told
    assert not (tmp_path / "asked").exists(), "the planner was asked all the same"
    assert sorted(tmp_path.rglob("*")) == before


def test_folders_are_made(words: dict[str, str], tmp_path: Path) -> None:
    for name in ("experiment", "report", "report into a folder"):
        to = tmp_path / "new" / name / "x"
        result = remac(*(word.format(**words | {"to": str(to), "planner": "noop"}) for word in WRITERS[name]))
        assert result.exit_code == 0, result.output
        assert to.exists() or to.with_suffix(".csv").exists()


def test_labels_are_not_made_where_they_cannot_be_kept(words: dict[str, str]) -> None:
    (Path(words["records"]) / "blame.jsonl").mkdir()
    assert "blame.jsonl" in one_line(remac("bench", "blame", words["records"]))


def test_memories_and_videos_are_refused_first(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no folder")
    for wrong in (tmp_path / "file" / "x.jsonl", tmp_path):
        with pytest.raises(OptionError, match="memory .* cannot be written"):
            remac_agents.make("CC", memory=wrong)
    made = remac_agents.make("CC", memory=tmp_path / "new" / "memory.jsonl")
    assert not (tmp_path / "new" / "memory.jsonl").exists() and len(made.memory) == 0
    env = remac_env.parallel_env("HeatOnStove", backend="symbolic")
    env.start_recording()
    env.reset(seed=0)
    env._pictures._stage = lambda moment: pytest.fail("drawn before the path was looked at")
    for wrong in (tmp_path / "file" / "x.webm", tmp_path / "x.mp4"):
        with pytest.raises(OptionError, match=r"\.webm|cannot be written"):
            env.save_recording(wrong)


# -- odd terminals (24) ---------------------------------------------------------------------------------------------

ODD = ["COLUMNS=0", "COLUMNS=1", "COLUMNS=-5", "COLUMNS=wide", "COLUMNS=", "COLUMNS=1000000000000", "COLUMNS=\u0663",
       "TERM=dumb", "TERM=", "NO_COLOR=1", "LINES=0"]  # fmt: skip


@pytest.mark.parametrize("setting", ODD)
def test_tables_are_whole_in_odd_terminals(setting: str, words: dict[str, str]) -> None:
    name, _, value = setting.partition("=")
    shown = remac("tasks", env={name: value})
    assert shown.exit_code == 0
    for task in remac_env.tasks():
        assert task in shown.output
    line = ("bench", "report", words["records"], "--no-pages")
    usual, odd = remac(*line), remac(*line, env={name: value})
    assert odd.exit_code == usual.exit_code
    assert _letters(odd.output) == _letters(usual.output), setting
    usual, odd = remac("doctor"), remac("doctor", env={name: value})
    assert odd.exit_code == usual.exit_code
    assert not set(re.findall(r"\w+", usual.output)) - set(re.findall(r"\w+", odd.output)), setting


def _letters(text: str) -> list[str]:
    """The letters and figures of a text, wherever lines are broken."""
    return sorted(letter for letter in text if letter.isalnum())


def test_the_width_is_sensible_whatever_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TERM", "dumb")
    for said, width in (("0", 120), ("1", 60), ("90", 90), ("99999", 1000), ("9" * 30, 120), ("x", 120)):
        monkeypatch.setenv("COLUMNS", said)
        assert console().width == width


_SHOW = ("tasks", "doctor", "bench report {records} --no-pages", "bench run --help", "memory --help")


@pytest.mark.few(1)
@pytest.mark.parametrize("settings", [{"PYTHONIOENCODING": "ascii"}, {"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0",
                                      "PYTHONUTF8": "0", "COLUMNS": "1000000000000"}], ids=["ascii", "C"])  # fmt: skip
def test_streams_that_cannot_write_every_letter(settings: dict[str, str], words: dict[str, str]) -> None:
    parts = "; ".join(f"run({line.format(**words).split()!r})" for line in _SHOW)
    code = (
        "import sys\nfrom remac_bench.cli import main\n"
        "def run(line):\n    sys.argv = ['remac', *line]\n    try:\n        main()\n"
        "    except SystemExit as end:\n        assert end.code in (0, None) or line == ['doctor'], end.code\n"
        f"{parts}\nprint('all shown')"
    )
    _name_a_task_oddly(Path(words["records"]))
    done = subprocess.run(
        [sys.executable, "-c", code], env={**os.environ, **settings}, cwd=ROOT, capture_output=True, check=False
    )
    assert done.returncode == 0 and b"all shown" in done.stdout, done.stderr
    assert b"HeatOnStove" in done.stdout and max(done.stdout) < 128


_SHELL = (  # closed streams, full ones, a folder that is gone: what is run, its exit code, what it says last
    ("exec {remac} {run} >&- 2>&- <&-", 0, ""),
    ("exec {remac} tasks >&-", 0, ""),
    ("{remac} tasks > /dev/full", 1, "error: the output cannot be written: No space left on device"),
    ("mkdir gone; cd gone; rmdir ../gone; exec {remac} tasks", 2, "the working folder is not there"),
)


@pytest.mark.few(1)
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no full device here")
@pytest.mark.parametrize(("line", "code", "told"), _SHELL)
def test_streams_that_are_closed_or_full(line: str, code: int, told: str, tmp_path: Path) -> None:
    run = "bench run --backend symbolic --tasks HeatOnStove --methods BASE --seeds 0 -j 0 --out out"
    done = subprocess.run(
        ["sh", "-c", line.format(remac=f"{sys.executable} -m remac_bench", run=run)], cwd=tmp_path, check=False,
        env={**os.environ, "PYTHONPATH": f"{ROOT}:{ROOT}/benchmarks"}, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == code and told in done.stderr and "Traceback" not in done.stderr, done.stderr
    if "{run}" in line:
        assert len(Store(tmp_path / "out").read()) == 1, "and nothing was printed into the records"


@pytest.mark.parametrize(
    "words",
    [("--seeds", "9" * 5000), ("--seeds", f"0:{'9' * 5000}"), ("--import", ""), ("--import", "../.."), ("--out", "")],
    ids=["seed", "seeds", "no module", "path", "no folder"],
)
def test_odd_words_are_refused_in_one_line(words: tuple[str, ...], tmp_path: Path) -> None:
    rest = () if words[0] == "--out" else ("--out", str(tmp_path / "out"))
    told = one_line(remac("bench", "run", "--backend", "symbolic", *rest, *words))
    assert "valid" in told or "no module" in told
    assert len(told) < 400 and not (tmp_path / "out").exists()


def _name_a_task_oddly(folder: Path) -> None:
    """Records of an agent whose name is no ASCII."""
    store = Store(folder)
    store.append([record.model_copy(update={"job": "odd", "agent": "Caf\u00e9 \u2615"}) for record in store.read()])
