"""A body of one's own: what docs/extending.md says is enough for it to stand, drive and act; nobody knows the Panda."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

import remac_env
from remac_env.errors import OptionError, UncertifiedWarning, UnknownNameError
from remac_env.robots import bodies
from remac_env.robots.panda.body import Panda

ROOT = Path(remac_env.__file__).parents[1]
PACKAGES = [ROOT / name for name in ("remac_env", "remac_agents", "benchmarks")]


NAMES = {"finger_left": "left_jaw", "finger_right": "right_jaw", "torso": "column", "base_yaw": "turn"}


class Low(Panda):
    """A Panda on a base that is 8 cm lower, some of whose parts have other names."""

    joints = tuple(NAMES.get(name, name) for name in Panda.joints)
    fingers = tuple(NAMES[name] for name in Panda.fingers)

    def add_to(self, spec: mujoco.MjSpec, name: str, **more: Any) -> None:
        """The Panda's, renamed."""
        super().add_to(spec, name, **more)
        names = {f"{name}/{old}": f"{name}/{new}" for old, new in NAMES.items()}
        for part in (*spec.bodies, *spec.joints, *spec.actuators):
            part.name = names.get(part.name, part.name)
        for servo in spec.actuators:
            servo.target = names.get(servo.target, servo.target)
        for pair in spec.equalities:
            pair.name1, pair.name2 = names.get(pair.name1, pair.name1), names.get(pair.name2, pair.name2)
        for pair in spec.excludes:
            pair.bodyname1 = names.get(pair.bodyname1, pair.bodyname1)
            pair.bodyname2 = names.get(pair.bodyname2, pair.bodyname2)


@pytest.fixture
def low() -> Iterator[Panda]:
    """A body of one's own, known for as long as a test lasts."""
    body = Low(name="low panda", mount_height=0.62)
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


def test_a_body_of_ones_own_stands_drives_and_acts_in_physics(low: Panda) -> None:
    env = remac_env.parallel_env("OpenCabinetPnP", robots=2, body="low panda", layout="one_wall_large", max_rounds=9)
    with pytest.warns(UncertifiedWarning, match="'low panda' nothing is certified of .*cabinet"):
        env.reset(seed=1)
    commands = ["navigate to vegetable", "pick up vegetable"]
    found = []
    for text in commands:
        idle = env.vocabulary.encode("wait")
        _, _, _, _, infos = env.step({"robot_0": env.vocabulary.encode(text), "robot_1": idle})
        found.append((infos["robot_0"]["outcome"]["status"], infos["robot_0"]["outcome"]["reason"]))
    assert found == [("success", "")] * 2
    backend = env._backend
    assert backend is not None
    model = backend.model  # type: ignore[attr-defined]
    assert model.body("robot_0/lift").pos[2] == pytest.approx(0.62)
    assert env.world.robots["robot_0"].holding == "vegetable" == env.world.robots["robot_0"].hands["hand"]
    assert env.render_work().shape == (648, 768, 3)  # cameras know where it looks
    env.close()


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
    env = remac_env.parallel_env("OpenCabinetPnP", backend="symbolic", body="octopus")
    with pytest.raises(UnknownNameError, match="octopus.*panda"):
        env.reset(seed=0)
