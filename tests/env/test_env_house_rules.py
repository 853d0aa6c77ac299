"""The habits of the house, read off the sources."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from functools import lru_cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = (ROOT / "remac_env", ROOT / "remac_agents", ROOT / "benchmarks" / "remac_bench")
FILES = tuple(path for folder in FOLDERS for path in sorted(folder.rglob("*.py")))

MOST_LINES_OF_A_FILE = 300
MOST_LINES_OF_A_FUNCTION = 60

NUMPY_RANDOM = {"default_rng", "SeedSequence", "Generator", "PCG64", "BitGenerator"}
"""What may be used of numpy.random: everything else shares one global state."""

GLOBAL_RANDOM_ON_PURPOSE = ROOT / "remac_env" / "testing" / "determinism.py"
"""It sets the global generators to see that nobody listens to them."""

ROBOSUITE_ROOM = ROOT / "remac_env" / "integrations" / "robosuite"
"""The one room that may import robosuite, which is not among the dependencies; nothing loads the room by itself."""

DANGEROUS = {"exec", "eval", "compile", "__import__", "breakpoint"}
Finding = tuple[Path, int, str]


@lru_cache(maxsize=1)
def trees() -> dict[Path, ast.Module]:
    """What stands in each file, read once."""
    return {path: ast.parse(path.read_text("utf-8")) for path in FILES}


@lru_cache(maxsize=1)
def nodes() -> list[tuple[Path, ast.AST]]:
    """All that rules look at: neither names nor marks, which are half of a tree."""
    dull = ast.expr_context | ast.operator | ast.cmpop | ast.Name | ast.Constant | ast.keyword | ast.arg
    return [(path, node) for path, tree in trees().items() for node in inside(tree) if not isinstance(node, dull)]


def inside(tree: ast.AST) -> Iterator[ast.AST]:
    """All nodes of a tree, in no order; `ast.walk` takes three times as long."""
    left: list[ast.AST] = [tree]
    while left:
        node = left.pop()
        yield node
        for value in vars(node).values():
            if isinstance(value, ast.AST):
                left.append(value)
            elif isinstance(value, list):
                left += [each for each in value if isinstance(each, ast.AST)]


def found(wrong: Callable[[Path, ast.AST], str | None]) -> list[str]:
    texts = []
    for path, node in nodes():
        what = wrong(path, node)
        if what:
            texts.append(f"{path.relative_to(ROOT)}:{getattr(node, 'lineno', 0)}: {what}")
    return texts


def called(node: ast.AST) -> str | None:
    return node.func.id if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) else None


def dotted(node: ast.AST) -> str:
    if isinstance(node, ast.Attribute):
        return f"{dotted(node.value)}.{node.attr}"
    return node.id if isinstance(node, ast.Name) else ""


def test_there_is_something_to_read() -> None:
    assert len(FILES) > 60


def test_no_print() -> None:
    assert not found(lambda _, node: "print" if called(node) == "print" else None)


def test_nothing_is_run_from_text() -> None:
    assert not found(lambda _, node: called(node) if called(node) in DANGEROUS else None)
    unsafe = ("pickle.load", "pickle.loads", "marshal.loads", "yaml.load", "os.system", "os.popen")
    assert not found(lambda _, node: dotted(node) if dotted(node) in unsafe else None)


def test_no_import_of_everything() -> None:
    def wrong(_: Path, node: ast.AST) -> str | None:
        star = isinstance(node, ast.ImportFrom) and any(alias.name == "*" for alias in node.names)
        return "import *" if star else None

    assert not found(wrong)


def test_no_validation_by_assert() -> None:
    """Python -O removes it."""
    assert not found(lambda _, node: "assert" if isinstance(node, ast.Assert) else None)


def test_no_bare_except() -> None:
    bare = found(lambda _, node: "except:" if isinstance(node, ast.ExceptHandler) and node.type is None else None)
    assert not bare


def test_no_robot_is_number_zero() -> None:
    def wrong(_: Path, node: ast.AST) -> str | None:
        if not isinstance(node, ast.Subscript) or not isinstance(node.slice, ast.Constant):
            return None
        inner = node.value
        if isinstance(inner, ast.Call) and called(inner) in ("list", "tuple", "sorted") and inner.args:
            inner = inner.args[0]
        name = dotted(inner).rsplit(".", 1)[-1]
        first = node.slice.value == 0 and name.strip("_").endswith(("robots", "agents", "robot_names"))
        return f"{name}[0]" if first or node.slice.value == "robot_0" else None

    assert not found(wrong)


def test_no_global_random_state() -> None:
    def wrong(path: Path, node: ast.AST) -> str | None:
        if path == GLOBAL_RANDOM_ON_PURPOSE or not isinstance(node, ast.Attribute):
            return None
        name = dotted(node)
        if name.startswith(("np.random.", "numpy.random.")) and name.split(".")[2] not in NUMPY_RANDOM:
            return name
        return name if name.startswith("random.") and name not in ("random.Random",) else None

    assert not found(wrong)


def test_files_are_short() -> None:
    lines = {str(path.relative_to(ROOT)): len(path.read_text("utf-8").splitlines()) for path in FILES}
    assert not {name: count for name, count in lines.items() if count > MOST_LINES_OF_A_FILE}


def test_functions_are_short() -> None:
    def wrong(_: Path, node: ast.AST) -> str | None:
        if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            return None
        count = (node.end_lineno or node.lineno) - node.lineno + 1
        return f"{node.name} has {count} lines" if count > MOST_LINES_OF_A_FUNCTION else None

    assert not found(wrong)


def test_every_module_and_public_thing_of_the_environment_has_a_docstring() -> None:
    def lacks(node: ast.AST) -> bool:
        kinds = ast.Module | ast.ClassDef | ast.FunctionDef
        if not isinstance(node, kinds) or (isinstance(node, ast.Module) and not node.body):
            return False
        return not getattr(node, "name", "").startswith("_") and not ast.get_docstring(node)

    missing = []
    for path, tree in trees().items():
        public = [tree, *(n for n in tree.body if isinstance(n, ast.ClassDef | ast.FunctionDef))]
        missing += [f"{path.relative_to(ROOT)}:{getattr(n, 'lineno', 1)}" for n in public if lacks(n)]
    assert not missing


@pytest.mark.parametrize("word", ["numba", "scipy", "PIL", "trimesh", "robosuite", "torch"])
def test_no_dependency_beyond_the_declared_ones(word: str) -> None:
    def wrong(path: Path, node: ast.AST) -> str | None:
        if word == "robosuite" and path.is_relative_to(ROBOSUITE_ROOM):
            return None
        names = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names = [node.module]
        return word if any(name.split(".")[0] == word for name in names) else None

    assert not found(wrong)
