"""The rounds that can be played from a world, each with the world after it and what it costs."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from remac_env.rules.claims import first_false
from remac_env.rules.facts import Rules
from remac_env.rules.rounds import at_rest, attempt, merge
from remac_env.rules.subtasks import WAIT, Subtask
from remac_env.state import WorldState

LITTER_ROUNDS = 4
"""What letting an object fall costs, in rounds: one more than to carry it to a free place, put it down and return, so
that no plan is the better for littering."""

Joint = dict[str, Subtask]


@dataclass(frozen=True, slots=True)
class _Move:
    """One robot's part of a round: the world with its effect alone, where it ends, and whether it dropped an object."""

    subtask: Subtask
    after: WorldState
    station: str
    drops: bool = False


def joint_moves(
    scene: Rules, world: WorldState, commands: Sequence[Subtask]
) -> Iterator[tuple[Joint, WorldState, int]]:
    """Every round that changes the world: robot -> subtask, the world after it, and its cost in rounds.

    A subtask that fails is among them where it changes something: a hand that opens over the floor.
    """
    single = {robot: _moves(scene, world, robot, commands) for robot in scene.robots}
    for choice in itertools.product(*single.values()):
        stations = [move.station for move in choice]
        if any(scene.conflicting(a, b) for a, b in itertools.combinations(stations, 2)):
            continue
        picked = [move.subtask.target for move in choice if move.subtask.row.takes]
        if len(set(picked)) < len(picked):
            continue
        after = merge(world, {name: move.after for name, move in zip(single, choice, strict=True)})
        if after is not None and after != world:
            joint = {name: move.subtask for name, move in zip(single, choice, strict=True)}
            yield joint, at_rest(scene, after), 1 + LITTER_ROUNDS * sum(move.drops for move in choice)


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
            moves.append(_Move(subtask, after, station))
        elif after is not world and not dropped:
            dropped = True  # however it comes about, the object lies on the floor
            moves.append(_Move(subtask, after, station, drops=True))
    return moves
