"""Tables in narrow terminals: whole words, or rows as lists."""

from __future__ import annotations

import io
import re
from pathlib import Path

import pytest
from remac_bench.board import Board, Cell, Column, Sheet
from remac_bench.cli import app
from remac_bench.columns import in_parts, laid_out
from remac_bench.commands.progress import Bar
from remac_bench.commands.tasks import list_tasks
from remac_bench.console import say
from remac_bench.report import board_tables
from rich import box
from rich.console import Console
from rich.table import Table
from typer.testing import CliRunner

BOXES = (box.SIMPLE_HEAD, box.MARKDOWN, box.HEAVY)


def printed(table: Table, width: int, *, fitted: bool = True) -> list[str]:
    """What a terminal of this width gets; `fitted` False: as rich alone lays it out."""
    made = Console(width=width, height=40, highlight=False, color_system=None)
    with made.capture() as got:
        for part in laid_out(table, width) if fitted else [table]:
            made.print(part, crop=False)
    return got.get().splitlines()


def table(edges: box.Box) -> Table:
    made = Table("Agent", "Where it was tried", "Rate", box=edges, title="Success", caption="with intervals")
    made.add_row("[bold]REMAC[/bold]", "one_wall_small, scandinavian, mediterranean", "97.4% (95.1-98.8)")
    made.add_row("baseline", "[dim]galley[/dim]", "3.0%")
    return made


@pytest.mark.parametrize("edges", BOXES)
def test_no_word_is_broken_at_any_width(edges: box.Box) -> None:
    words = ("REMAC", "one_wall_small,", "scandinavian,", "mediterranean", "97.4%", "(95.1-98.8)", "galley", "3.0%")
    alone = " ".join(printed(table(edges), 40, fitted=False))
    assert any(word not in alone for word in words), "rich alone breaks them"
    for width in range(20, 140):
        lines = printed(table(edges), width)
        assert all(any(word in line for line in lines) for word in words), width
        assert max(map(len, lines)) <= width or width < 30, width
    assert "Where it was tried: galley" in printed(table(edges), 30)


def test_what_has_no_head_stands_before_what_comes_next() -> None:
    made = Table("", "What", "", "Here")
    made.add_row("ok", "opencv-python-headless", "", "5.0")
    made.add_row("-", "", "[dim]both[/dim]", "")
    lines = [line.rstrip() for line in printed(made, 40)]
    assert lines == ["", "ok What: opencv-python-headless", "Here: 5.0", "", "- both", ""]


def test_parts_are_few_and_about_as_wide() -> None:
    numbers = [(name, 10) for name in "abcdefgh"]
    assert in_parts(numbers, 75) == [list("abcd"), list("efgh")]  # and no column alone on its line
    assert in_parts(numbers, 80) == [list("abcdefgh")] and in_parts([], 80) == [[]]
    assert in_parts([("a", 5), ("wide", 90), ("b", 5)], 80) == [["a"], ["wide"], ["b"]]


@pytest.mark.parametrize("letters", [70, 66])  # no number fits beside, or one and not two
def test_rows_whose_words_fill_the_terminal_are_shown_once_with_all_their_numbers(letters: int) -> None:
    columns = (Column(key="setting", title="Setting", numeric=False), *(Column(key=k, title=k.upper()) for k in "abc"))
    cells = {"setting": Cell(text="s" * letters)} | {key: Cell(text="99.9") for key in "abc"}
    board = Board(title="", sheets=(Sheet(key="wide", title="Wide", columns=columns, rows=(cells, cells)),))
    (made,) = board_tables(board, everything=True, across=79)  # and not one part for each number
    assert isinstance(made, Table) and len(made.columns) == 4
    assert "\n".join(printed(made, 80)).count("Setting: sss") == 2


@pytest.mark.parametrize("width", [80, 120])
def test_the_line_of_progress_keeps_its_numbers_and_cuts_the_agents_name(width: int) -> None:
    screen = Console(width=width, file=io.StringIO(), force_terminal=True, color_system=None)
    made = Bar(screen=screen)
    made.progress.add_task("OpenMicrowavePnP CC (planner=my_planner.py:plan)", total=120, completed=24,
                           told="8 failed, 1 broken, 12.5/s, $3.20")  # fmt: skip
    screen.print(made.progress)
    (line,) = screen.file.getvalue().splitlines()  # type: ignore[attr-defined]
    assert len(line) <= width and line.startswith("OpenMi") and "…" in line
    assert "24/120 episodes 8 failed, 1 broken, 12.5/s, $3.20 0:00:00 left -:--:--" in line


def test_lines_end_with_words_in_a_terminal_and_are_whole_elsewhere(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    line = "preflight: 6 jobs: about 160 calls, 270,000 tokens in [bold], 6,100 out :smile:, as measured"
    say(line)
    assert capsys.readouterr().out == f"{line}\n"
    monkeypatch.setenv("FORCE_COLOR", "1")  # rich's word for: this is a terminal
    monkeypatch.setenv("NO_COLOR", "1")
    say(line)
    told = capsys.readouterr().out
    assert told.split() == line.split() and max(map(len, told.splitlines())) <= 60


@pytest.mark.long  # looks for a graphics driver
def test_doctor_fits_into_eighty_columns_as_tables(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    told = CliRunner().invoke(app, ["doctor"]).output
    assert max(map(len, told.splitlines())) <= 80
    assert re.search(r"ok +opencv-python-headless +\d", told) and re.search(r"OPENROUTER_API_KEY +(not )?set", told)


def test_tasks_are_whole_in_eighty_columns(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    told = CliRunner().invoke(app, ["tasks"]).output
    lines = told.splitlines()
    assert max(map(len, lines)) <= 80
    names = {name for task in list_tasks() for name in (task["name"], *task["styles"], *task["layouts"])}
    for name in names:
        assert any(name in line.replace(",", " ").split() for line in lines), name


def test_every_table_is_shown_as_it_fits() -> None:
    root = Path(__file__).resolve().parents[2] / "benchmarks"
    texts = {path: path.read_text("utf-8") for path in root.rglob("*.py")}
    beside = [path.name for path, text in texts.items() if re.search(r"\bprint\(_?\w*(table|sheet)", text)]
    assert beside == [] and sum("show(" in text for text in texts.values()) > 10
