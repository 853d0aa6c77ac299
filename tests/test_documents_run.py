"""Every command and code block of README and docs runs, smaller than it stands there; what is only parsed is listed."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from chaos_server import ChaosServer, says
from document_pages import PAGES, DocumentError, blocks, check_line, check_span, spans
from document_play import KEYS, Play, smaller

ONLY_PARSED = {
    "make ": "installs everything; the targets are looked up",
    "pip ": "installs",
    "python benchmarks/timed_physics.py": "plays in physics for minutes",
    "python benchmarks/model_costs.py": "counts for minutes and writes into the documents",
    "python benchmarks/": "measures for minutes",
    "python examples/rl/": "learns for minutes; tests/integrations learns less",
    "python docs/": "draws for minutes",
    "remac bench accept": "plays a whole submission again; tests/bench plays small ones",
    "remac bench submit": "wants a suite played to its end; tests/bench submits small ones",
    "remac bench board": "wants an accepted entry",
    "remac bench run --skills learned": "plays in physics for minutes; tests/bench and tests/agents play less",
    "remac bench run --planner policy:": "wants a policy that was learnt; tests/agents plays one",
    'remac bench run --planner "pddl:': "wants a planner that is installed apart; tests/agents lets two play",
    "remac learn": "wants torch and h5py, and takes long; tests/bench records and trains a little",
    "remac play": "serves until somebody has played; tests/bench plays in a browser",
    "remac demo": "plays sixteen jobs; tests/bench plays it smaller",
    "python server.py": "is started where it is written down",
}
"""Beginnings of commands that are parsed and not run, and why."""

LONG = (
    *("docs/experiments.md", "docs/headroom.md", "docs/time.md"),
    *("docs/tutorials/judging.md", "docs/tutorials/task.md"),
)
"""Pages whose commands take more than a few seconds even when they are made smaller."""

APART = {"docs/robosuite.md": "robosuite", "docs/learning.md": "supersuit"}
"""Pages that want what is installed apart; tests/integrations carries them out there."""

LINES = [(line, block.where) for page in PAGES for block in blocks(page) for line in block.lines]
SPANS = [span for page in PAGES for span in spans(page)]
CARRIED_OUT = [page for page in PAGES if any(b.lines or b.language in ("python", "toml", "json") for b in blocks(page))]


def skipped(line: str) -> bool:
    """Whether a command is only parsed; the leaderboard script is the same as `remac bench run`."""
    return line.startswith(tuple(ONLY_PARSED)) and "leaderboard.py" not in line


@pytest.mark.parametrize(("line", "where"), LINES, ids=[f"{where} {line[:40]}" for line, where in LINES])
def test_every_command_is_one_that_the_program_takes(line: str, where: str) -> None:
    check_line(line, where)


@pytest.mark.parametrize(("line", "where"), SPANS, ids=[f"{where} {line[:40]}" for line, where in SPANS])
def test_commands_in_running_text_have_the_options_that_they_name(line: str, where: str) -> None:
    check_span(line, where)


def test_there_is_something_to_look_at() -> None:
    assert len(LINES) > 40 and len(SPANS) > 25 and len(CARRIED_OUT) >= 8
    for beginning in ONLY_PARSED:
        assert beginning in ("pip ", "python docs/") or any(line.startswith(beginning) for line, _ in LINES), beginning


@pytest.fixture
def play(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Play]:
    """A page's folder, and a model that answers every question with the same."""
    monkeypatch.chdir(tmp_path)
    for key in (KEYS, "OPENAI_API_KEY", "OPENROUTER_API_KEY", "CUSTOM_API_KEY"):
        monkeypatch.setenv(key, "sk-test")
    with ChaosServer([says('Plan: [navigate to counter]')]) as server:
        made = Play(tmp_path, server.url)
        made.begin()
        try:
            yield made
        finally:
            made.end()


@pytest.mark.parametrize(
    "page", [pytest.param(page, marks=pytest.mark.long) if page in LONG else page for page in CARRIED_OUT]
)
def test_the_pages_can_be_carried_out_from_top_to_bottom(page: str, play: Play) -> None:
    if page in APART:
        pytest.importorskip(APART[page], reason=f"{page} says how to install it")
    for block in blocks(page):
        play.block(block, skipped)


WRONG = {
    "an option that does not exist": "```sh\nremac bench run --out x --task HeatOnStove\n```\n",
    "an option that went": "Text:\n\n    remac oracle --task HeatOnStove --depth 3\n",
    "what is demanded left out": "```bash\nremac plan --planner literal\n```\n",
    "a command that does not exist": "```\nremac bench replay DIR\n```\n",
    "a number that is none": "```sh\nremac experiment wording --n 0\n```\n",
    "a script that does not exist": "    x\n\n    python benchmarks/no_such.py\n",
    "an option of a script": "```sh\npython benchmarks/twin.py --seed 3\n```\n",
    "an extra": "```sh\npip install 'remac-kitchen[robosweet]'\n```\n",
    "a target": "```bash\nmake everything\n```\n",
    "what a reader would have to choose": "```sh\nremac oracle --task HeatOnStove [--robots 2]\n```\n",
    "a line that goes on": "```sh\nremac oracle --task HeatOnStove \\\n  --robot 2\n```\n",
}


@pytest.mark.parametrize("case", WRONG)
def test_a_document_with_a_wrong_command_is_found_out(case: str) -> None:
    """Or else the tests above would prove nothing."""
    lines = [(line, block.where) for block in blocks("wrong.md", WRONG[case]) for line in block.lines]
    assert lines, "the command was not even seen"
    with pytest.raises(DocumentError, match=r"wrong\.md:\d"):
        for line, where in lines:
            check_line(line, where)


FAILING = {
    "a task that does not exist": "```sh\nremac bench run --tasks HeatOnRadiator --out x\n```\n",
    "Python that raises": "```python\nimport remac_env\nremac_env.parallel_env('HeatOnStove', robot=2)\n```\n",
    "a server that never serves": "```python\n# server.py\nfrom http.server import HTTPServer, BaseHTTPRequestHandler\n"
    'server = HTTPServer(("127.0.0.1", 8000), BaseHTTPRequestHandler)\n```\n',
    "Python that prints something else": "```python\nprint(6 * 9)\n```\n\n```text\n42\n```\n",
    "a suite with a wrong key": '```toml\nname = "mine"\nversion = 1\nmethod = ["CC"]\n```\n',
    "a suite that does not exist": "```sh\nremac bench run --suite papers\n```\n",
    "a planner that is not there": "```sh\nremac bench run --planner mine.py:plan --methods BASE --out x\n```\n",
}


@pytest.mark.parametrize("case", FAILING)
def test_a_document_that_does_not_work_is_found_out(case: str, play: Play) -> None:
    with pytest.raises((DocumentError, TypeError, ValueError)):
        for block in blocks("wrong.md", FAILING[case]):
            play.block(block, skipped)


def test_commands_are_made_smaller_and_stay_what_they_are() -> None:
    made = smaller(["bench", "run", "--suite", "paper", "--model", "openai:o3"])
    assert made == [
        *("bench", "run", "--model", "openai:o3", "--out", "results/paper", "--seeds", "0", "--tasks", "HeatOnStove"),
        *("--methods", "BASE", "--max-rounds", "5", "--iterations", "1", "--image-size", "32", "--jobs", "0"),
        *("--backend", "symbolic"),
    ]
