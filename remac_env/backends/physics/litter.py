"""Objects on the floor: which robots drive around where there is room, and push aside, gently, where there is none."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from itertools import pairwise

import numpy as np

from remac_env.backends.physics.controllers.scripted.motion import StuckError
from remac_env.backends.physics.controllers.scripted.paths import Path
from remac_env.backends.physics.controllers.scripted.skill import Steps
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.kitchen.blocks import Block
from remac_env.robots.footprints import middle_and_half
from remac_env.robots.rotation import Array

PUSH = 150.0
"""N, with which a base pushes before it gives way: a drive at half speed takes 66 N to set the base going."""

_PATIENCE = 3  # control periods of it
_SLOWER = 2  # times as long as usual takes a drive that pushes
_RETREAT = 16  # control periods by which a drive that was stopped goes back
_NEAR = 0.03  # m between objects, or an object and a base, that press on one another


def lying(here: Workspace) -> frozenset[str]:
    """The objects on the floor, as the robot sees them."""
    return frozenset(body for body in here.kitchen.objects if body != here.hand.body and here.sensed.on_floor(body))


def blocks(here: Workspace, bodies: Collection[str]) -> tuple[Block, ...]:
    """The floor, world frame, that objects take."""
    return tuple(_block(here, body) for body in sorted(bodies))


def _block(here: Workspace, body: str) -> Block:
    (x, y, _), reach = here.sensed.in_room(body).position, _reach(here, body)
    return Block((x - reach, y - reach, 0.0), (x + reach, y + reach, 1.0))


def _reach(here: Workspace, body: str) -> float:
    """How far an object reaches from its frame at most, in whatever way it lies (m)."""
    return float(np.linalg.norm(here.kitchen.objects[body].size))


def pressed(here: Workspace) -> frozenset[str]:
    """The objects on the floor that are at the base of a robot, and those at them."""
    places = {body: here.sensed.in_room(body).position[:2] for body in lying(here)}
    x, y, yaw = here.robot.standing
    turn = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
    middle, half = middle_and_half(here.robot.body.footprint)

    def at_base(body: str) -> bool:
        out = np.abs(turn @ (places[body] - [x, y]) - middle) - half
        return float(np.linalg.norm(np.maximum(out, 0.0))) < _reach(here, body) + _NEAR

    found = {body for body in places if at_base(body)}
    queue = sorted(found)
    while queue:
        one = queue.pop()
        for other in sorted(places.keys() - found):
            gap = float(np.linalg.norm(places[one] - places[other]))
            if gap < _reach(here, one) + _reach(here, other) + _NEAR:
                found.add(other)
                queue.append(other)
    return frozenset(found)


def slowed(path: Path) -> Path:
    """The same way, one configuration a period, slowly enough to push what is on it."""
    shares = [k / _SLOWER for k in range(1, _SLOWER + 1)]
    return [one + share * (other - one) for one, other in pairwise([path[0], *path]) for share in shares]


class Bumper:
    """Watches with how much force a base drives; one for each drive."""

    def __init__(self, here: Workspace) -> None:
        self._here, self._late = here, 0

    def check(self) -> None:
        """To be called after every control period. Raises StuckError when the base has pushed too hard for too long."""
        force = self._here.robot.push
        self._late = self._late + 1 if force > PUSH else 0
        if self._late >= _PATIENCE:
            raise StuckError(f"what lies on the floor holds the robot with {force:.0f} N")


def retreat(here: Workspace, travelled: Sequence[Array]) -> Steps:
    """Go back a little on the way just gone, as far as that can be done, so that nothing stays pressed."""
    here.robot.q = here.robot.measured
    now = here.robot.q[:3]
    last = min(range(len(travelled)), key=lambda k: float(np.abs(travelled[k][:3] - now).sum()), default=0)
    try:
        for q in list(travelled[:last])[: -_RETREAT - 1 : -1]:
            yield from here.mover.step(q)
    except StuckError:
        here.robot.q = here.robot.measured
