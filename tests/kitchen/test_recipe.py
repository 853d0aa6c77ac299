"""The recipe for a kind of fixture in docs/extending.md, to the letter: its toaster is built, read and worked."""

from __future__ import annotations

import re
import runpy
import textwrap
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import module_trials
import mujoco
import pytest

from remac_env.kitchen.builder import build_model
from remac_env.kitchen.fixtures import KINDS

PAGE = (Path(__file__).parents[2] / "docs" / "extending.md").read_text(encoding="utf-8")
RECIPE = PAGE.partition("## Add a kind of fixture\n")[2].partition("\n## ")[0]


def block(language: str) -> str:
    """The recipe's block of code or data."""
    found = re.search(rf"^( *)```{language}\n(.*?)^\1```$", RECIPE, flags=re.DOTALL | re.MULTILINE)
    assert found is not None
    return textwrap.dedent(found[2])


@pytest.fixture
def toaster(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """The recipe's class among the kinds, and its trials among the trials."""
    file, trials = tmp_path / "toaster.py", tomllib.loads(block("toml"))
    file.write_text(block("python"), encoding="utf-8")
    monkeypatch.setitem(KINDS, "toaster", runpy.run_path(str(file), run_name="toaster")["Toaster"])
    monkeypatch.setattr(module_trials, "tables", lambda: trials)
    yield module_trials.any_layout("toaster", module_trials.ONE_VARIANT).fixtures["toaster"]
    module_trials.module_layout.cache_clear()


def test_its_model_has_the_parts_that_it_names_and_reads_them(toaster: Any) -> None:
    layout = module_trials.any_layout("toaster", module_trials.ONE_VARIANT)
    model = build_model(layout, robots=(), objects={}, visual=True)
    data = mujoco.MjData(model)
    assert toaster.read(model, data).on == frozenset()
    for joint, at in toaster.joints(0.0, frozenset({"toaster"})).items():
        data.joint(joint).qpos[0] = at
    assert toaster.read(model, data).on == {"toaster"}
    assert build_model(layout, robots=(), objects={}).ngeom < model.ngeom


@pytest.mark.long
def test_robots_turn_it_on_and_off(toaster: Any) -> None:
    for trial in module_trials.trials("toaster", module_trials.ONE_VARIANT, 0)[:2]:
        found = module_trials.run(trial)
        assert [part.skill for part in found] == ["turn on", "turn off", "turn on"], found
        assert not any(part.problem for part in found), found
