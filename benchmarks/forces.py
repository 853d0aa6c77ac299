"""Torques of the arm, forces of the hand and at doors: `python benchmarks/forces.py --trials 5`.

Runs the chains of skill_chains.toml and measures every step of 5 ms, from the first command to the last. A
torque is all that a joint's motor gives, gravity compensation included; a force is the sum of what one body of a robot
(a finger, the hand, a link) and one door panel do to each other.
"""

from __future__ import annotations

import tomllib
from collections import defaultdict
from collections.abc import Iterable, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from multiprocessing import get_context
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray
from remac_bench.columns import show
from remac_bench.command import run_script
from remac_bench.flags import takes
from rich.table import Table
from skills import CHAINS, ROBOT, run_chain

from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.robots import bodies

DOOR_FORCE = 200.0
"""N, of one body of the robot on a door: what the project aims at."""

_NEAR_LIMIT = 0.999  # share of a limit from which on a joint is told to be at it
_STEP = 0.005  # s
BODY = bodies.get()


@dataclass
class Measured:
    """What was measured over some steps of 5 ms; torques and limits by joint, N m (fingers: N)."""

    steps: int = 0
    torque: NDArray[np.float64] = field(default_factory=lambda: np.zeros(7))
    at_limit: NDArray[np.int64] = field(default_factory=lambda: np.zeros(7, np.int64))
    finger: float = 0.0
    base: NDArray[np.float64] = field(default_factory=lambda: np.zeros(4))
    doors: dict[tuple[str, str], float] = field(default_factory=dict)
    over: dict[tuple[str, str], float] = field(default_factory=lambda: defaultdict(float))

    def add(self, other: Measured) -> None:
        """Take what another has measured into account."""
        self.steps += other.steps
        self.torque = np.maximum(self.torque, other.torque)
        self.at_limit += other.at_limit
        self.finger = max(self.finger, other.finger)
        self.base = np.maximum(self.base, other.base)
        for key, force in other.doors.items():
            self.doors[key] = max(self.doors.get(key, 0.0), force)
        for key, seconds in other.over.items():
            self.over[key] += seconds


class Probe:
    """Measures one robot of a backend at every step; to be set as its ``probe``."""

    def __init__(self, backend: PhysicsBackend, robot: str) -> None:
        model, data = backend.model, backend.data
        self._model, self._data, self.found = model, data, Measured()
        joints = [model.joint(f"{robot}/{part}") for part in BODY.joints]
        self._base = np.array([joint.dofadr[0] for joint in joints[:4]])
        self._arm = np.array([joint.dofadr[0] for joint in joints[4:]])
        # Where MuJoCo counts gravity compensation as passive, the motors have to give it all the same.
        self._passive = np.array([not model.jnt_actgravcomp[joint.id] for joint in joints[4:]])
        self._fingers = np.array([model.joint(f"{robot}/{part}").dofadr[0] for part in BODY.fingers])
        names = [model.body(number).name for number in range(model.nbody)]
        self._own = {number: name.split("/")[1] for number, name in enumerate(names) if name.startswith(robot + "/")}
        self._panels = {number: name for number, name in enumerate(names) if name.endswith("door")}

    def __call__(self) -> None:
        """One step has been simulated."""
        data, found = self._data, self.found
        torque = np.abs(data.qfrc_actuator[self._arm] + self._passive * data.qfrc_gravcomp[self._arm])
        found.steps += 1
        found.torque = np.maximum(found.torque, torque)
        found.at_limit += torque >= _NEAR_LIMIT * np.array(BODY.torques)
        found.base = np.maximum(found.base, np.abs(data.qfrc_actuator[self._base]))
        found.finger = max(found.finger, float(np.abs(data.qfrc_actuator[self._fingers]).max()))
        for (part, panel), force in self._door_forces().items():
            key, size = (part, panel), float(np.linalg.norm(force))
            found.doors[key] = max(found.doors.get(key, 0.0), size)
            if size > DOOR_FORCE:
                found.over[key] += _STEP

    def _door_forces(self) -> dict[tuple[str, str], NDArray[np.float64]]:
        """The force (3,) between each body of the robot and each door panel that it touches."""
        sums: dict[tuple[str, str], NDArray[np.float64]] = defaultdict(lambda: np.zeros(3))
        contact, wrench = self._data.contact, np.zeros(6)
        for number, pair in enumerate(self._model.geom_bodyid[contact.geom[: self._data.ncon]].tolist()):
            for sign, (one, other) in ((1.0, pair), (-1.0, pair[::-1])):
                if one in self._own and other in self._panels:
                    mujoco.mj_contactForce(self._model, self._data, number, wrench)
                    frame = contact.frame[number].reshape(3, 3)
                    sums[self._own[one], self._panels[other]] += sign * (frame.T @ wrench[:3])
        return sums


def measure(chain: Mapping[str, Any], seed: int) -> dict[str, Measured]:
    """Run a chain on a seed: what was measured, by command."""
    found: dict[str, list[Measured]] = defaultdict(list)

    def before(backend: PhysicsBackend, text: str) -> None:
        backend.probe = probe = Probe(backend, ROBOT)
        found["navigate" if text.startswith("navigate") else text].append(probe.found)

    run_chain(chain, seed, style=None, layout=None, perception_noise=0.0, before=before)
    return {text: together(parts) for text, parts in found.items()}


def together(parts: Iterable[Measured]) -> Measured:
    """Several measurements as one."""
    sum_ = Measured()
    for part in parts:
        sum_.add(part)
    return sum_


@takes("forces.trials", "script.first_seed", "script.only", "script.processes")
def main(*, trials: int, first_seed: int, only: str, processes: int) -> None:
    """Print largest torques and forces, by command."""
    chains = [chain for chain in tomllib.loads(CHAINS.read_text("utf-8"))["chain"] if only in chain["name"]]
    jobs = [(chain, first_seed + number) for chain in chains for number in range(trials)]
    found: dict[str, list[Measured]] = defaultdict(list)
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        for part in pool.map(_job, jobs):
            for text, measured in part.items():
                found[text].append(measured)
    by_command = {text: together(parts) for text, parts in found.items()}
    every = together(by_command.values())
    show(_torques({**by_command, "all": every}))
    show(_doors({**by_command, "all": every}))


def _job(job: tuple[Mapping[str, Any], int]) -> dict[str, Measured]:
    return measure(*job)


def _torques(found: Mapping[str, Measured]) -> Table:
    joints = (f"{number}: {limit:g}" for number, limit in enumerate(BODY.torques, 1))
    table = Table(
        "command", "s", *joints, "finger, N", "base, N", "torso, N",
        title="Largest torques of joints, N m, with their limits; in brackets the share of steps at the limit",
    )  # fmt: skip
    for text, part in found.items():
        torques = (
            f"{torque:.1f} ({count / part.steps:.2%})" if count else f"{torque:.1f}"
            for torque, count in zip(part.torque, part.at_limit, strict=True)
        )
        base, torso = float(np.hypot(*part.base[:2])), float(part.base[3])
        table.add_row(text, f"{part.steps * _STEP:.0f}", *torques, f"{part.finger:.1f}", f"{base:.0f}", f"{torso:.0f}")
    return table


def _doors(found: Mapping[str, Measured]) -> Table:
    table = Table(
        *("command", "part of the robot", "door panel", "largest force, N", f"s over {DOOR_FORCE:g} N"),
        title="Forces at doors",
    )
    for text, part in found.items():
        for (body, panel), force in sorted(part.doors.items()):
            table.add_row(text, body, panel, f"{force:.0f}", f"{part.over.get((body, panel), 0.0):.2f}")
    return table


if __name__ == "__main__":
    run_script(main)
