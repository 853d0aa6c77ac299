"""Inspect AI plays kitchens by a tool, with its own mock model; what it did becomes records of ours."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest
from remac_bench.cli import app
from remac_bench.store import Store
from typer.testing import CliRunner

inspect_ai = pytest.importorskip("inspect_ai", reason="make inspect installs it")
EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "inspect" / "kitchen.py"
TASK = "OpenCabinetPnP"
GOOD = ["navigate to cabinet", "open cabinet door", "navigate to vegetable", "pick up vegetable", "navigate to cabinet",
        "place to cabinet"]  # fmt: skip
BAD = ["juggle", "open cabinet door", "done", "wait"]

pytestmark = pytest.mark.long


@pytest.fixture
def example(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> ModuleType:
    monkeypatch.chdir(tmp_path)
    spec = importlib.util.spec_from_file_location("inspect_kitchen", EXAMPLE)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, spec.name, module)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(("commands", "success"), [(GOOD, True), (BAD, False)])
def test_a_model_plays_by_the_tool_and_its_plans_become_records(
    example: ModuleType, tmp_path: Path, commands: list[str], success: bool
) -> None:
    from inspect_ai.model import ModelOutput, ModelUsage, get_model

    said = [ModelOutput.for_tool_call("mockllm/model", "act", {"command": command}) for command in commands]
    said.append(ModelOutput.from_content("mockllm/model", "done"))
    for output in said:
        output.usage = ModelUsage()  # or else Inspect counts tokens, for which it fetches a table
    model = get_model("mockllm/model", custom_outputs=said)
    (log,) = inspect_ai.eval(example.remac(TASK, seeds=1), model=model, display="none", log_dir=str(tmp_path / "logs"))
    assert log.status == "success", log.error
    assert log.results.scores[0].metrics["accuracy"].value == float(success)
    told = [message.text for message in log.samples[0].messages if message.role == "tool"]
    assert told[-1].endswith("success") if success else told[0].startswith("'juggle' is no command here")
    line = f"bench run --planner answers:{example.PLANS} --methods BASE --robots 1 --tasks {TASK} --seeds 0 --jobs 0"
    done = CliRunner().invoke(app, [*line.split(), "--backend", "symbolic", "--out", "runs/inspect"])
    assert done.exit_code == 0, done.output
    (record,) = Store("runs/inspect").read()
    assert record.success is success
    assert record.outcomes[0]["robot_0"].subtask == commands[0 if success else 1]
