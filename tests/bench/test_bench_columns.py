"""Tables in narrow terminals: whole words, or rows as lists."""

from __future__ import annotations

import io
import re
from pathlib import Path

import pytest
from remac_bench.board import Board, Cell, Column, Sheet
from remac_bench.cli import app
from remac_bench.columns import in_parts, laid_out, show
from remac_bench.commands.progress import Bar
from remac_bench.commands.tasks import list_tasks
from remac_bench.console import broken, plain, say
from remac_bench.report import board_tables
from rich import box
from rich.cells import cell_len
from rich.console import Console
from rich.markup import escape
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


LONG = "CC (checker=noisy,false_alarm=0.125,miss=0.25, reflector=openrouter:anthropic/claude-sonnet-4.5)"
PATH = f"REMAC (planner={'of_the_second_kind/' * 6}my_planner_of_plans.py:plan,temperature=0.75)"
HOSTILE = "[bold]no[/nope] <script>alert(1)</script>\u202e\x1b[31m :bomb: " + "模型" * 14
NAMES = ("BASE", LONG, PATH, HOSTILE, "s" * 90)
NUMBERS = [f"{number}.{number}%" for number in range(31, 43)]


def whole(text: str, lines: list[str], width: int) -> bool:
    """Whether every word stands in one line, or, where it is wider than a line, every part of it."""
    words = [word if cell_len(word) <= width - 2 else re.split(r"[,/:=]", word) for word in plain(text).split()]
    parts = [part for word in words for part in ([word] if isinstance(word, str) else word)]
    return all(any(part in line for line in lines) for part in parts)


@pytest.mark.parametrize("width", [60, 80, 200])
@pytest.mark.parametrize("kind", ["board", "heads", "rows"])
def test_no_name_and_no_number_is_broken_however_long_names_are(
    kind: str, width: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", str(width))
    if kind == "board":
        text = [Column(key=key, title=title, numeric=False) for key, title in (("a", "Method"), ("b", "Checked by"))]
        columns = (*text, *(Column(key=number, title="OpenMicrowavePnP") for number in NUMBERS))
        cells = {"b": Cell(text=LONG), **{number: Cell(text=number) for number in NUMBERS}}
        rows = tuple({"a": Cell(text=name), **cells} for name in NAMES)
        sheet = Sheet(key="wide", title=f"Ranking: checked by {LONG}", columns=columns, rows=rows)
        show(*board_tables(Board(title="", sheets=(sheet, sheet)), everything=True, across=width - 1))
    elif kind == "heads":  # as in `remac experiment`: a column for each planner
        made = Table("Of", *(escape(plain(name)) for name in NAMES), title=escape(LONG))
        for number in NUMBERS:
            made.add_row("HeatOnStove", *[f"{number}\n31%-88%"] * len(NAMES))
        show(made)
    else:
        made = Table("Agent", *NUMBERS, caption=escape(PATH))
        for name in NAMES:
            made.add_row(escape(plain(name)), *NUMBERS)
        show(made, escape(PATH))
    lines = capsys.readouterr().out.splitlines()
    for text_ in (*NAMES, *NUMBERS):
        assert whole(text_, lines, width), text_
    assert not any("\x1b" in line or "\u202e" in line for line in lines)
    assert all(cell_len(line.rstrip()) <= width or re.search(r"\S{70}", line) for line in lines)


def test_a_long_name_is_a_footnote_with_one_number_in_all_tables() -> None:
    columns = (Column(key="agent", title="Agent", numeric=False), *(Column(key=k, title=k.upper()) for k in "abcd"))
    cells = [{"agent": Cell(text=name)} | {key: Cell(text="99.9") for key in "abcd"} for name in ("BASE", LONG, PATH)]
    sheets = [Sheet(key=key, title=key, columns=columns, rows=tuple(rows))
              for key, rows in (("one", cells), ("two", [cells[2], cells[1]]))]  # fmt: skip
    one, *told, two, first, second, _ = board_tables(Board(title="", sheets=tuple(sheets)), everything=True, across=79)
    assert isinstance(one, Table) and isinstance(two, Table)
    assert list(one.columns[0].cells) == ["BASE", "CC [1]", "REMAC [2]"]
    assert list(two.columns[0].cells) == ["REMAC [2]", "CC [1]"]
    assert [str(line) for line in told] == [f"[1] {LONG}", f"[2] {PATH}", ""]
    assert [str(first), str(second)] == [f"[1] {LONG}", f"[2] {PATH}"]


def test_many_columns_of_numbers_come_in_parts_with_the_first_words_in_each() -> None:
    made = Table("Starts", "Of", title="Valid plans", caption="with intervals")
    for number in range(8):
        made.add_column(f"planner {number}\nreflections", justify="right")
    made.add_row("paper", "wording 1", *(f"{number}0/80\n95%-100%" for number in range(8)))
    parts = laid_out(made, 80)
    assert all(isinstance(part, Table) for part in parts) and len(parts) == 2
    assert [[column.header for column in part.columns[:2]] for part in parts] == [["Starts", "Of"]] * 2  # type: ignore[union-attr]
    lines = printed(made, 80)
    assert max(map(len, lines)) <= 80 and sum("Valid plans" in line for line in lines) == 1
    assert all(any(f"{number}0/80" in line for line in lines) for number in range(8))


def test_what_footnotes_do_not_make_narrow_enough_is_shown_as_lists() -> None:
    columns = [Column(key=key, title=key.upper(), numeric=False) for key in "abcd"]
    cells = {key: Cell(text=f"{key * 20}.py") for key in "abcd"} | {"e": Cell(text="99.9")}
    sheet = Sheet(key="wide", title="Wide", columns=(*columns, Column(key="e", title="E")), rows=(cells, cells))
    (made,) = board_tables(Board(title="", sheets=(sheet,)), everything=True, across=79)
    assert isinstance(made, Table) and "\n".join(printed(made, 80)).count("A: aaaa") == 2


def test_lines_end_with_words_and_with_parts_of_words_that_are_wider() -> None:
    assert broken("one two three", 8) == ["one two", "three"]
    assert broken("see runs/first/of_many/records.jsonl, twice\n", 12) == [
        "see runs/", "first/", "of_many/", "records.jsonl,", "twice", ""
    ]  # fmt: skip
    assert broken("x" * 30 + " 12.5", 10) == ["x" * 30, "12.5"] and broken("", 10) == [""]
    assert broken("模型模型 模型", 9) == ["模型模型", "模型"]


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
    beside = [path.name for path, text in texts.items() if re.search(r"console(\(\))?\.print\(|screen\.print\(", text)]
    assert beside == ["progress.py"], "above its bar"  # `say` for lines, `show` for tables: no other breaks no word
    assert sum("show(" in text for text in texts.values()) > 10
