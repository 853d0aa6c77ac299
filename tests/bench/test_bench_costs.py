"""What methods ask of language models, measured without one, and the documents that show it."""

from __future__ import annotations

import re
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "benchmarks"))

import model_costs  # noqa: E402  (a script of the benchmarks' folder)
from remac_bench.preflight import measuring  # noqa: E402
from remac_bench.preflight.estimates import FILE, Costs, Need, measured  # noqa: E402
from remac_bench.preflight.measuring import Meter, measure  # noqa: E402

from remac_agents.llm import resolve  # noqa: E402


def test_every_role_that_speaks_is_counted_with_real_prompts() -> None:
    needs = measure("REMAC", "OpenMicrowavePnP", seeds=[0])
    assert set(needs) == {"planner", "conditions", "checker", "adjuster", "reflector", "handover"}
    assert 0 < needs["planner"].calls <= 1 and needs["conditions"].calls > 5 > needs["reflector"].calls
    assert needs["checker"].prompt > 1500 * needs["checker"].calls  # a picture, at least
    assert needs["planner"].prompt / needs["planner"].calls > 300
    assert measure("REMAC", "OpenMicrowavePnP", seeds=[0]) == needs
    assert set(measure("BASE", "OpenMicrowavePnP", seeds=[0])) == {"planner"}
    assert "summariser" in measure("REFLECT", "OpenMicrowavePnP", seeds=[0])


def test_an_answer_that_is_not_read_is_no_measurement(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(measuring.ShadowConditions, "asks", lambda self, verb, *given, says: _babble(self, verb, given))
    with pytest.raises(RuntimeError, match="CC, HeatOnStove, seed 0: an answer was not read: conditions"):
        measure("CC", "HeatOnStove", seeds=[0])


def _babble(shadow: Any, verb: str, given: Any) -> None:
    shadow.meter.says("well, well")
    getattr(shadow.model, verb)(*given)


def test_the_meter_counts_characters_messages_and_pictures() -> None:
    meter = Meter()
    meter.says("a", "bcd")
    asked = {"messages": [["system", "x" * 30], ["user", "y" * 30]], "images": ["p"], "label": "l/planner/1"}
    assert [meter.play(asked).text for _ in range(3)] == ["a", "bcd", "bcd"]
    assert meter.needs["planner"] == Need(3, 3 * (20 + 16 + 1500), 1 + 2 + 2)


def test_the_table_is_fresh_enough() -> None:
    """Where prompts have grown or shrunk by a quarter: python benchmarks/model_costs.py --seeds 0:5 --write."""
    for method in ("BASE", "CC"):
        now = sum(measure(method, "HeatOnStove", seeds=[0]).values(), Need())
        then = measured().whole(method, "HeatOnStove", images=True)
        assert then is not None and then.prompt == pytest.approx(now.prompt, rel=0.25), method


def test_the_file_holds_what_was_measured() -> None:
    needs = {"CC": {"HeatOnStove": {"planner": Need(1.5, 100, 10)}}}
    read = tomllib.loads(model_costs.as_toml(needs, "0:5"))
    assert read["needs"] == {"CC": {"HeatOnStove": {"planner": [1.5, 100, 10]}}}
    assert read["command"] == "python benchmarks/model_costs.py --seeds 0:5 --write"
    import remac_agents
    import remac_env

    assert FILE.is_file() and {"BASE", "CC", "RE", "REMAC"} <= set(measured().needs) <= set(remac_agents.methods())
    assert all(set(tasks) <= set(remac_env.tasks()) for tasks in measured().needs.values())


def test_a_model_without_eyes_pays_for_no_checker() -> None:
    costs = Costs({"CC": {"A": {"planner": Need(1, 1000, 10), "checker": Need(9, 9000, 90)}}})
    assert costs.whole("CC", "A", images=False) == Need(1, 1000, 10)
    assert costs.whole("CC", "B", images=True) == Need(10, 10000, 100)  # the mean of what is known
    r1 = resolve("openrouter:deepseek/deepseek-r1").model
    assert Need(1, 1_000_000, 0).money(r1) == pytest.approx(0.70 + r1.reasoning_tokens * 2.5 / 1e6)


def test_the_documents_show_what_the_command_prints(tmp_path: Path) -> None:
    from typer import Typer

    app = Typer()
    app.command()(model_costs.main)
    text = (ROOT / "docs" / "first_model.md").read_text("utf-8")
    begin, end = model_costs.MARKS
    shown = text.partition(begin)[2].partition(end)[0].strip()
    (command,) = re.findall(r"^python benchmarks/model_costs.py (--show --into .*)$", text, re.M)
    copy = tmp_path / "copy.md"
    copy.write_text(text.replace(shown, ""), "utf-8")
    arguments = command.replace("docs/first_model.md", str(copy)).split()
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.output
    assert shown and copy.read_text("utf-8") == text, f"run: python benchmarks/model_costs.py {command}"
