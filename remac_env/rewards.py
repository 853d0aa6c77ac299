"""What a round is worth: four rewards, each the same for all robots of the team."""

from __future__ import annotations

from typing import Protocol

from remac_env.rules.facts import Rules
from remac_env.state import WorldState
from remac_env.tasks.goals import Goal, progress


class Reward(Protocol):
    """Pays the rounds of one episode after the other."""

    def begin(self, scene: Rules, goal: Goal, world: WorldState) -> None:
        """An episode begins in this world; its goal does not hold yet."""

    def pay(self, world: WorldState, *, success: bool) -> float:
        """What the round that ended in this world is worth."""


class Sparse:
    """1 in the round that reaches the goal, else 0."""

    def begin(self, scene: Rules, goal: Goal, world: WorldState) -> None:
        """Nothing to remember."""

    def pay(self, world: WorldState, *, success: bool) -> float:
        """1.0 or 0.0."""
        return float(success)


class Progress:
    """What has been reached for the first time: the rise of the largest fraction of the goal's parts that ever held.

    Scaled so that the rewards of every episode that succeeds add up to 1. No round is worth less than 0: what must be
    undone for a while (a door that is to be shut in the end, an object taken out to be washed) costs nothing, and
    doing it again brings nothing.
    """

    def begin(self, scene: Rules, goal: Goal, world: WorldState) -> None:
        """Remember what holds at the start."""
        self._scene, self._goal = scene, goal
        self._best = self._first = progress(goal, scene, world)

    def pay(self, world: WorldState, *, success: bool) -> float:
        """The rise, 0..1."""
        now = max(self._best, progress(self._goal, self._scene, world))
        gained, self._best = now - self._best, now
        return gained / (1.0 - self._first)


class Distance:
    """1 for success, and the rounds by which the goal has come nearer: shaping by a potential, so that the sum of all
    episodes that succeed from one start is the same, and the best policy stays the best (Ng, Harada and Russell, 1999).

    Every round of a shortest plan is worth 1 or more. Distances are exact: see `remac_env.oracle.Distances`.
    """

    def __init__(self) -> None:
        # Imported here: the search is not needed by those who do not ask for it.
        from remac_env.oracle import Distances

        self._distances = Distances()

    def begin(self, scene: Rules, goal: Goal, world: WorldState) -> None:
        """Search for the distance of the start."""
        self._scene, self._goal = scene, goal
        self._left = self._rounds_left(world)

    def pay(self, world: WorldState, *, success: bool) -> float:
        """Rounds gained, and 1 for success."""
        left = 0 if success else self._rounds_left(world)
        gained, self._left = self._left - left, left
        return float(gained + success)

    def _rounds_left(self, world: WorldState) -> int:
        return self._distances.of(self._scene, world, self._goal)


class Nearest(Distance):
    """1 for success, and the rounds by which whoever is nearest to the goal, were it alone, has come nearer to it.

    For a team, whose distance falls only in rounds in which all robots that matter do the right thing at once: here
    each right step is paid when it is made. For one robot it is the same as `Distance`.
    """

    def _rounds_left(self, world: WorldState) -> int:
        return self._distances.nearest(self._scene, world, self._goal)


def make_reward(name: str) -> Reward:
    """The reward of this name, one of `remac_env.options.REWARDS`."""
    kinds: dict[str, type[Reward]] = {
        "sparse": Sparse, "progress": Progress, "distance": Distance, "nearest": Nearest,
    }  # fmt: skip
    return kinds[name]()
