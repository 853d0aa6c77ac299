"""A* over rounds of the skill table, for one robot or several."""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from remac_env.oracle.bounds import IMPOSSIBLE
from remac_env.oracle.moves import Joint, alike, joint_moves
from remac_env.rules.facts import Rules
from remac_env.rules.subtasks import WAIT, Subtask
from remac_env.state import WorldState

Reached = Callable[[WorldState], bool]

MAX_STATES = 200_000
"""States that a search looks at before it gives up, for one robot or two; about a minute for two. See `most_states`."""

_ROUNDS_EACH = {3: 10, 4: 60}
"""Robots -> how many times as long as with two robots a state takes, as there are more rounds to be played from it."""


@dataclass(frozen=True, slots=True, eq=False)
class _Step:
    """A world on the way, with the round that led to it from the one before."""

    world: WorldState
    before: _Step | None = None
    joint: Joint = field(default_factory=dict)

    def rounds(self) -> list[Joint]:
        """All rounds up to this world."""
        found, step = list[Joint](), self
        while step.before is not None:
            found.append(step.joint)
            step = step.before
        return found[::-1]


_Entry = tuple[float, int, int, _Step]


@dataclass(frozen=True)
class OraclePlan:
    """A plan: `rounds` of joint subtasks, one entry a robot; `expanded` states were looked at.

    `cost` is the number of rounds, and LITTER_ROUNDS for each object that it lets fall.
    """

    rounds: tuple[Mapping[str, Subtask], ...]
    expanded: int
    cost: int

    @property
    def length(self) -> int:
        """Number of rounds."""
        return len(self.rounds)

    def as_text(self) -> dict[str, list[str]]:
        """Robot -> commands, without the waits after its last subtask."""
        plan: dict[str, list[str]] = {}
        for joint in self.rounds:
            for robot, subtask in joint.items():
                plan.setdefault(robot, []).append(subtask.text)
        for commands in plan.values():
            while commands and commands[-1] == WAIT.text:
                commands.pop()
        return plan


@dataclass(frozen=True)
class Found:
    """What a search came to.

    Attributes:
        plan: None where none was found.
        lower: no plan costs less; IMPOSSIBLE where every way was followed to its end.
        gave_up: the bound on states was met before the search was done.
        too_long: ways were left because of the bound on rounds.
    """

    plan: OraclePlan | None
    lower: int
    gave_up: bool = False
    too_long: bool = False


def search_plan(
    scene: Rules,
    world: WorldState,
    reached: Reached,
    *,
    commands: Sequence[Subtask],
    bound: Callable[[WorldState], int] = lambda state: 0,
    max_rounds: int = 30,
    max_states: int | None = None,
) -> OraclePlan | None:
    """The plan of `search`, where only that matters."""
    return search(
        scene, world, reached, commands=commands, bound=bound, max_rounds=max_rounds, max_states=max_states
    ).plan


def search(
    scene: Rules,
    world: WorldState,
    reached: Reached,
    *,
    commands: Sequence[Subtask],
    bound: Callable[[WorldState], int] = lambda state: 0,
    max_rounds: int = 30,
    max_states: int | None = None,
    greed: float = 1.0,
) -> Found:
    """The cheapest sequence of rounds to a state in which `reached` is true.

    Args:
        scene: the kitchen.
        world: the state in which it begins.
        reached: whether a state will do; with three robots or more it must not hang on which robot is which.
        commands: the subtasks that robots may run; waiting is always allowed.
        bound: a cost in rounds that the rest needs at least; 0 makes the search uninformed.
        max_rounds: what a plan may cost at most, in rounds.
        max_states: states to look at before giving up, `most_states` where None.
        greed: more than 1 finds some plan sooner, not the cheapest; `lower` is then that of the start alone.
    """
    counter = itertools.count()
    max_states, first = most_states(scene) if max_states is None else max_states, bound(world)
    if first > max_rounds:
        return Found(None, first, too_long=first < IMPOSSIBLE)
    costs, done = {alike(scene, world): 0}, set[WorldState]()
    queue: list[_Entry] = [(greed * first, next(counter), 0, _Step(world))]
    expanded, too_long = 0, False
    while queue:
        estimate, _, cost, step = heapq.heappop(queue)
        state = step.world
        if cost > costs[key := alike(scene, state)] or (cost == costs[key] and key in done):
            continue  # a cheaper way to it was found since
        if expanded >= max_states:
            return Found(None, int(estimate) if greed == 1.0 else first, gave_up=True, too_long=too_long)
        expanded += 1
        done.add(key)
        if reached(state):
            return Found(OraclePlan(tuple(step.rounds()), expanded, cost), cost if greed == 1.0 else first)
        for move, after, price in joint_moves(scene, state, commands):
            total = cost + price
            if total >= costs.get(key := alike(scene, after), IMPOSSIBLE):
                continue
            rest = bound(after)
            if total + rest > max_rounds:
                too_long |= rest < IMPOSSIBLE
                continue
            costs[key] = total
            done.discard(key)
            heapq.heappush(queue, (total + greed * rest, next(counter), total, _Step(after, step, move)))
    return Found(None, max_rounds + 1 if too_long else IMPOSSIBLE, too_long=too_long)


def most_states(scene: Rules) -> int:
    """States that a search looks at before it gives up: fewer for larger teams, so that it takes a few minutes."""
    return MAX_STATES // _ROUNDS_EACH.get(len(scene.robots), 1)
