"""Objects that fell in a round although no subtask says so, and which robots are to answer for it. Pure functions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from remac_env.rules.facts import Rules
from remac_env.rules.subtasks import Subtask
from remac_env.state import WorldState, base_place


def fallen(
    scene: Rules, before: WorldState, after: WorldState, subtasks: Mapping[str, Subtask]
) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Each object that ended on the floor, or out of the vessel in or on which it lay, with the robots that answer.

    Those are the robot in whose hand it was or came to be, by itself or in a vessel; where there is none, the robots at
    the object's station; where there is none, all that moved. What a robot took out of its vessel has not fallen.
    """
    taken = {subtask.target for subtask in subtasks.values() if subtask.row.takes}
    for name, item in before.objects.items():
        was, now = item.place, after.objects[name].place
        on_floor = now.relation == "floor" and was.relation != "floor"
        spilt = was.relation == "vessel" and now != was and not (name in taken and now.relation == "held")
        if on_floor or spilt:
            yield name, _answering(scene, before, after, subtasks, name)


def _answering(
    scene: Rules, before: WorldState, after: WorldState, subtasks: Mapping[str, Subtask], name: str
) -> tuple[str, ...]:
    base = base_place(before, name)
    if base.relation == "held":
        return (base.where,)
    stood = before.objects[name].place
    vessel = after.objects[stood.where].place if stood.relation == "vessel" else None
    if vessel is not None and vessel.relation == "held":
        return (vessel.where,)
    moving = [robot for robot, subtask in subtasks.items() if not subtask.row.still]
    reaching = [robot for robot in moving if subtasks[robot].target in (name, stood.where)]
    station = scene.slots[base.where].station if base.relation == "slot" else None
    near = [robot for robot in moving if station in (before.robots[robot].station, after.robots[robot].station)]
    return tuple(reaching or near or moving)
