"""The search for a goal: which commands can matter to it, what it costs at least, and when it is reached."""

from __future__ import annotations

from dataclasses import replace

from remac_env.oracle.bounds import make_bound
from remac_env.oracle.commands import relevant_commands
from remac_env.oracle.search import Found, search
from remac_env.rules.facts import Rules
from remac_env.state import FrozenMap, WorldState
from remac_env.tasks.goals import Goal


def search_goal(
    scene: Rules, world: WorldState, goal: Goal, *, about: Goal | None = None, exact: bool = True,
    robots: tuple[str, ...] | None = None, max_rounds: int, max_states: int | None = None, greed: float = 1.0,
) -> Found:
    """What `search` comes to for a goal.

    Args:
        scene: see `certify`.
        world: see `certify`.
        goal: see `certify`.
        about: the part of the goal that commands and bound are about, the whole of it where None.
        exact: with all commands that can matter; else with those that the goal is about.
        robots: those that act, all where None; the others are as if they were not there.
        max_rounds: see `search`.
        max_states: see `search`.
        greed: see `search`.
    """
    if robots is not None:
        scene, world = among(scene, world, robots)
    part = goal if about is None else about
    return search(
        scene,
        world,
        lambda state: goal.holds(scene, state),
        commands=relevant_commands(scene, world, part, exact=exact),
        bound=make_bound(scene, part),
        max_rounds=max_rounds,
        max_states=max_states,
        greed=greed,
    )


def among(scene: Rules, world: WorldState, robots: tuple[str, ...]) -> tuple[Rules, WorldState]:
    """The same kitchen with only these robots in it; what others hold is out of everybody's reach."""
    there = FrozenMap({name: world.robots[name] for name in robots})
    return replace(scene, robots=robots), WorldState(there, world.objects, world.fixtures)
