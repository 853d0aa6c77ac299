"""Which package may import which, and what an import must not do."""

from __future__ import annotations

import ast
import json
import subprocess
import sys
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = {"remac_env": ROOT, "remac_agents": ROOT, "remac_bench": ROOT / "benchmarks"}

RANKS = {
    # What lies higher may import what lies lower or beside it, never the other way round.
    "remac_env": 9,
    "remac_env.testing": 9,
    "remac_env.registry": 8,
    "remac_env.envs": 7,
    "remac_env.integrations": 7,
    "remac_env.validate": 7,
    "remac_env.lowlevel": 6,
    "remac_env.episode": 5,
    "remac_env.event_episode": 5,
    "remac_env.events": 4,
    "remac_env.pictures": 5,
    "remac_env.rendering": 4,
    "remac_env.backends": 4,
    "remac_env.generator": 4,
    "remac_env.kitchen": 3,
    "remac_env.rewards": 3,
    "remac_env.robots": 3,
    "remac_env.tasks": 2,
    "remac_env.oracle": 2,
    "remac_env.pddl": 2,
    "remac_env.observation": 2,
    "remac_env.actions": 2,
    "remac_env.text": 2,
    "remac_env.vocabulary": 2,
    "remac_env.simulator": 1,
    "remac_env.start": 1,
    "remac_env.rules": 1,
    "remac_env.state": 1,
    "remac_env.seeding": 0,
    "remac_env.frozen": 0,
    "remac_env.plugins": 1,
    "remac_env.errors": 0,
    "remac_env.option_rows": 0,
    "remac_env.options": 1,
    "remac_env.skill_sources": 1,
    "remac_env.thinking": 0,
    "remac_env.values": 0,
    "remac_env.quoting": 0,
    "remac_env.words": 0,
    "remac_env.array_files": 0,
    "remac_env.files": 0,
    "remac_env.locks": 0,
    "remac_env.sights": 0,
}
PARTS = {"remac_env": 0, "remac_agents": 1, "remac_bench": 2}

SIMULATOR = ("mujoco", "robosuite", "OpenGL", "glfw", "cv2", "tkinter", "pygame", "torch", "matplotlib", "PIL", "scipy")


def modules() -> Iterator[tuple[str, Path]]:
    for package, folder in PACKAGES.items():
        for path in sorted((folder / package).rglob("*.py")):
            parts = path.relative_to(folder).with_suffix("").parts
            yield ".".join(parts[:-1] if parts[-1] == "__init__" else parts), path


@cache
def imports(source: str) -> tuple[str, ...]:
    """Every name that a module imports: at its top, in functions, and for types alone."""
    names: list[str] = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names += (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            names += (f"{node.module}.{alias.name}" for alias in node.names)
    return tuple(names)


def sources() -> dict[str, str]:
    """Module -> its text."""
    return {name: path.read_text("utf-8") for name, path in modules()}


def in_circles(sources: Mapping[str, str]) -> list[str]:
    """The modules that import one another; a name that is no module counts as the module in which it stands."""
    goals: dict[str, set[str]] = {}
    for name, source in sources.items():
        found = (next((n for n in _longest_first(other) if n in sources), None) for other in imports(source))
        goals[name] = {goal for goal in found if goal is not None and goal != name}
    left = dict(goals)
    while free := [name for name, ends in left.items() if not ends & left.keys()]:
        for name in free:
            del left[name]
    # What is left imports a circle, or is one: only those stay that are imported from what is left, too.
    while idle := [name for name in left if not any(name in ends for other, ends in left.items() if other != name)]:
        for name in idle:
            del left[name]
    return sorted(left)


def _longest_first(name: str) -> Iterator[str]:
    parts = name.split(".")
    return (".".join(parts[:size]) for size in range(len(parts), 0, -1))


def rank(name: str) -> int | None:
    parts = name.split(".")
    for size in range(min(2, len(parts)), 0, -1):
        if ".".join(parts[:size]) in RANKS:
            return RANKS[".".join(parts[:size])]
    return None


def test_packages_point_down_only() -> None:
    wrong = [
        f"{name} imports {other}"
        for name, source in sources().items()
        for other in imports(source)
        if other.split(".")[0] in PARTS and PARTS[other.split(".")[0]] > PARTS[name.split(".")[0]]
    ]
    assert not wrong


def test_inside_the_environment_arrows_point_down_only() -> None:
    unknown = [name for name, _ in modules() if name.startswith("remac_env.") and rank(name) == RANKS["remac_env"]
               and not name.startswith(("remac_env.testing", "remac_env.__main__"))]  # fmt: skip
    assert not unknown, "these modules have no rank yet: say where they belong"
    wrong = []
    for name, source in sources().items():
        if not name.startswith("remac_env.") or name.startswith("remac_env.testing"):
            continue
        for other in imports(source):
            if not other.startswith("remac_env"):
                continue
            mine, theirs = rank(name), rank(other)
            if mine is not None and theirs is not None and theirs > mine:
                wrong.append(f"{name} imports {other}")
    assert not wrong


def test_no_module_imports_itself_by_way_of_others() -> None:
    assert in_circles(sources()) == []


@pytest.mark.parametrize(
    "planted",
    [
        {"a": "from b import x", "b": "import a"},
        {"a": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from b import X", "b": "from a import Y"},
        {"a": "def late():\n    import b.c", "b.c": "from d import X", "d": "from a import Y"},
    ],
    ids=["plain", "types only", "in a function, of three"],
)
def test_a_planted_circle_is_found(planted: dict[str, str]) -> None:
    around = {"above": "import a", "below": "import json"}
    assert in_circles({**planted, **around, "a": planted["a"] + "\nimport below"}) == sorted(planted)


def test_neither_backend_nor_robot_knows_what_draws_it() -> None:
    forbidden = [
        ("remac_env.backends", "remac_env.rendering"),
        ("remac_env.robots", "remac_env.rendering"),
        ("remac_env.kitchen", "remac_env.rendering"),
        ("remac_env.rendering", "remac_env.backends"),
        ("remac_env.backends.symbolic", "mujoco"),
    ]
    wrong = [
        f"{name} imports {other}"
        for name, source in sources().items()
        for other in imports(source)
        if any(name.startswith(a) and other.startswith(b) for a, b in forbidden)
    ]
    assert not wrong


def test_nothing_imports_the_bridges_to_other_projects() -> None:
    wrong = [
        f"{name} imports {other}"
        for name, source in sources().items()
        for other in imports(source)
        if other.startswith("remac_env.integrations") and not name.startswith("remac_env.integrations")
    ]
    assert not wrong


def test_agents_and_benchmarks_use_no_private_names_of_the_environment() -> None:
    wrong = [
        f"{name} imports {other}"
        for name, source in sources().items()
        for other in imports(source)
        if not name.startswith("remac_env") and other.startswith("remac_env.") and "._" in other and "__" not in other
    ]
    assert not wrong


def loaded_by(code: str, tmp_path: Path, *, first: str = ", gymnasium, pettingzoo") -> dict[str, list[str]]:
    """Modules loaded and environment variables changed by code in a fresh Python, far from the sources."""
    program = (
        # Gymnasium and PettingZoo set variables of pygame's; those are not ours.
        f"import json, os, sys{first}\nbefore = dict(os.environ)\n"
        f"{code}\n"
        "changed = [k for k in {**before, **os.environ} if before.get(k) != os.environ.get(k)]\n"
        "sys.stdout.write(json.dumps({'modules': sorted(sys.modules), 'changed': changed}))"
    )
    done = subprocess.run(
        [sys.executable, "-W", "error::DeprecationWarning:remac_env", "-c", program],
        capture_output=True, text=True, check=False, cwd=tmp_path, timeout=120,
        env={"PYTHONPATH": f"{ROOT}:{ROOT / 'benchmarks'}", "PATH": "/usr/bin:/bin", "MUJOCO_GL": "no such thing"},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert not done.stderr, done.stderr
    return json.loads(done.stdout)


SYMBOLIC_EPISODE = """
import remac_env
env = remac_env.parallel_env("DefrostInBowl", backend="symbolic", starts="mixed")
observations, infos = env.reset(seed=3)
env.step({"robot_0": 3, "robot_1": 0})
from remac_env.oracle import solve
solve(env.start.scene, env.world, env.goal)
env.close()
"""

FACTS = """
from remac_env.kitchen import layout, style, worlds
from remac_env.kitchen.objects import catalogue
layout.load(layout.names()[0]), catalogue.load(), style.names()
"""


def test_no_simulator_no_graphics_no_environment_variables(tmp_path: Path) -> None:
    """Neither for the imports nor for an episode nor for the facts of kitchens: together they load none."""
    result = loaded_by(f"import remac_agents, remac_env.testing\n{SYMBOLIC_EPISODE}\n{FACTS}", tmp_path)
    heavy = [name for name in result["modules"] if name.split(".")[0] in SIMULATOR]
    assert not heavy
    assert not result["changed"]


@pytest.mark.parametrize("order", ["import gymnasium, remac_env", "import remac_env, gymnasium"])
def test_importing_registers_the_gymnasium_ids_in_either_order(order: str, tmp_path: Path) -> None:
    code = (
        f"{order}\n"
        "missing = [t for t in remac_env.tasks('events') if f'RemacKitchen-{t}-v0' not in gymnasium.registry]\n"
        "if missing: raise SystemExit(str(missing))\n"
        "gymnasium.make('RemacKitchen-OpenCabinetPnP-v0', backend='symbolic').close()\n"
        "gymnasium.make('RemacKitchen-FallingDoor-v0', backend='symbolic').close()"
    )
    loaded_by(code, tmp_path, first="")


def test_what_looks_for_gymnasium_and_does_not_load_it_leaves_the_ids_to_the_import(tmp_path: Path) -> None:
    code = (
        "import sys, importlib.util, remac_env\n"
        "spec = importlib.util.find_spec('gymnasium')\n"
        "if spec is None or 'gymnasium' in sys.modules: raise SystemExit('looking for it loaded it')\n"
        "from gymnasium.envs.registration import registry\n"
        "if 'RemacKitchen-OpenCabinetPnP-v0' not in registry: raise SystemExit('no id')\n"
        "if any('remac_env' in type(f).__module__ for f in sys.meta_path): raise SystemExit('still waiting')"
    )
    loaded_by(code, tmp_path, first="")


@pytest.mark.parametrize("found", ["None", "types.SimpleNamespace(__version__='1.4.1')"], ids=["none", "old"])
def test_without_the_robosuite_that_is_needed_its_room_says_what_to_do(found: str, tmp_path: Path) -> None:
    code = (
        f"import sys, types\nsys.modules['robosuite'] = {found}\n"
        "try: import remac_env.integrations.robosuite\n"
        "except ImportError as error: told = str(error)\n"
        "if 'robosuite' not in told or 'make robosuite' not in told: raise SystemExit(told)\n"
    )
    assert "remac_env.envs.parallel" not in loaded_by(code, tmp_path, first="")["modules"]


def test_importing_loads_neither_gymnasium_nor_numpy(tmp_path: Path) -> None:
    heavy = {"gymnasium", "pettingzoo", "numpy", "mujoco"}
    assert not heavy & set(loaded_by("import remac_env", tmp_path, first="")["modules"])
    assert heavy & set(loaded_by("import remac_env.envs.parallel", tmp_path, first="")["modules"]) == heavy - {"mujoco"}
