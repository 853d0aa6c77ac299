"""The cheapest plan over all commands that can matter, by way of those that the goal is about."""

from __future__ import annotations

from remac_env.oracle.goal_search import search_goal
from remac_env.oracle.search import Found, most_states
from remac_env.rules.facts import Rules
from remac_env.state import WorldState
from remac_env.tasks.goals import Goal

WIDER = 2
"""How many times as many states the proof may look at: more commands lead to more worlds of the same cost."""


def shortest(
    scene: Rules, world: WorldState, goal: Goal, *, max_rounds: int = 30, max_states: int | None = None
) -> Found:
    """What a search comes to that leaves out no command with which a plan could cost less.

    The commands that the goal is about nearly always give a cheapest plan. It is looked for among them first; then all
    commands that can matter are tried up to a cost of one less. Together that is quicker than to try them all at once.

    Args:
        scene: see `certify`.
        world: see `certify`.
        goal: see `certify`.
        max_rounds: what a plan may cost at most, in rounds.
        max_states: states to look at before giving up, `most_states` where None; WIDER times as many for the proof.

    Returns:
        With a plan and `gave_up`, the plan works, costs no less than `lower`, and is not proven to be the cheapest.
    """
    most = most_states(scene) if max_states is None else max_states
    near = search_goal(scene, world, goal, exact=False, max_rounds=max_rounds, max_states=most)
    if near.plan is None and not near.gave_up:
        return search_goal(scene, world, goal, max_rounds=max_rounds, max_states=most)
    below = search_goal(scene, world, goal, max_rounds=near.lower - 1, max_states=WIDER * most)
    if below.plan is not None or not (below.gave_up or below.too_long):
        return below
    return Found(near.plan, min(below.lower, near.lower), gave_up=near.gave_up or below.gave_up)
