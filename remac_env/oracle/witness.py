"""A plan to a long goal, part after part: not the shortest, but one that is certain, where exact search gives up."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from remac_env.oracle.goal_search import search_goal
from remac_env.oracle.moves import Joint
from remac_env.oracle.search import OraclePlan
from remac_env.rules.facts import ASIDE, Rules
from remac_env.rules.rounds import transition
from remac_env.rules.subtasks import WAIT
from remac_env.state import WorldState
from remac_env.tasks.compound import AnyOf, Before, Count, ForAll
from remac_env.tasks.goals import All, Goal, Inside, Marked

PART_STATES = 800
"""States that the search for one part looks at."""

PART_ROUNDS = 24
"""Rounds that one part may take."""

GREED = 3.0


def witness(
    scene: Rules, world: WorldState, goal: Goal, *, part_states: int = PART_STATES, hints: Sequence[Goal] = ()
) -> OraclePlan | None:
    """A plan that reaches the goal, or None where none was found this way.

    The parts of the goal are reached one after the other, and what has been reached must hold at the end of each. One
    robot works; where it cannot reach a part, all do.

    Args:
        scene: see `certify`.
        world: see `certify`.
        goal: see `certify`.
        part_states: states to look at for each part.
        hints: the parts in the order in which to reach them; by default that of the goal itself.
    """
    rounds: list[Joint] = []
    done: list[Goal] = []
    expanded = 0
    parts = list(hints) or list(parts_of(goal))
    for part in (*parts, goal):
        done = [each for each in done if each.holds(scene, world)]
        found = _reach(scene, world, part, done, states=part_states)
        if found is None:
            return None
        rounds += map(dict, found.rounds)
        expanded += found.expanded
        for joint in found.rounds:
            world, _ = transition(scene, world, joint)
        done.append(part)
    return OraclePlan(tuple(rounds), expanded, len(rounds)) if goal.holds(scene, world) else None


def parts_of(goal: Goal) -> Iterator[Goal]:
    """The parts to be reached one after the other: for each object its marks, and then where it is to be."""
    if isinstance(goal, All):
        for part in goal.goals:
            yield from parts_of(part)
    elif isinstance(goal, ForAll):
        for part in goal.parts:
            yield from parts_of(part)
    elif isinstance(goal, Count):
        for part in goal.parts[: goal.least]:
            yield from parts_of(part)
    elif isinstance(goal, Before):
        yield from (Marked(goal.name, goal.first), Marked(goal.name, goal.then))
    elif isinstance(goal, AnyOf | Inside | Marked) or goal.told(1):
        yield goal


def _reach(scene: Rules, world: WorldState, part: Goal, done: Sequence[Goal], *, states: int) -> OraclePlan | None:
    whole = All(*done, part)
    if whole.holds(scene, world):
        return OraclePlan((), 0, 0)
    idle = [name for name, state in world.robots.items() if state.station == ASIDE and state.holding is None]
    alone = [name for name in scene.robots if [other for other in scene.robots if other != name] == idle]
    first = alone[:1] or ([min(scene.robots)] if len(idle) == len(scene.robots) else [])
    for robots in dict.fromkeys((tuple(first), scene.robots)):
        if robots and (plan := _search(scene, world, whole, part, robots, states)) is not None:
            return plan
    return None


def _search(
    scene: Rules, world: WorldState, whole: Goal, part: Goal, robots: tuple[str, ...], states: int
) -> OraclePlan | None:
    """The part reached by these robots, while the others wait out of the way."""
    found = search_goal(
        scene, world, whole, about=part, exact=False, robots=robots, max_rounds=PART_ROUNDS, max_states=states,
        greed=GREED,
    ).plan
    if found is None:
        return None
    waits = {name: WAIT for name in scene.robots if name not in robots}
    return OraclePlan(tuple({**waits, **joint} for joint in found.rounds), found.expanded, len(found.rounds))
