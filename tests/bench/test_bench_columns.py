"""Tables in narrow terminals: whole words, or rows as lists."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from remac_bench.cli import app
from remac_bench.columns import in_parts, laid_out
from remac_bench.commands.tasks import list_tasks
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
    assert lines == ["", "ok What: opencv-python-headless", "Here: 5.0", "", "- both"]


def test_parts_are_few_and_about_as_wide() -> None:
    numbers = [(name, 10) for name in "abcdefgh"]
    assert in_parts(numbers, 75) == [list("abcd"), list("efgh")]  # and no column alone on its line
    assert in_parts(numbers, 80) == [list("abcdefgh")] and in_parts([], 80) == [[]]
    assert in_parts([("a", 5), ("wide", 90), ("b", 5)], 80) == [["a"], ["wide"], ["b"]]


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
