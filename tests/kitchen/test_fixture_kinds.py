"""No kind of fixture is named in general code: what is asked of a kind stands on its class, in its own file."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from remac_env.kitchen.fixtures import KINDS

ENV = Path(__file__).resolve().parents[2] / "remac_env"
FIXTURES = "remac_env.kitchen.fixtures"

ALLOWED = {
    # The default of a public keyword: where an object of a task lies if the task does not say.
    "tasks/spec.py": {"counter"},
    # A sink hangs in a worktop, and is drawn like the cabinets beside it.
    "kitchen/fixtures/sink.py": {f"{FIXTURES}.counter"},
    # So does the base cabinet of a drawer.
    "kitchen/fixtures/drawer.py": {f"{FIXTURES}.counter"},
    # What a hand can do in an oven is what it can do in a microwave.
    "kitchen/fixtures/oven.py": {"microwave"},
    # A faucet stands behind a sink, and its water falls into the basin.
    "kitchen/fixtures/faucet.py": {f"{FIXTURES}.sink"},
    # Doors with a window in them.
    "kitchen/fixtures/stove.py": {"window"},
    "kitchen/fixtures/microwave_visual.py": {"window"},
}
"""Files that name a kind which is not theirs, and which."""

PARTS = re.compile(r"/(left_|right_)?(door|handle|knob|lever|button|drawer)\b")
"""Names of joints, bodies and sites that fixtures give their parts."""


def files() -> list[str]:
    """All of the package but where the kinds are put together, and the tasks, which are about particular fixtures."""
    paths = {path.relative_to(ENV).as_posix(): path for path in sorted(ENV.rglob("*.py"))}
    paths = {name: path for name, path in paths.items() if "\nSPEC = TaskSpec(" not in path.read_text(encoding="utf-8")}
    return [name for name in paths if name != "kitchen/fixtures/__init__.py"]


def not_its_own(file: str, source: str) -> set[str]:
    """The kinds that a file names and that are not its own."""
    own = {kind: cls for kind, cls in KINDS.items() if cls.__module__ == f"remac_env.{file[:-3].replace('/', '.')}"}
    parts = file.startswith("kitchen/fixtures/")
    return {
        name
        for name in named(source)
        if name not in own
        and name not in {cls.__name__ for cls in own.values()}
        and not (parts and PARTS.fullmatch(name))
    }


def named(source: str) -> Iterator[str]:
    """The kinds that a module names: as strings, as classes, or by their files; and parts of fixtures by name."""
    tree = ast.parse(source)
    classes = {cls.__name__ for cls in KINDS.values()} - {"Counter", "Window"}  # those are of collections, and a viewer
    modules = {cls.__module__ for cls in KINDS.values()}
    told = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}  # docstrings
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in told:
            if node.value in KINDS:
                yield node.value
            yield from (match.group() for match in PARTS.finditer(node.value))
        elif isinstance(node, ast.Name | ast.Attribute):
            name = node.id if isinstance(node, ast.Name) else node.attr
            if name in classes:
                yield name
        elif isinstance(node, ast.ImportFrom):
            yield from (alias.name for alias in node.names if alias.name in classes)
            if node.module in modules:
                yield str(node.module)
            yield from (f"{node.module}.{a.name}" for a in node.names if f"{node.module}.{a.name}" in modules)
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in modules)


@pytest.mark.parametrize("file", files())
def test_no_kind_is_named_outside_its_file(file: str) -> None:
    found = not_its_own(file, (ENV / file).read_text(encoding="utf-8"))
    assert found == ALLOWED.get(file, set()), "ask the fixture instead; what is no longer named is no longer allowed"


@pytest.mark.parametrize(
    "planted",
    [
        'BASIN = "sink"',
        'SHUT_TO_RUN = ("microwave",)',
        'def f(x):\n    return x.kind == "stove"',
        'def f(name):\n    return f"{name}/lever"',
        'JOINT = "cabinet/left_door"',
        "from remac_env.kitchen.fixtures.faucet import LIFTED",
        "from remac_env.kitchen.fixtures import faucet",
        "import remac_env.kitchen.fixtures.counter",
        "from remac_env.kitchen.fixtures import Stove",
        "def f(x):\n    return isinstance(x, fixtures.Microwave)",
    ],
)
def test_a_planted_name_is_found(planted: str) -> None:
    assert not_its_own("kitchen/scene.py", planted)


def test_words_about_kinds_are_no_names() -> None:
    assert not list(named('"""A microwave, with its stove/knob_0."""\nX = "open the cabinet door"'))


def test_a_kind_may_name_itself_alone() -> None:
    source = 'KIND, JOINT = "sink", f"{name}/handle"'
    assert not not_its_own("kitchen/fixtures/sink.py", source)
    assert not_its_own("kitchen/fixtures/hood.py", source) == {"sink"}
    assert not_its_own("kitchen/scene.py", source) == {"sink", "/handle"}
