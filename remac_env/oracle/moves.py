"""The rounds that can be played from a world, each with the world after it and what it costs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from remac_env.rules.claims import first_false
from remac_env.rules.facts import Rules
from remac_env.rules.rounds import at_rest, attempt, merge
from remac_env.rules.subtasks import WAIT, Subtask
from remac_env.state import FrozenMap, Place, WorldState

LITTER_ROUNDS = 4
"""What letting an object fall costs, in rounds: one more than to carry it to a free place, put it down and return, so
that no plan is the better for littering."""

SEVERAL = 3
"""Robots from which on rounds and worlds that differ in the robots' names alone are looked at once: n! times fewer."""

Joint = dict[str, Subtask]


@dataclass(frozen=True, slots=True)
class _Move:
    """One robot's part of a round: the world with its effect alone, where it ends, its number among all that it can do
    now, and whether it drops an object."""

    subtask: Subtask
    after: WorldState
    station: str
    number: int = 0
    drops: bool = False


def joint_moves(
    scene: Rules, world: WorldState, commands: Sequence[Subtask]
) -> Iterator[tuple[Joint, WorldState, int]]:
    """Every round that changes the world: robot -> subtask, the world after it, and its cost in rounds.

    A subtask that fails is among them where it changes something: a hand that opens over the floor.
    """
    rounds: list[tuple[tuple[_Move, ...], WorldState]] = [((), world)]
    for robot, twin in zip(scene.robots, _twins(scene, world), strict=True):
        moves = _moves(scene, world, robot, commands)
        longer = []
        for chosen, together in rounds:
            # Of rounds in which twins change parts, one is enough: the later twin makes no earlier move.
            for move in moves if twin is None else moves[chosen[twin].number :]:
                if any(_clash(scene, move, other) for other in chosen):
                    continue
                after = merge(world, {"": together, robot: move.after})
                if after is not None:
                    longer.append(((*chosen, move), after))
        rounds = longer
    for chosen, after in rounds:
        if after != world:
            joint = {name: move.subtask for name, move in zip(scene.robots, chosen, strict=True)}
            yield joint, at_rest(scene, after), 1 + LITTER_ROUNDS * sum(move.drops for move in chosen)


def _clash(scene: Rules, one: _Move, other: _Move) -> bool:
    """Whether two robots cannot make these moves in one round, wherever else the world is the same."""
    if scene.conflicting(one.station, other.station):
        return True
    takes = one.subtask.row.takes and other.subtask.row.takes
    return takes and one.subtask.target == other.subtask.target


def _twins(scene: Rules, world: WorldState) -> list[int | None]:
    """For each robot the number of the nearest one before it in the same state; None for all, where robots are few."""
    states = [world.robots[robot] for robot in scene.robots]
    if len(states) < SEVERAL:
        return [None] * len(states)
    return [max((i for i in range(k) if states[i] == states[k]), default=None) for k in range(len(states))]


def alike(scene: Rules, world: WorldState) -> WorldState:
    """The one of all worlds that are equal but for the robots' names; the world itself, where robots are few."""
    if len(scene.robots) < SEVERAL:
        return world
    order = sorted(scene.robots, key=lambda name: (world.robots[name].station, world.robots[name].holding or ""))
    if order == sorted(scene.robots):
        return world
    names = dict(zip(order, sorted(scene.robots), strict=True))
    changed = {
        name: replace(item, place=Place("held", names[item.place.where]))
        for name, item in world.objects.items()
        if item.place.relation == "held" and item.place.where in names
    }
    robots = FrozenMap({names[name]: world.robots[name] for name in order})
    return replace(world, robots=robots, objects=FrozenMap({**world.objects, **changed}))


def _moves(scene: Rules, world: WorldState, robot: str, commands: Sequence[Subtask]) -> list[_Move]:
    """What this robot can do now that changes something, and waiting."""
    here = world.robots[robot].station
    moves = [_Move(WAIT, world, here)]
    seen = {here}
    dropped = False
    for subtask in commands:
        if first_false(scene, world, robot, subtask, "refuse", alone=False) is not None:
            continue
        station = here
        if (goes := subtask.row.goes) is not None:
            goal = goes(scene, world, robot, subtask.target)
            if goal is None or goal in seen:
                continue
            seen.add(goal)
            station = goal
        outcome, after = attempt(scene, world, robot, subtask, station=station)
        if outcome.success:
            moves.append(_Move(subtask, after, station, len(moves)))
        elif after is not world:
            drops = after.robots[robot].holding != world.robots[robot].holding
            if not drops or not dropped:
                moves.append(_Move(subtask, after, station, len(moves), drops=drops))
            dropped |= drops  # however it comes about, the object lies on the floor
    return moves
