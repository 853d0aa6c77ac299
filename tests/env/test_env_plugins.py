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
    broken = "'potatoes' of potatoes cannot be imported from 'no_such_package': ModuleNotFoundError"
    with pytest.warns(RuntimeWarning, match=broken):
        assert "OpenCabinetPnP" in remac_env.tasks()
    with pytest.raises(UnknownNameError, match=f"'PotatoToSink'; valid: OpenCabinetPnP.*; tasks {broken}"):
        remac_env.parallel_env("PotatoToSink", backend="symbolic")
    with pytest.raises(UnknownNameError, match="cannot be imported"):
        remac_agents.make("BASE", planner="waits")


NAMESAKE = PACKAGE.replace("PotatoToSink", "OpenCabinetPnP")
UNPRINTABLE = "class Sour(Exception):\n    def __str__(self):\n        raise ValueError\nraise Sour"


def add(folder: Path, name: str, source: str, attribute: str = "") -> None:
    """Another distribution, whose module is also a planner's of the same name; `attribute`: what its task is."""
    (folder / f"{name}_package.py").write_text(source)
    about = folder / f"{name}-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    task, planner = f"{name}_package{attribute}", f"{name}_package:Waits"
    (about / "entry_points.txt").write_text(f"[remac.tasks]\n{name} = {task}\n[remac.planners]\n{name} = {planner}\n")


@pytest.mark.parametrize(
    ("source", "attribute", "told"),
    [
        ("1 / 0", "", "ZeroDivisionError: division by zero"),
        ("import sys; sys.exit('enough')", "", "SystemExit: enough"),
        ("def (", "", "SyntaxError"),
        (UNPRINTABLE, "", "Sour: it does not say why"),
        (NAMESAKE, "", "OptionError: task name 'OpenCabinetPnP' is taken by another task"),
        ("Waits = 7", ":Waits", "is no module .its type: int."),
        ("Waits = 7", ":Nothing", "AttributeError"),
    ],
    ids=["raises", "exits", "syntax", "unprintable", "namesake", "kind", "missing"],
)
def test_one_broken_package_spoils_no_other(
    installed: str, tmp_path: Path, source: str, attribute: str, told: str
) -> None:
    add(tmp_path, "broken", source, attribute)  # before "potatoes" in the order of names
    importlib.invalidate_caches()
    forget()
    try:
        ours = remac_env.parallel_env("OpenCabinetPnP", backend="symbolic")
        with pytest.warns(RuntimeWarning, match=f"'broken' of broken.*{told}"):
            assert "PotatoToSink" in remac_env.tasks()
        assert remac_env.parallel_env("OpenCabinetPnP", backend="symbolic").action_spaces == ours.action_spaces
        with pytest.raises(UnknownNameError, match=told):
            remac_env.parallel_env("NoSuchTask", backend="symbolic")
        assert remac_agents.make("BASE", planner="waits") and remac_agents.make("BASE", planner="literal")
        assert {"waits", "broken"} < set(remac_agents.roles()["planner"])
        if source != NAMESAKE:
            with pytest.raises((UnknownNameError, OptionError), match="broken|planner 7 lacks plan"):
                remac_agents.make("BASE", planner="broken")
    finally:
        sys.modules.pop("broken_package", None)


@pytest.mark.parametrize("installed", ["potato_package:Nothing"], indirect=True)
def test_an_address_of_no_form_is_named(installed: str) -> None:
    with pytest.raises(UnknownNameError, match="its entry point leads to .*; valid: package.module:Name|cannot be"):
        remac_agents.make("BASE", planner="waits")
