"""Open and close a hinged door: the hand holds the handle and goes along the arc, arm and base together."""

from __future__ import annotations

import math
from collections.abc import Generator
from dataclasses import replace
from itertools import product

import numpy as np

from remac_env.backends.physics.controllers.base import Command
from remac_env.backends.physics.controllers.scripted.arc import NARROW_GRIP, DoorGrasp, arc_is_free, follow_arc
from remac_env.backends.physics.controllers.scripted.collision import OTHER, TARGET
from remac_env.backends.physics.controllers.scripted.grasps import MEASURED, Grasp
from remac_env.backends.physics.controllers.scripted.panel import DoorPanel
from remac_env.backends.physics.controllers.scripted.pull import pull
from remac_env.backends.physics.controllers.scripted.reach import Reach, go_to_grasp, let_go, plan_reach
from remac_env.backends.physics.controllers.scripted.skill import SkillFailure, Steps, go_home, shown, stances, tuck
from remac_env.backends.physics.controllers.scripted.verdicts import Free, Hit, NoWay
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.kitchen.fixtures.door import OPEN_TO, Door
from remac_env.kitchen.fixtures.level import Level
from remac_env.robots.body import Body, Fingertip
from remac_env.robots.rotation import Array, grip_frame

_SWUNG, _SHUT = 1.0, 0.045  # rad at which a panel has been opened, and closed
_CLEAR, _ASIDE = 0.8, 1.0  # rad at which a panel leaves room for the hand at its neighbour, and to which it is swung
# Share of the door's turn that the hand follows; the round bar turns in the fingers.
_OPENING_FOLLOWS, _CLOSING_FOLLOWS = (0.5, 0.8, 0.3), (0.3, 0.5, 0.15, 0.65)
_DISTANCES, _SIDES, _TURNS = (0.58, 0.5, 0.66, 0.74), (-0.05, 0.1, -0.2, 0.25, 0.4), (0.0, 0.3, -0.3)
_PARTS, _LEAST = (1.0, 0.7), 0.3  # rad to which a panel is opened first that does not open in one go; of which at least
_SHORT = 0.3  # rad by which an opened panel may fall short: one that stops before is held, and is left
# A hand that pushes: from the free edge, and above the handle's end, m; share of the panel's turn that it follows.
_INSETS, _HIGHER = (0.02, 0.035, 0.0), (0.13, 0.19, 0.25)
_CLOSING_TURNS, _OPENING_TURNS = (0.3, 0.15, 0.5, 0.0), (-0.6, -0.9, -0.3, -1.2)
_FINGERS = 0.02  # m from the panel's upper and lower edge within which fingers would miss it
_AIR = 0.022  # m from the panel to the grip site: closed fingertips as measured reach 19 mm at most


def open_door(here: Workspace, name: str) -> Steps:
    """Swing every panel of the door of fixture ``name`` open from any angle."""
    yield from _swing(here, name, OPEN_TO)


def close_door(here: Workspace, name: str) -> Steps:
    """Swing every panel of the door of fixture ``name`` shut from any angle."""
    yield from _swing(here, name, 0.0)


def _swing(here: Workspace, name: str, target: float) -> Steps:
    """The panels in turn, those nearer to the robot first; of two, one that stands there already is left alone."""
    levels = [panel for panel in here.kitchen.fixture(name).door_panels if isinstance(panel, Level)]
    panels = [_door(here, panel) for panel in here.kitchen.fixture(name).door_panels if isinstance(panel, Door)]
    here.begin()
    yield from tuck(here)
    aside, angle = float(here.robot.q[0]), here.sensed.joint
    if len(panels) > 1:
        panels.sort(key=lambda panel: abs(panel.at(0.0)[0] - aside))
        panels = [panel for panel in panels if not _there(angle(panel.joint), target)]
    if len(panels) > 1 and target == 0.0:
        panels = yield from _make_room(here, panels)
    for panel in panels:
        yield from _swing_panel(here, panel, target)
    for level in levels:
        yield from pull(here, level, target)
    yield from go_home(here)
    angles = here.sensed.reading(name).door_angles
    if not all(_there(value, target) for value in angles):
        raise SkillFailure("slipped", f"the {name} door stopped at {shown(angles)}")


def _make_room(here: Workspace, panels: list[DoorPanel]) -> Generator[Command, None, list[DoorPanel]]:
    """The order in which to close panels; beside one that is ajar there is no room for the hand, so it is opened."""
    orders = [panels, panels[::-1]]
    for order in orders:
        *_, last = order
        if not _SHUT < here.sensed.joint(last.joint) < _CLEAR:
            break
        try:
            yield from _swing_panel(here, last, _ASIDE)
            break
        except SkillFailure as failed:
            if failed.reason != "blocked" or order is orders[-1]:
                raise
    return order


def _there(angle: float, target: float) -> bool:
    return angle >= _SWUNG if target > 0.0 else angle <= _SHUT


def _door(here: Workspace, panel: Door) -> DoorPanel:
    model = here.sensed.model
    joint = model.joint(panel.joint)
    hinge = here.sensed.located(panel.joint, np.array(model.body(panel.joint).pos))
    bar = np.array(model.site(panel.grip).pos)
    radius, half, _ = model.geom(panel.grip).size
    geoms, sign = tuple(here.sensed.geoms(panel.joint)), -float(joint.axis[2])
    (along, out, up), (width, thickness, high) = model.geom_pos[geoms[0]], model.geom_size[geoms[0]]
    edge, faces = sign * float(along + sign * width), (float(out - thickness), float(out + thickness))
    ends = float(up - high), float(up + high)
    return DoorPanel(
        panel.joint, here.robot.frame, hinge, bar, float(half), float(radius), edge, faces, ends, sign,
        int(joint.qposadr[0]), geoms, here.sensed.turned(panel.joint),
    )


def _swing_panel(here: Workspace, door: DoorPanel, target: float) -> Steps:
    """Swing one panel by its handle, let go and back off; where no hand comes to that, push it; open it in two goes."""
    here.begin()
    yield from tuck(here)
    start = here.sensed.joint(door.joint)
    found, end = _plan(here, door, start, target)
    yield from go_to_grasp(here, found)
    if not isinstance(found.grasp, DoorGrasp):
        raise SkillFailure("blocked", f"no hand at {door.joint}")
    if not found.grasp.pushes:
        yield from here.mover.fingers(0.0, 10)
        if here.robot.opening < 0.008:
            yield from here.mover.fingers(here.robot.body.finger_travel, 6)
            raise SkillFailure("slipped", f"the hand missed the handle of {door.joint}")
    yield from follow_arc(here, door, found.grasp, start, end)
    yield from _back_off(here, door, 0.0 if found.grasp.pushes else NARROW_GRIP)
    if target > 0.0 and here.sensed.joint(door.joint) < min(end - _SHORT, _SWUNG):
        raise SkillFailure("slipped", f"{door.joint} stopped at {here.sensed.joint(door.joint):.2f} rad")
    if end != target:
        yield from _swing_panel(here, door, target)


def _plan(here: Workspace, door: DoorPanel, start: float, target: float) -> tuple[Reach, float]:
    """A way to a hand at the panel, and how far it can swing it: at the handle, else pushing, else not all the way."""
    closing, why = target < start, list[SkillFailure]()
    goes = [(_grasps, target), (_pushes, target)]
    goes += [(_grasps, part) for part in _PARTS if not closing and part > start + _LEAST]
    for hands, end in goes:
        grasps = hands(door, start, here.robot.body, closing=closing)
        try:
            if grasps:
                return _way(here, door, grasps, start, end), end
        except SkillFailure as failed:
            why.append(failed)
    raise why[0]


def _way(here: Workspace, door: DoorPanel, grasps: list[DoorGrasp], start: float, target: float) -> Reach:
    """A way to a grasp (all hold or all push) from which to swing the panel. Raises SkillFailure as `plan_reach`."""
    robot, checker, pushes = here.robot, here.clear.checker, grasps[0].pushes
    bar, posts = ((), ()) if pushes else (door.geoms[1:2], door.geoms[2:])
    here.begin(bar)
    robot.grip = 0.0 if pushes else here.robot.body.finger_travel if target > start else NARROW_GRIP
    checker.fingers(robot.grip)

    def after(goal: Array, grasp: Grasp) -> Free | Hit | NoWay:
        if not isinstance(grasp, DoorGrasp):
            return NoWay("no hand at a door")
        checker.mark(posts, TARGET)  # which the bar may turn against the fingers, once they hold it
        free = arc_is_free(here, door, goal, grasp, start, target)
        checker.mark(posts, OTHER)
        checker.data.qpos[door.address] = start
        checker.fingers(robot.grip)
        return free

    sides, turns = ([door.sign * value for value in values] for values in (_SIDES, _TURNS))
    return plan_reach(here, stances(here, door.at(start), _DISTANCES, sides, turns), grasps, after)


def _back_off(here: Workspace, door: DoorPanel, opening: float) -> Steps:
    """Let go, the fingers open by so much (m), straight back, away from the fronts, and fold the arm."""
    robot, planner = here.robot, here.clear.planner
    yield from let_go(here, door.geoms, opening)
    back = robot.q.copy()
    back[:2] -= min(0.3, max(0.0, back[1] - here.station.y)) * robot.heading[:2]
    if planner.edge(robot.q, back):
        yield from here.mover.go([back])
    here.begin()
    try:
        yield from tuck(here)
    except SkillFailure:
        # Beside a wall there may be no room to fold the arm; there is at the station, to which it goes as it is.
        home = np.concatenate([here.home, robot.q[3:]])
        if not planner.edge(robot.q, home):
            raise
        yield from here.mover.go([home])
        yield from tuck(here)


def _grasps(door: DoorPanel, angle: float, body: Body, *, closing: bool) -> list[DoorGrasp]:
    """Hands on the bar: level or pitched down, either way round.

    To open, the hand starts square to the panel. To close, it starts turned from the wall by its share of the door's
    angle, so that it ends square: the mirror of opening, and the robot stays in front of the fixture.
    """
    pitches = (0.0, -0.4, -0.8) if door.bar[2] > 1.25 else (-0.8, -0.5, 0.0)
    # How much the base helps along the arc: as ever, or hardly where another robot stands close by.
    helps = (body.door_weights, np.concatenate([0.1 * body.door_weights[:3], body.door_weights[3:]]))
    found: list[DoorGrasp] = []
    for pitch in pitches:
        higher = door.clear_of_palm(pitch, body.palm)
        at = door.at(angle, higher)
        for follows in _CLOSING_FOLLOWS if closing else _OPENING_FOLLOWS:
            turn = door.turn(follows * angle if closing else angle)
            for side in (1.0, -1.0):
                approach = turn @ np.array([0.0, math.cos(pitch), math.sin(pitch)])
                hand = grip_frame(approach, turn @ np.array([side, 0.0, 0.0]))
                for help_ in helps:
                    before = at - hand[:, 2] * 0.12
                    grasp = DoorGrasp(
                        at + hand[:, 2] * 0.004, hand, door.frame, before=before, follows=follows, weights=help_,
                        higher=higher,
                    )
                    found.append(grasp)
    return sorted(found, key=lambda grasp: grasp.weights is not helps[0])


def _pushes(door: DoorPanel, angle: float, body: Body, *, closing: bool) -> list[DoorGrasp]:
    """Closed hands before the face, or behind it, near the free edge above the handle; their wide side upright."""
    found, shares = [], _CLOSING_TURNS if closing else _OPENING_TURNS
    air = _AIR + (_reach(body.fingertip) - _reach(MEASURED))
    out = door.faces[0] - air if closing else door.faces[1] + air
    # In front a hand keeps clear of the handle; behind the panel there is none. Either way the fingers meet the panel.
    heights = [door.half + higher for higher in _HIGHER] + ([] if closing else [0.0])
    low, high = door.ends[0] - float(door.bar[2]) + _FINGERS, door.ends[1] - float(door.bar[2]) - _FINGERS
    heights = [height for height in heights if low <= height <= high]
    for follows, inset, height, pitch in product(shares, _INSETS, heights, (0.0, 0.3, -0.3)):
        beside = np.array([door.sign * (door.edge - inset), out, 0.0]) - door.bar * [1.0, 1.0, 0.0]
        turn = door.turn(follows * angle)
        approach = turn @ np.array([0.0, math.cos(pitch), math.sin(pitch)])
        for side in (1.0, -1.0):
            hand = grip_frame(approach, turn @ np.array([0.0, -side * math.sin(pitch), side * math.cos(pitch)]))
            grasp = DoorGrasp(
                np.zeros(3), hand, door.frame, before=np.zeros(3), follows=follows, weights=body.door_weights,
                higher=height, beside=beside, pushes=True,
            )
            at = grasp.at(door, angle)
            found.append(replace(grasp, position=at, before=at - hand[:, 2] * 0.12))
    return found


def _reach(tip: Fingertip) -> float:
    """How far (m) a fingertip reaches from the grip site at most, whatever way its wide side is turned."""
    return math.hypot(tip.beyond, tip.half_width)
