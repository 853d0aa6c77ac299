"""How far a world is from the goal: the cost of the certificate's plan, searched for once a world."""

from __future__ import annotations

from collections.abc import Hashable

from remac_env.oracle.certificate import certify
from remac_env.oracle.goal_search import among
from remac_env.rules.facts import Rules
from remac_env.rules.rounds import transition
from remac_env.state import WorldState
from remac_env.tasks.goals import Goal

FARTHEST = 40
"""Rounds that count where no plan of fewer is known: more than the longest plan of any built-in start."""

MOST_KEPT = 200_000
"""Worlds whose distance is remembered; then all are forgotten."""


class Distances:
    """Exact distances in rounds (an object that falls counts as LITTER_ROUNDS more), remembered over episodes.

    Every plan that is found gives the distance of each world on its way. Where the search gives up (several robots,
    far from the goal), the least that is proven counts. `searched` says how many searches there were.
    """

    def __init__(self, *, max_states: int | None = None) -> None:
        self._max_states = max_states
        self._known: dict[Hashable, int] = {}
        self.searched = 0

    def of(self, scene: Rules, world: WorldState, goal: Goal) -> int:
        """Rounds to the goal, 0..FARTHEST."""
        kitchen = (scene, goal)
        if (kitchen, world) not in self._known:
            self._search(scene, world, goal)
        return self._known[kitchen, world]

    def nearest(self, scene: Rules, world: WorldState, goal: Goal) -> int:
        """Rounds that the robot needs which would reach the goal first if it were alone in the kitchen, 0..FARTHEST.

        Where none could, because each holds what another one needs: rounds of all of them together.
        """
        left = min(self.of(*among(scene, world, (robot,)), goal) for robot in scene.robots)
        return left if left < FARTHEST else self.of(scene, world, goal)

    def _search(self, scene: Rules, world: WorldState, goal: Goal) -> None:
        self.searched += 1
        if len(self._known) > MOST_KEPT:
            self._known.clear()
        found = certify(scene, world, goal, max_rounds=FARTHEST, max_states=self._max_states)
        if found.optimum is None or found.plan is None:
            self._known[(scene, goal), world] = FARTHEST if found.lower is None else min(found.lower, FARTHEST)
            return
        kitchen = (scene, goal)
        self._known[kitchen, world] = found.optimum
        if found.optimum > found.plan.length:
            return  # something falls on the way, and not every round costs the same
        for number, joint in enumerate(found.plan.rounds, 1):
            world, _ = transition(scene, world, joint)
            self._known[kitchen, world] = found.optimum - number
