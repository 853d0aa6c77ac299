"""What is proven about an episode: its optimum, or bounds, and how they came about."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

from remac_env.oracle.bounds import IMPOSSIBLE
from remac_env.oracle.goal_search import search_goal
from remac_env.oracle.search import OraclePlan, most_states
from remac_env.oracle.shortest import shortest
from remac_env.rules.facts import ASIDE, Rules
from remac_env.state import WorldState
from remac_env.tasks.goals import Goal

GREED = 4.0
"""How much more than the way behind counts the way ahead, in a search for any plan at all."""

LONGEST = 1000
"""Rounds that a plan may take where nothing bounds them: more than any kitchen needs."""

KEPT = 64
"""Certificates that a process keeps: methods and iterations of a run begin in the same worlds."""

Proof = Literal["search", "bounds", "exhausted", "rounds"]


@dataclass(frozen=True, kw_only=True)
class Certificate:
    """The shortest plan of an episode as far as it is known. Costs are rounds, and LITTER_ROUNDS for what falls.

    Attributes:
        plan: the cheapest plan that is known, None where none is.
        lower: no plan costs less; None where there is none at all.
        proof: "search" - the plan is the cheapest; "bounds" - the search met its bound on states, and the truth lies
            between `lower` and the plan's cost, if a plan is known; "exhausted" - every way was followed to its end,
            there is no plan; "rounds" - there is no plan within the bound on rounds.
        expanded: states that were looked at.
    """

    plan: OraclePlan | None
    lower: int | None
    proof: Proof
    expanded: int = 0

    @property
    def optimum(self) -> int | None:
        """The cost of the cheapest plan, None where it is not known or there is none."""
        return None if self.plan is None or self.proof != "search" else self.plan.cost

    @property
    def upper(self) -> int | None:
        """The cost of the cheapest plan that is known, None where none is."""
        return None if self.plan is None else self.plan.cost

    @property
    def unknown(self) -> bool:
        """True where the search gave up before it could say how long the shortest plan is, or whether there is one."""
        return self.proof == "bounds"


def certify(
    scene: Rules, world: WorldState, goal: Goal, *, max_rounds: int = 30, max_states: int | None = None
) -> Certificate:
    """The certificate of a start for all robots of the scene.

    Args:
        scene: the kitchen.
        world: the state in which it begins.
        goal: what is to be reached.
        max_rounds: what a plan may cost at most, in rounds.
        max_states: states to look at before giving up, `most_states` where None. It is the bound of each search: for a
            plan, for the proof (see `shortest`), and for any plan at all.
    """
    max_states = most_states(scene) if max_states is None else max_states
    try:
        hash((scene, world, goal))
    except TypeError:  # a goal of somebody's own, which may change
        return _certificate(scene, world, goal, max_rounds, max_states)
    return _kept(scene, world, goal, max_rounds, max_states)


def _certificate(scene: Rules, world: WorldState, goal: Goal, max_rounds: int, max_states: int) -> Certificate:
    found = shortest(scene, world, goal, max_rounds=max_rounds, max_states=max_states)
    some = found.plan
    if some is not None and not found.gave_up:
        return Certificate(plan=some, lower=found.lower, proof="search", expanded=some.expanded)
    if not found.gave_up:
        lower = None if found.lower >= IMPOSSIBLE else found.lower
        return Certificate(plan=None, lower=lower, proof="rounds" if found.too_long else "exhausted")
    if some is None:
        some = search_goal(scene, world, goal, max_rounds=max_rounds, max_states=max_states, greed=GREED).plan
    proof: Proof = "search" if some is not None and some.cost == found.lower else "bounds"
    return Certificate(plan=some, lower=found.lower, proof=proof, expanded=max_states)


_kept = lru_cache(maxsize=KEPT)(_certificate)


def solve(
    scene: Rules, world: WorldState, goal: Goal, *, max_rounds: int = 30, max_states: int | None = None
) -> OraclePlan | None:
    """The cheapest plan to the goal for all robots of the scene, or None where none of at most `max_rounds` is known.

    Who must tell "there is none" from "none is known" asks `certify`.
    """
    certificate = certify(scene, world, goal, max_rounds=max_rounds, max_states=max_states)
    return certificate.plan


def solvable(scene: Rules, world: WorldState, goal: Goal, *, max_states: int | None = None) -> bool | None:
    """Whether any plan reaches the goal, however long; None where the search gave up.

    One robot is tried first, since that is quicker; then all of them together.
    """
    idle = [name for name, state in world.robots.items() if state.station == ASIDE and state.holding is None]
    for robots in dict.fromkeys((tuple(idle[:1]) if len(idle) == len(scene.robots) else scene.robots, scene.robots)):
        found = search_goal(
            scene, world, goal, robots=robots, max_rounds=LONGEST, max_states=max_states, greed=GREED
        )
        if found.plan is not None:
            return True
    return None if found.gave_up or found.too_long else False
