"""A* over rounds of the skill table, for one robot or several."""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from remac_env.oracle.bounds import IMPOSSIBLE
from remac_env.oracle.moves import Joint, joint_moves
from remac_env.rules.facts import Rules
from remac_env.rules.subtasks import WAIT, Subtask
from remac_env.state import WorldState

Reached = Callable[[WorldState], bool]
_Entry = tuple[float, int, int, WorldState, WorldState | None, Joint]

MAX_STATES = 200_000
"""States that a search looks at before it gives up; about a minute for two robots."""


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
    max_states: int = MAX_STATES,
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
    max_states: int = MAX_STATES,
    greed: float = 1.0,
) -> Found:
    """The cheapest sequence of rounds to a state in which `reached` is true.

    Args:
        commands: the subtasks that robots may run; waiting is always allowed.
        bound: a cost in rounds that the rest needs at least; 0 makes the search uninformed.
        max_rounds: what a plan may cost at most, in rounds.
        max_states: states to look at before giving up.
        greed: more than 1 finds some plan sooner, not the cheapest; `lower` is then that of the start alone.
    """
    counter = itertools.count()
    parents: dict[WorldState, tuple[WorldState, Joint] | None] = {}
    first = bound(world)
    if first > max_rounds:
        return Found(None, first, too_long=first < IMPOSSIBLE)
    costs = {world: 0}
    queue: list[_Entry] = [(greed * first, next(counter), 0, world, None, {})]
    expanded, too_long = 0, False
    while queue:
        estimate, _, cost, state, parent, joint = heapq.heappop(queue)
        if cost > costs[state] or (cost == costs[state] and state in parents):
            continue  # a cheaper way to it was found since
        if expanded >= max_states:
            return Found(None, int(estimate) if greed == 1.0 else first, gave_up=True, too_long=too_long)
        expanded += 1
        parents[state] = None if parent is None else (parent, joint)
        if reached(state):
            return Found(OraclePlan(tuple(_trace(parents, state)), expanded, cost), cost if greed == 1.0 else first)
        for move, after, price in joint_moves(scene, state, commands):
            total = cost + price
            if total >= costs.get(after, IMPOSSIBLE):
                continue
            rest = bound(after)
            if total + rest > max_rounds:
                too_long |= rest < IMPOSSIBLE
                continue
            costs[after] = total
            parents.pop(after, None)
            heapq.heappush(queue, (total + greed * rest, next(counter), total, after, state, move))
    return Found(None, max_rounds + 1 if too_long else IMPOSSIBLE, too_long=too_long)


def _trace(parents: Mapping[WorldState, tuple[WorldState, Joint] | None], state: WorldState) -> list[Joint]:
    rounds: list[Joint] = []
    while (step := parents[state]) is not None:
        state, joint = step
        rounds.append(joint)
    return rounds[::-1]
