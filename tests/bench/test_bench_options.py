"""One table of options: what one row says of an option, flags, keywords, suites, records and errors say too."""

from __future__ import annotations

import ast
import importlib
import inspect
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any, get_args, get_type_hints

import pytest
import typer
from bench_helpers import ROOT
from remac_bench import flags
from remac_bench.cli import app
from remac_bench.flags import HOMES, TABLE, of, takes
from remac_bench.playing import agents, suites
from remac_bench.playing.settings import Settings
from test_bench_lines import COMMANDS

import remac_agents
import remac_env
from remac_agents.options import AgentOptions
from remac_env.errors import OptionError, UnknownNameError
from remac_env.option_rows import NEEDED, Choice, Row, Text, Whole, option, rows
from remac_env.options import Options

SCRIPTS = sorted(path.stem for path in (ROOT / "benchmarks").glob("*.py") if "run_script(main)" in path.read_text())
RUN = COMMANDS["bench", "run"].callback


def flags_of(command: Any) -> Iterator[tuple[str, Any, Any]]:
    """Parameter, typer's entry and default of each flag of a command."""
    hints = get_type_hints(command, include_extras=True)
    for name, each in inspect.signature(command).parameters.items():
        info = next((i for i in get_args(hints[name])[1:] if isinstance(i, typer.models.OptionInfo)), None)
        if info is not None:
            yield name, info, each.default


# -- nothing beside the table ---------------------------------------------------------------------------------------

DECLARING = ("Option", "OptionInfo", "add_argument", "option")


def declared_in(code: str) -> list[int]:
    """The lines on which a flag is declared to typer, click or argparse."""
    calls = [node for node in ast.walk(ast.parse(code)) if isinstance(node, ast.Call)]
    return [c.lineno for c in calls if isinstance(c.func, ast.Attribute) and c.func.attr in DECLARING]


def test_no_flag_is_declared_outside_the_table() -> None:
    found = {
        str(path.relative_to(ROOT / "benchmarks")): lines
        for path in (ROOT / "benchmarks").rglob("*.py")
        if (lines := declared_in(path.read_text("utf-8")))
    }
    assert list(found) == ["remac_bench/flags.py"] and len(found["remac_bench/flags.py"]) == 1


def test_a_flag_declared_elsewhere_would_be_found_out() -> None:
    """Or else the test above would prove nothing."""
    assert declared_in("import typer\ndef f(x: int = typer.Option(3)) -> None: ...\n") == [2]
    assert declared_in("import argparse\nargparse.ArgumentParser().add_argument('--x')\n") == [2]
    code = "def f(*, seeds: int, tries: int) -> None: ..."
    space: dict[str, Any] = {}
    exec(code, space)  # noqa: S102
    with pytest.raises(TypeError, match="'tries' is not a flag that it takes"):
        takes("run.seeds")(space["f"])


def every_command() -> Iterator[tuple[str, Any]]:
    assert app.registered_callback is not None
    yield "remac", app.registered_callback.callback
    yield from ((" ".join(words), entry.callback) for words, entry in COMMANDS.items())
    yield from ((name, importlib.import_module(name).main) for name in SCRIPTS)


def test_every_flag_of_every_command_says_what_its_row_says() -> None:
    known = {(flag.parameter, flag.written, flag.row.help) for flag in TABLE.values()}
    said: set[tuple[str, str, str]] = set()
    for _, command in every_command():
        for name, info, _ in flags_of(command):
            words = [word for word in (info.default, *(info.param_decls or ())) if isinstance(word, str)]
            written = words[0].partition("/")[0] if words else f"--{name.replace('_', '-')}"
            said.add((name, written, info.help))
    assert said == known, "each row is a flag of some command, and each flag a row"
    assert len(SCRIPTS) >= 13 and len(said) > 100 and all(text.endswith((".", "...")) for *_, text in said)


# -- the homes ------------------------------------------------------------------------------------------------------


UNSPOKEN = {"agent": {"limiter", "manners", "memory"}, "kitchen": {"interrupts", "masks", "obs_format"}}


@pytest.mark.parametrize("home", HOMES)
def test_every_option_of_a_home_is_a_flag_of_bench_run(home: str) -> None:
    parameters = {name: default for name, _, default in flags_of(RUN)}
    of_agents = rows(AgentOptions) if home == "access" else {}
    for name, row in rows(HOMES[home]).items():
        if row.spoken and name not in of_agents:
            (flag,) = (flag for flag in TABLE.values() if (flag.home, flag.keyword) == (home, name))
            assert flag.parameter in parameters
            if home == "kitchen" and name != "robots":
                assert parameters[flag.parameter] == row.default
    unspoken = {name for name, row in rows(HOMES[home]).items() if not row.spoken}
    assert unspoken == UNSPOKEN.get(home, set())


def test_fields_without_a_row_are_few_and_known() -> None:
    bare = {made.__name__: [f.name for f in fields(made) if "row" not in f.metadata] for made in HOMES.values()}
    assert bare == {"Options": [], "AgentOptions": [], "Access": [], "Settings": ["video_methods", "fresh"]}


def test_keywords_are_the_rows() -> None:
    for function, home in ((remac_env.parallel_env, Options), (remac_agents.make, AgentOptions)):
        parameters = list(inspect.signature(function).parameters.values())
        assert [p.name for p in parameters[1:]] == list(rows(home))
        for parameter in parameters[1:]:
            row = rows(home)[parameter.name]
            assert parameter.default == row.default is not NEEDED
            words = (function.__doc__ or "").replace("\n", " ").split()
            assert row.help.split()[-1] in words and f"{parameter.name}:" in words


def test_keys_of_suites_are_the_rows() -> None:
    keywords = {TABLE[name].keyword for name in of("kitchen")}
    assert set(suites.KITCHEN) == keywords - {"robots", "style", "layout", "render_mode"}
    assert set(suites.BUDGET) == set(agents.BUDGET) | set(agents.BOUNDS)
    assert set(agents.OPTIONS) <= set(rows(AgentOptions)) and set(flags.FROZEN) > {"wording", "retries", "iterations"}


WRONG = [
    ("kitchen", name, row) for name, row in rows(Options).items() if row.spoken and not isinstance(row.values, Text)
] + [("agent", name, row) for name, row in rows(AgentOptions).items() if row.values.kind in (int, float)]


@pytest.mark.parametrize(("home", "name", "row"), WRONG, ids=[f"{home} {name}" for home, name, _ in WRONG])
def test_flag_and_keyword_refuse_a_wrong_value_with_the_same_words(home: str, name: str, row: Row) -> None:
    from test_bench_cli import remac

    def told(error: str) -> str:
        return error.strip().rpartition("valid: ")[2].partition(", or None")[0].partition(" (--help")[0]

    make = remac_env.parallel_env if home == "kitchen" else remac_agents.make
    with pytest.raises((OptionError, UnknownNameError)) as by_keyword:
        make("HeatOnStove" if home == "kitchen" else "CC", **{name: -7})
    (flag,) = (flag for flag in TABLE.values() if (flag.home, flag.keyword) == (home, name))
    by_flag = remac("bench", "run", "--out", "never", f"{flag.written}=-7")
    assert by_flag.exit_code == 2 and told(by_flag.stderr) == told(str(by_keyword.value)) != ""


ROWS = {(flag.parameter, flag.row.help): flag.row for flag in TABLE.values()}
CHOSEN = [
    (words, command, name, written, row.values.names)
    for words, command in every_command()
    for name, info, _ in flags_of(command)
    for written in [next((w for w in (info.default, *(info.param_decls or ())) if isinstance(w, str)), f"--{name}")]
    if isinstance((row := ROWS[name, info.help]).values, Choice)
]


@pytest.mark.parametrize(
    ("words", "command", "name", "written", "valid"), CHOSEN, ids=[f"{each[0]} {each[3]}" for each in CHOSEN]
)
def test_every_command_refuses_what_is_none_of_the_choices_and_names_them(
    words: str, command: Any, name: str, written: str, valid: tuple[Any, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    """Before it does anything: what else it must be given it is not given here."""
    with pytest.raises(typer.Exit) as refused:
        command(**{name: "odd"})
    told = " ".join(capsys.readouterr().err.split())
    assert refused.value.exit_code == 2
    assert f"unknown {written.lstrip('-').replace('-', '_')} 'odd'; valid: {', '.join(map(str, valid))}" in told


def test_choices_are_refused_on_command_lines_too(tmp_path: Path) -> None:
    from test_bench_cli import remac

    out = ("--out", str(tmp_path / "never"))
    for line in (
        ("learn", "record-checker", "--backend", "dream", *out), ("learn", "record", "--format", "rlds", *out),
        ("learn", "record", "--pictures", "odd", *out), ("learn", "record", "--cells", "some", *out),
    ):  # fmt: skip
        found = remac(*line)
        assert found.exit_code == 2 and f"unknown {line[2][2:]} {line[3]!r}; valid: " in found.stderr, found.stderr
    assert not (tmp_path / "never").exists()
    assert {words for words, *_ in CHOSEN} >= {"learn record", "learn record-checker", "bench run", "pddl", "plan"}


def test_an_unknown_keyword_gets_the_valid_ones() -> None:
    with pytest.raises(UnknownNameError, match="keyword of remac_env.parallel_env 'robot'; valid: task, robots,"):
        remac_env.parallel_env("HeatOnStove", robot=1)
    with pytest.raises(UnknownNameError, match="unknown keyword of remac_agents.make 'chekcer'; valid: name, model,"):
        remac_agents.make("CC", chekcer="truth")


def test_a_row_says_whether_none_is_valid() -> None:
    assert Settings(workers=None).workers is None and Settings().workers == 1
    assert Row(help="x.", values=Whole(1)).check("x", None) is None
    with pytest.raises(OptionError, match="x None is not valid; valid: a whole number, 1 or more$"):
        Row(help="x.", default=3, values=Whole(1)).check("x", None)
    assert option(3, "x.", Whole(1)).default == 3 and option(3, "x.", Whole(1)).default is not MISSING


# -- one row more ---------------------------------------------------------------------------------------------------

KITCHEN_ROW = '    humidity: int = option(40, "Moisture of the air, percent.", Whole(0, 100))\n'
AGENT_ROW = '    patience: int = option(3, "How long an agent waits, rounds.", Whole(0, 9), group="bound")\n'
RUN_ROW = '    colour: str = option("red", "Of the progress bar: red or blue.", Choice(("red", "blue")))\n'
SUITE = """
name = "damp"
version = 1
methods = ["BASE"]
[budget]
patience = 5
[[jobs]]
tasks = ["HeatOnStove"]
seeds = "3"
kitchen = { backend = "symbolic", humidity = 61 }
"""

PROOF = """
import json, sys
from pathlib import Path
import remac_agents, remac_env
from remac_bench.cli import app

from remac_bench.playing.settings import Settings
from typer.testing import CliRunner

def run(*line):
    found = CliRunner().invoke(app, ["bench", "run", *line], env={"COLUMNS": "300"})
    return [found.exit_code, found.output]

def refused(make, *args, **given):
    try:
        make(*args, **given)
    except ValueError as error:
        return str(error)

common = ("--tasks", "HeatOnStove", "--methods", "BASE", "--seeds", "3", "--backend", "symbolic", "-j", "0")
told = {
    "help": run("--help"),
    "run": run("--out", "flags", *common, "--humidity", "7", "--patience", "4", "--colour", "blue"),
    "suite": run("--suite", "damp.toml", "--out", "suite", "-j", "0"),
    "frozen": run("--suite", "damp.toml", "--out", "x", "--humidity", "7"),
    "flag": [run("--out", "x", *common, f"--{name}=777")[1] for name in ("humidity", "patience", "colour")],
    "keyword": [
        refused(remac_env.parallel_env, "HeatOnStove", humidity=777), refused(remac_agents.make, "CC", patience=777),
        refused(Settings, colour="777"),
    ],
    "key": [],
    "doc": remac_env.parallel_env.__doc__ + remac_agents.make.__doc__,
}
suite = Path("damp.toml").read_text()
for old, new in (("humidity = 61", "humidity = 777"), ("patience = 5", "patience = 777")):
    Path("wrong.toml").write_text(suite.replace(old, new))
    told["key"].append(run("--suite", "wrong.toml", "--out", "x")[1])
for name in ("flags", "suite"):
    records = [json.loads(line) for line in Path(name, "records.jsonl").read_text().splitlines()]
    told[f"record {name}"] = records[-1]["options"] if name == "flags" else next(
        r["options"] for r in records if "planner" not in r["options"]["agent"])
print(json.dumps(told))
"""


def with_a_row_more(path: Path, before: str, row: str) -> None:
    text = path.read_text("utf-8")
    assert text.count(before) == 1
    path.write_text(text.replace(before, row + before), "utf-8")


def test_an_option_is_added_by_adding_its_row(tmp_path: Path) -> None:
    """A copy of the house with one line more for a kitchen's option, one for an agent's, one for a run's."""
    import json

    for folder in (ROOT / "remac_env", ROOT / "remac_agents", ROOT / "benchmarks" / "remac_bench"):
        shutil.copytree(folder, tmp_path / folder.name, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(ROOT / "benchmarks" / "suites", tmp_path / "remac_bench" / "suite_files")
    with_a_row_more(tmp_path / "remac_env" / "options.py", "    reward: str = option(", KITCHEN_ROW)
    with_a_row_more(tmp_path / "remac_agents" / "options.py", "    lead: str | None = option(", AGENT_ROW)
    with_a_row_more(tmp_path / "remac_bench" / "playing" / "settings.py", "    optimum: bool = option(", RUN_ROW)
    (tmp_path / "damp.toml").write_text(SUITE)
    done = subprocess.run(
        [sys.executable, "-c", PROOF], cwd=tmp_path, capture_output=True, text=True, check=False, timeout=300,
        env={"PYTHONPATH": str(tmp_path), "PATH": "/usr/bin:/bin"},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    for line in ("--humidity", "Moisture of the air, percent.", "--patience", "How long an agent waits, rounds.",
                 "--colour", "Of the progress bar: red or blue.", "[default: 40]"):  # fmt: skip
        assert line in told["help"][1], line
    assert "humidity: moisture of the air" in told["doc"] and "patience: how long an agent waits" in told["doc"]
    assert told["run"][0] == 0 and told["suite"][0] == 0, (told["run"], told["suite"])
    assert told["record flags"]["kitchen"]["humidity"] == 7 and told["record flags"]["agent"] == {"patience": 4}
    assert told["record suite"]["kitchen"]["humidity"] == 61 and told["record suite"]["agent"] == {"patience": 5}
    assert "--humidity does not go with suite 'damp'" in told["frozen"][1]
    spans = ("valid: whole numbers 0..100", "valid: whole numbers 0..9", "valid: red, blue")
    for found in (told["flag"], told["keyword"]):
        assert all(span in text for span, text in zip(spans, found, strict=True)), found
    assert all(span in text for span, text in zip(spans[:2], told["key"], strict=True)), told["key"]
