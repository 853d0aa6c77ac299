"""Money whose price is unknown is never shown as 0; and what the doctor says of models."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import pytest
from bench_helpers import jobs, record
from remac_bench import judging
from remac_bench.cli import app
from remac_bench.commands.progress import Tally
from remac_bench.metrics import summarise
from remac_bench.pages.leaderboard import leaderboard
from remac_bench.pages.plots import scatter
from remac_bench.playing.agents import Access, asked_models, by_route
from remac_bench.playing.engines import Engine
from remac_bench.prices import digits, dollars, list_price
from remac_bench.proof.again import read_job
from remac_bench.records import Record
from remac_bench.report import csv_text
from typer.testing import CliRunner

from remac_agents.llm import load

UNPRICED = {"calls": 2, "prompt_tokens": 10, "unpriced": 2}
PARTLY = {"calls": 2, "prompt_tokens": 10, "money": 0.5, "unpriced": 1}
PAID = {"calls": 2, "prompt_tokens": 10, "money": 0.5}
FREE = {"calls": 2, "prompt_tokens": 10}
MINE = '[providers.mine]\ntitle = "Mine"\nbase_url = "https://x.example/v1"\nkey = "MINE_KEY"\nany_model = true\n'


def records(usage: dict[str, float], agent: str = "CC", n: int = 2) -> list[Record]:
    return [record(job=f"{agent}{i}", agent=agent, method="CC", seed=i, usage=usage) for i in range(n)]


@pytest.mark.parametrize(
    ("usage", "shown", "money"),
    [(UNPRICED, "unknown", None), (PARTLY, "0.50+", 0.5), (PAID, "0.50", 0.5), (FREE, "0", 0.0)],
)
def test_tables_and_csv(usage: dict[str, float], shown: str, money: float | None) -> None:
    (row,) = summarise(records(usage))
    assert row.money == money
    board = judging.board(records(usage))
    (sheet,) = (each for each in board.sheets if each.key == "results")
    cell = sheet.rows[0]["money"]
    assert (cell.text, cell.value) == (shown, None if "unpriced" in usage else money)
    (line,) = csv.DictReader(io.StringIO(csv_text([sheet])))
    told = line[next(name for name in line if name.startswith("money") or name == "USD")]
    assert told == (shown if "unpriced" in usage else str(money))


def test_words() -> None:
    assert [dollars(None), dollars(0.0, 3), dollars(0.0), dollars(2.0, 1)] == ["unknown", "unknown", "$0", "$2.00+"]
    assert [digits(x) for x in (0.25, 0.0123, 12.3456, 0.00001)] == ["0.25", "0.012", "12.35", "0.00001"]
    openrouter = load().providers["openrouter"]
    assert list_price(openrouter.default) == "price unknown"
    assert "free" in list_price(load().providers["ollama"].default)
    assert list_price(load().providers["openai"].models["o3"]).startswith("$2 in, $8 out a million tokens (20")


def test_pages_and_plots() -> None:
    mixed = [*records(UNPRICED, "CC (model=a:b)"), *records(PAID, "CC (model=c:d)")]
    board = judging.board(mixed)
    drawn = scatter(next(each for each in board.sheets if each.key == "results"))
    assert drawn is not None and "dollars" in drawn.axis and [dot.name for dot in drawn.dots] == ["CC (model=c:d)"]
    assert drawn.note == "The cost of CC (model=a:b) is not known in full: left out."
    drawn = scatter(next(e for e in judging.board(records(UNPRICED)).sheets if e.key == "results"))
    assert drawn is not None and "seconds" in drawn.axis
    assert drawn.note == "The cost of CC is not known in full, so time stands in its place."
    html = leaderboard(judging.board(records(UNPRICED)), records(UNPRICED))
    assert ">unknown<" in html and "$0<" not in html


def test_the_tally_does_not_hide_what_is_unknown() -> None:
    tally = Tally()
    tally.add([record(usage=UNPRICED)])
    assert tally.told(0.0) == "0 failed, cost unknown"
    tally.add([record(usage=PAID)])
    assert tally.told(0.0) == "0 failed, $0.50+"


def test_the_doctor_lists_the_keys_that_there_are_and_the_routes(tmp_path: Path) -> None:
    env = {"OPENROUTER_API_KEY": "sk-do-not-tell", "OPENAI_API_KEY": "", "HF_TOKEN": ""}
    file = tmp_path / "p.toml"
    file.write_text(MINE + "[paper]\nOurs = ['mine:a', 'custom:b']\n", "utf-8")
    result = CliRunner().invoke(app, ["doctor", "--json", "--providers", str(file)], env=env)
    findings = json.loads(result.stdout)
    keys = {each["name"] for each in findings if each["group"] == "keys"}
    assert keys == {provider.key for provider in load(file).providers.values()} and "MINE_KEY" in keys
    routes = {each["value"]: each for each in findings if each["group"] == "models"}
    assert set(routes) == {full for routes in load(file).paper.values() for full in routes}
    assert routes["openai:o3"]["ok"] is None and "OPENAI_API_KEY is not set" in routes["openai:o3"]["purpose"]
    assert routes["openrouter:openai/o3"]["ok"] is True and "price unknown" in routes["mine:a"]["purpose"]
    assert "do-not-tell" not in result.output


def test_a_providers_file_goes_along_and_into_the_record(tmp_path: Path) -> None:
    file = tmp_path / "p.toml"
    file.write_text(MINE, "utf-8")
    access = Access(providers=str(file))
    assert asked_models({"planner": "mine:m"}, providers=str(file)) == ["mine:m"]
    assert asked_models({"planner": "x"}) == asked_models({"planner": "mine:m"}) == []
    assert access.told["providers"].startswith("p.toml ") and len(access.told["providers"]) == 7 + 12
    assert "providers" not in Access(base_url="http://127.0.0.1:1/v1").told
    made = record(options=jobs()[0].facts | {"access": access.told})
    assert read_job(made).access == Access()
    assert Engine().picked(jobs()) == "processes"


def test_models_of_the_paper_are_named_by_their_route() -> None:
    assert by_route("o3,temperature=none", via="openrouter") == "openrouter:openai/o3,temperature=none"
    assert by_route("literal", via="openrouter") == "literal" and by_route("o3", via=None) == "o3"
