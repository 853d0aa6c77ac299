"""The search of all skills: stance x pose of the hand x branch of the arm, within a budget of collision checks."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any, TypeVar

from remac_env.backends.physics.controllers.scripted.collision import CollisionChecker
from remac_env.backends.physics.controllers.scripted.paths import Planner
from remac_env.backends.physics.controllers.scripted.skill import SkillFailure
from remac_env.backends.physics.pose import Pose
from remac_env.robots.rotation import Array

CHECKS = 9000
"""Collision checks, of about 80 us each, after which a search usually gives up."""

_CONFINED_CHECKS = 1500  # collision checks; of 62 searches that ended well behind keep-out planes one took more


P = TypeVar("P", bound=Pose)
T = TypeVar("T")


class Budget:
    """How many collision checks a search may use from now on.

    Behind keep-out planes it gives up early: what is not found soon is found without them once the neighbour is done.
    """

    def __init__(self, checker: CollisionChecker, checks: int) -> None:
        self.checker = checker
        self._last = checker.checks + (min(checks, _CONFINED_CHECKS) if checker.keep_out else checks)

    @property
    def spent(self) -> bool:
        """Whether the search has to end."""
        return self.checker.checks > self._last

    def narrow(self, checks: int) -> None:
        """Allow at most so many more."""
        self._last = min(self._last, self.checker.checks + checks)


class Known:
    """What a search has worked out once, by the numbers it depends on: from one grasp a door is swung in many ways.

    The collision checks that it took count again each time, so that a search gives up where it would without memory.
    """

    def __init__(self, checker: CollisionChecker) -> None:
        self._checker = checker
        self._found: dict[tuple[bytes, ...], tuple[Any, int]] = {}

    def get(self, find: Callable[[], T], *numbers: Array) -> T:
        """What ``find`` gives, which depends on these ``numbers`` alone."""
        key = tuple(each.tobytes() for each in numbers)
        if key in self._found:
            found, checks = self._found[key]
            self._checker.checks += checks
        else:
            before = self._checker.checks
            found = find()
            self._found[key] = found, self._checker.checks - before
        result: T = found
        return result


class Reasons:
    """Why candidates were refused, and how often."""

    def __init__(self) -> None:
        self._counts: Counter[str] = Counter()

    def add(self, what: str, why: object = None) -> None:
        """Note one more."""
        self._counts[what if why is None else f"{what}: {why}"] += 1

    def failure(self) -> SkillFailure:
        """``unreachable`` where no pose could be reached, ``blocked`` where objects were in the way."""
        if not self._counts:
            return SkillFailure("unreachable", "no configuration reaches it")
        return SkillFailure("blocked", "; ".join(f"{text} ({count})" for text, count in self._counts.most_common(3)))


def search(
    planner: Planner, budget: Budget, stands: Iterable[Array], poses: Callable[[Array], Iterable[P]],
    attempt: Callable[[Array, P, Array], T | None], *, ready: Callable[[Array], Array], most: int,
) -> T | None:
    """The first that ``attempt`` makes of a stance, a pose and a configuration; None where there is none in time.

    ``poses``: those to try at a stance (3,). ``ready``: the configuration (n,) there from which the arm starts; of
    those that reach a pose, ``most`` are tried, the nearest first.
    """
    known = Known(budget.checker)
    for base in stands:
        for pose in poses(base):
            if budget.spent:
                return None
            reaching = partial(planner.reach, pose, base, ready(base), most=most)
            for q in known.get(reaching, base, pose.position, pose.rotation):
                found = attempt(base, pose, q)
                if found is not None:
                    return found
    return None
