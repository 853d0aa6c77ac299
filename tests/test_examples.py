"""The files of examples/: short, of public names alone, each runs and says that it worked; README names them all."""

from __future__ import annotations

import ast
import json
import os
import re
import runpy
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from document_pages import check_span

ROOT = Path(__file__).parent.parent
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
MOST_LINES = 20

SAYS = {
    "checker": r"^1 of \d+ verdicts were wrong; the first:\nno shut door is in front of the microwave$",
    "generated_task": r"^MugsAway passes every check: put every mug into the pantry or chest$",
    "fixture": r"^PotatoToDrawer passes every check$",
    "gymnasium_one_robot": r"^turn on stove -> success\nreward 1.0 terminated True$",
    "method": r"^success True after 6 rounds$",
    "pettingzoo_two_robots": r"^rounds 8 truncated True$",
    "planner": r"^success True after 6 rounds$",
    "read_records": r"^CC HeatOnStove 2 success .*\n  round 1 robot_0 navigate to",
    "task": r"^PotatoToSink passes every check$",
    "vector_environment": r"'robot_0_action_mask': \(4, \d+\)",
    "video": r"^pictures in example.webm: [3-9]$",
}
"""What each says at the end."""

SLOW = ("fixture", "task", "video")
"""Those that take some seconds; videos and checks of tasks from outside are among the fast tests elsewhere."""

HERE = ("checker", "generated_task", "pettingzoo_two_robots", "planner", "task")
"""Those that run in the process of the tests, which has everything imported; the others start some or register more."""

PUBLIC = re.compile(
    r"gymnasium|numpy|pathlib|subprocess|sys|remac_env(\.testing|\.vocabulary|\.state|\.rules\.facts|\.tasks\.(goals|compound|setup|spec))?|remac_agents(\.roles)?|remac_bench\.store"
)
"""What users import."""


def started(*line: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """What a command of Python did."""
    return subprocess.run(
        [sys.executable, *line],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": f"{ROOT}{os.pathsep}{ROOT / 'benchmarks'}"},
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )


@pytest.mark.parametrize(
    "path",
    [pytest.param(path, marks=pytest.mark.long) if path.stem in SLOW else path for path in EXAMPLES],
    ids=[path.stem for path in EXAMPLES],
)
def test_an_example_runs_and_says_what_came_of_it(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    if path.stem in HERE:
        monkeypatch.chdir(tmp_path)
        runpy.run_path(str(path), run_name="__main__")
        said = capsys.readouterr().out
    else:
        done = started(str(path), folder=tmp_path)
        assert done.returncode == 0, done.stderr
        said = done.stdout
    assert re.search(SAYS[path.stem], said.strip(), flags=re.M), said
    if path.stem == "video":
        assert (tmp_path / "example.webm").stat().st_size > 1000


def imported(code: str) -> Iterator[str]:
    """The modules that a file imports, and the names with an underscore that it uses."""
    for node in ast.walk(ast.parse(code)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.module or "."
        elif isinstance(node, ast.Attribute) and node.attr.startswith("_"):
            yield node.attr


def test_examples_are_short_and_of_public_names_alone() -> None:
    assert {path.stem for path in EXAMPLES} == set(SAYS)
    for path in EXAMPLES:
        code = path.read_text("utf-8")
        assert len(code.splitlines()) <= MOST_LINES, f"{path.name} has more than {MOST_LINES} lines"
        strange = [name for name in imported(code) if not PUBLIC.fullmatch(name)]
        assert not strange, f"{path.name} uses {strange}"
    assert [n for n in imported("from remac_env.envs.parallel import x\nx._y") if not PUBLIC.fullmatch(n)] != []


def test_readme_names_every_example() -> None:
    named = re.findall(r"\]\(examples/(\w+)\.py\)", (ROOT / "README.md").read_text("utf-8"))
    assert sorted(named) == [path.stem for path in EXAMPLES]


def test_the_commands_in_examples_are_ones_that_the_program_takes(tmp_path: Path) -> None:
    told = {p.stem: re.findall(r"remac bench run [^\n\"\.]+\.py[^\n\"]*", p.read_text("utf-8")) for p in EXAMPLES}
    assert told["planner"] and told["task"]
    for stem, lines in told.items():
        for line in lines:
            check_span(line, f"examples/{stem}.py:1")
    files = [word for stem in ("task", "method") for word in ("--import", str(ROOT / "examples" / f"{stem}.py"))]
    done = started(
        *("-m", "remac_bench", "bench", "run", *files, "--planner", f"{ROOT / 'examples' / 'planner.py'}:plan"),
        *("--methods", "CHEERFUL", "--tasks", "OpenMicrowavePnP,PotatoToSink", "--seeds", "0"),
        *("--backend", "symbolic", "--jobs", "0", "--out", "out"),
        folder=tmp_path,
    )
    assert done.returncode == 0, done.stderr
    records = [json.loads(line) for line in (tmp_path / "out" / "records.jsonl").read_text().splitlines()]
    assert {record["method"] for record in records} == {"CHEERFUL"}
    assert {record["task"] for record in records} == {"OpenMicrowavePnP", "PotatoToSink"}
    assert all(record["success"] for record in records if record["task"] == "OpenMicrowavePnP")
