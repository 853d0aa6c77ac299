"""Names that installed packages add through entry points."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import remac_agents
import remac_env
from remac_agents.wiring.catalogue import is_plugin
from remac_env import plugins
from remac_env.errors import OptionError, UnknownNameError

PACKAGE = """
import remac_env
from remac_env.tasks.goals import All, Inside, Released
from remac_env.tasks.spec import Role, TaskSpec

remac_env.register_task(TaskSpec(
    name="PotatoToSink", wordings=("place the {food} into the sink",) * 3,
    goal=All(Inside("{food}", "sink"), Released("{food}")), roles=(Role("food", ("potato",)),),
    fixtures=("counter", "sink"),
))


class Waits:
    def plan(self, request):
        return ["navigate aside"]
"""

ENTRIES = """
[remac.tasks]
potatoes = {module}
[remac.planners]
waits = {module}:Waits
literal = {module}:Waits
"""


def forget() -> None:
    plugins.installed.cache_clear()
    plugins.load_tasks.cache_clear()


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> Iterator[str]:
    """A distribution with a task and a planner on the path; its module's name."""
    module = getattr(request, "param", "potato_package")
    (tmp_path / "potato_package.py").write_text(PACKAGE)
    about = tmp_path / "potatoes-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: potatoes\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text(ENTRIES.format(module=module))
    monkeypatch.syspath_prepend(str(tmp_path))
    importlib.invalidate_caches()
    forget()
    yield module
    forget()
    sys.modules.pop("potato_package", None)


def test_tasks_and_roles_of_installed_packages_have_names(installed: str) -> None:
    assert installed not in sys.modules
    assert "PotatoToSink" not in sys.modules["remac_env.tasks"].known(), "nothing is loaded before it is asked for"
    env = remac_env.parallel_env("PotatoToSink", backend="symbolic")
    assert "PotatoToSink" in remac_env.tasks()
    assert remac_agents.roles()["planner"][-1] == "waits"
    agent = remac_agents.make("BASE", planner="waits")
    observations, infos = env.reset(seed=0)
    agent.reset(observations, infos)
    assert agent.act(observations, infos)["robot_0"] == env.vocabulary.encode("navigate aside")


def test_they_are_code_from_outside_and_ours_keep_their_names(installed: str) -> None:
    assert is_plugin("planner", "waits") and is_plugin("planner", "waits,x=1")
    assert not is_plugin("planner", "literal"), "no package takes a name of ours"
    assert not is_plugin("checker", "waits")
    with pytest.raises(UnknownNameError, match="memorised, human, waits, package.module:Name|human.*waits"):
        remac_agents.make("BASE", planner="nobody")


@pytest.mark.parametrize("installed", ["no_such_package"], indirect=True)
def test_a_broken_package_is_named_when_its_names_are_asked_for(installed: str) -> None:
    assert remac_env.parallel_env("OpenCabinetPnP", backend="symbolic"), "what is ours works without it"
    with pytest.raises(OptionError, match="'potatoes' of potatoes cannot be imported from 'no_such_package'"):
        remac_env.tasks()
    with pytest.raises(UnknownNameError, match="cannot be imported"):
        remac_agents.make("BASE", planner="waits")
