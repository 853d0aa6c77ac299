"""The board as text: for terminals, as Markdown and as CSV."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import pytest
from bench_helpers import record
from remac_bench.cli import app
from remac_bench.columns import across, show
from remac_bench.report import board_tables, read_board, read_rows, tables
from remac_bench.sheets import ACROSS
from remac_bench.store import Store
from rich.console import Console
from typer.testing import CliRunner

LONG = "CC (checker=noisy,false_alarm=0.2,miss=0.2)"
EVIL = "=1+1\x1b[31m|<script>\n"


def fill(folder: Path) -> None:
    agents = [("CC", "CC"), ("CC", LONG), ("REMAC", "REMAC"), ("BASE", EVIL)]
    Store(folder).append(
        [
            record(job=f"{agent}{task}{seed}", method=method, agent=agent, task=task, seed=seed, success=agent != EVIL)
            for method, agent in agents
            for task in ("OpenMicrowavePnP", "HeatOnStove")
            for seed in range(8)
        ]
    )


def report(folder: Path, *flags: str) -> str:
    result = CliRunner().invoke(app, ["bench", "report", str(folder), *flags])
    assert result.exit_code == 0, result.output
    return result.stdout


def test_the_main_table_fits_a_hundred_columns(tmp_path: Path) -> None:
    named = {"task": "OpenMicrowavePnP"}
    Store(tmp_path).append([record(job=name, agent=name, method=name, **named) for name in ("CC", "REMAC")])
    screen = Console(width=200, record=True, file=io.StringIO())
    for part in tables(read_rows(tmp_path), across=200):
        screen.print(part)
    lines = [line.rstrip() for line in screen.export_text().splitlines()]
    table = [line for line in lines if line.startswith(("OpenMicrowavePnP", " OpenMicrowavePnP", " Task"))]
    assert len(table) == 3
    assert max(len(line) for line in table) <= 100


def test_narrow_terminals_break_no_number_and_no_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    fill(tmp_path)
    long = "CC (max_money=1.0, model=custom:tiny)"
    Store(tmp_path).append([record(job=f"long{seed}", agent=long, method="CC", seed=seed) for seed in range(3)])
    board = read_board(tmp_path)

    def said(columns: int) -> str:
        monkeypatch.setenv("COLUMNS", str(columns))
        show(*board_tables(board, everything=True, across=across()))
        return capsys.readouterr().out

    numbers = {word for word in said(300).split() if word[0].isdigit()}
    assert len(numbers) > 20
    for columns in (60, 80, 100):
        narrow = said(columns)
        assert max(map(len, narrow.splitlines())) <= columns
        assert long in narrow and numbers <= set(narrow.split())


def test_the_first_tables_and_all_of_them(tmp_path: Path) -> None:
    fill(tmp_path)
    few, everything = report(tmp_path), report(tmp_path, "--all")
    for text in (few, everything):
        assert "Results: symbolic, paper starts" in text
        assert "Ranking: " in text
        assert "all tasks" in text
    assert "Paired comparisons" not in few
    assert "Paired comparisons" in everything
    assert "Rounds all" in everything
    assert all(len(line.rstrip()) <= ACROSS + 2 for line in everything.splitlines() if "OpenMicrowave" in line)
    assert "\x1b" not in everything


def test_hostile_names_stay_text(tmp_path: Path) -> None:
    fill(tmp_path)
    markdown = report(tmp_path, "--markdown", "--all")
    assert "\x1b" not in markdown
    assert "<script>" not in markdown
    assert r"=1+1 [31m\|&lt;script>" in markdown


def test_csv_holds_the_numbers(tmp_path: Path) -> None:
    fill(tmp_path)
    report(tmp_path, "--csv", str(tmp_path / "one.csv"))
    with (tmp_path / "one.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 12
    remac = next(row for row in rows if row["agent"] == "REMAC" and row["task"] == "HeatOnStove")
    assert (remac["setting"], remac["n"], remac["tsr"]) == ("symbolic, paper starts", "8.0", "1.0")
    assert 0.6 < float(remac["tsr_low"]) < 0.7
    assert {row["agent"] for row in rows if row["agent"].startswith(("=", "'"))} == {"'=1+1 [31m|<script>"}
    report(tmp_path, "--csv", str(tmp_path / "sheets"))
    names = {path.stem for path in (tmp_path / "sheets").iterdir()}
    assert names == {sheet.key for sheet in read_board(tmp_path).sheets}


def generated(folder: Path) -> None:
    """Jobs of two iterations on generated tasks: what fails first succeeds then."""
    Store(folder).append(
        [
            record(
                job=f"{agent}{grade}{seed}", agent=agent, method=agent, task="Generated", seed=seed, iteration=at,
                scored=at == 1, success=bool(at) and agent == "RE", rounds=12, known_rounds=8, problem=f"p{seed}",
                template=("clear the trolley", "dishes done")[seed % 2],
                options={"kitchen": {"grade": grade, "quirks": 2}, "agent": {}},
            )
            for agent in ("RE", "CC") for grade in (2, 3) for seed in range(4) for at in (0, 1)
        ]
    )  # fmt: skip


def test_generated_tasks_have_tables_by_grade_by_template_and_a_learning_curve(tmp_path: Path) -> None:
    generated(tmp_path)
    sheets = {sheet.key: sheet for sheet in read_board(tmp_path).sheets}
    told = {row["agent"].text: row for row in sheets["grades"].rows}
    assert told["RE"]["grades-2"].text == "100% (4)" and told["CC"]["grades-3"].text == "0% (4)"
    curve = {row["agent"].text: row for row in sheets["learning"].rows}
    assert curve["RE"]["gain"].text == "+100 (+100 to +100)" and curve["CC"]["gain"].text == "+0 (+0 to +0)"
    assert curve["RE"]["regret-1"].text == "0.50" and "regret-0" not in curve["RE"]
    assert len(sheets["templates"].rows) == 2 * 2 * 2
    text = report(tmp_path, "--no-pages")
    assert "Success by grade" in text and "Learning curve" in text


def test_a_report_may_be_of_some_grades_and_templates(tmp_path: Path) -> None:
    generated(tmp_path)
    (sheet, *_) = read_board(tmp_path, grades=["3"], templates=["trolley"]).sheets
    assert [column.key for column in sheet.columns if column.key.startswith("grades")] == ["grades-3"]
    assert {row["grades-3"].text for row in sheet.rows} == {"100% (2)", "0% (2)"}
    result = CliRunner().invoke(app, ["bench", "report", str(tmp_path), "--template", "moon"])
    assert result.exit_code != 0 and "no record of these grades" in result.output
    assert "Grade 2" not in report(tmp_path, "--grade", "3", "--no-pages")


def test_pages_filter_by_grade_and_template(tmp_path: Path) -> None:
    generated(tmp_path)
    report(tmp_path)
    page = (tmp_path / "leaderboard.html").read_text("utf-8")
    assert 'data-filter="grade"' in page and 'data-filter="template"' in page and "clear the trolley" in page
