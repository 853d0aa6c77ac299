"""The list of bodies, and a Panda on another base; one with another arm is in test_six_joints.py."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import gymnasium
import numpy as np
import pytest

import remac_env
from remac_env import plugins
from remac_env.errors import OptionError, UnknownNameError
from remac_env.robots import bodies
from remac_env.robots.panda.body import Panda

ROOT = Path(remac_env.__file__).parents[1]
PACKAGES = [ROOT / name for name in ("remac_env", "remac_agents", "benchmarks")]


@pytest.fixture
def low() -> Iterator[Panda]:
    """A Panda on a base that is 8 cm lower, known for as long as a test lasts."""
    body = Panda(name="low panda", mount_height=0.62)
    bodies.register_body(body)
    yield body
    bodies._BODIES.pop(body.name)


def test_only_the_list_of_bodies_imports_the_panda() -> None:
    allowed = {"remac_env/robots/bodies.py"}
    for package in PACKAGES:
        for path in package.rglob("*.py"):
            name = path.relative_to(package.parent).as_posix()
            if name.startswith("remac_env/robots/panda/") or name in allowed:
                continue
            text = path.read_text("utf-8")
            for node in ast.walk(ast.parse(text)) if "panda" in text else ():
                found = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
                found += [f"{found[0]}.{alias.name}" for alias in node.names] if found else []
                found += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
                assert not any(each.startswith("remac_env.robots.panda") for each in found), f"{name} imports the Panda"


def test_starts_of_another_body_are_other_starts(low: Panda) -> None:
    digests = []
    for body in (bodies.STANDARD, low.name):
        env = remac_env.parallel_env("OpenCabinetPnP", backend="symbolic", body=body)
        env.reset(seed=1)
        digests.append(env.start.digest)
    assert digests[0] != digests[1]


def test_closed_form_and_model_agree_on_another_base(low: Panda) -> None:
    kinematics = low.kinematics()
    q = np.concatenate([[0.3, -0.4, 1.2, 0.1], low.via[0]])
    position, rotation = kinematics.forward(q)
    found = kinematics.solutions(position, rotation, q[:3], lifts=np.array([0.1]))
    assert len(found)
    for other in found:
        assert np.allclose(kinematics.forward(other)[0], position, atol=1e-6)


def test_what_is_no_body_is_refused(low: Panda) -> None:
    with pytest.raises(OptionError, match="exists already"):
        bodies.register_body(Panda(name="low panda"))
    broken = Panda(name="broken")
    broken.speed = np.ones(3)
    with pytest.raises(OptionError, match=r"speed of body 'broken' has the shape \(3,\); valid: \(11,\)"):
        bodies.register_body(broken)
    with pytest.raises(UnknownNameError, match="octopus.*panda"):
        remac_env.parallel_env("OpenCabinetPnP", backend="symbolic", body="octopus")


def test_a_body_is_had_by_the_address_of_its_class_or_object(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bodies, "_BODIES", dict(bodies._BODIES))
    (tmp_path / "mine.py").write_text(
        "from remac_env.robots.panda.body import Panda\n"
        "class Low(Panda):\n"
        "    def __init__(self):\n"
        "        super().__init__('low', 0.62)\n"
        "low = Low()\n",
        "utf-8",
    )
    for address in (f"{tmp_path / 'mine.py'}:Low", f"{tmp_path / 'mine.py'}:low"):
        env = remac_env.parallel_env("OpenCabinetPnP", backend="symbolic", body=address)
        env.reset(seed=1)
        assert env.start.body == address and bodies.get(address) is bodies.get(address)
        assert bodies.get(address).mount_height == 0.62
    kitchen = gymnasium.make("RemacKitchen-OpenCabinetPnP-v0", backend="symbolic", body=f"{tmp_path / 'mine.py'}:low")
    kitchen.reset(seed=1)
    monkeypatch.syspath_prepend(tmp_path)
    added = {"remac.bodies": {"lowest": "mine:low"}}
    for module in (bodies, plugins):
        monkeypatch.setattr(module, "installed", lambda group: added.get(group, {}))
    assert "lowest" in bodies.every_name() and "lowest" not in bodies.names()
    assert bodies.get("lowest").name == "low" and bodies.described("lowest")["body"] == "low"
    (tmp_path / "mine.py").write_text("class Short:\n    def __init__(self, height):\n        pass\n", "utf-8")
    with pytest.raises(OptionError, match="cannot be made: missing a required argument: 'height'; valid: a class"):
        bodies.get(f"{tmp_path / 'mine.py'}:Short")
    with pytest.raises(OptionError, match="body 3 is not valid; valid: a text"):
        remac_env.parallel_env("OpenCabinetPnP", backend="symbolic", body=3)


def test_a_digest_of_a_body_is_that_of_its_measures_and_code(low: Panda) -> None:
    assert bodies.described(bodies.STANDARD) == {}
    told = bodies.described(low.name)
    assert told["body"] == "low panda"
    for change in ({"mount_height": 0.63}, {"palm": 0.06}, {"skirt": "frill"}, {"lifts": np.array([0.1])}):
        (name, value), = change.items()
        before = getattr(low, name)
        setattr(low, name, value)
        assert bodies.described(low.name) != told, name
        setattr(low, name, before)
    assert bodies.described(low.name) == told
