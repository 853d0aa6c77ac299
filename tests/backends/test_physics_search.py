"""The one search of all skills: what it answers, that it keeps to its budget, and what it says when it fails."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import pytest

from remac_env.backends.physics.controllers.scripted import insert, reach, search
from remac_env.backends.physics.controllers.scripted.grasps import Grasp
from remac_env.backends.physics.controllers.scripted.search import Budget, Known, Reasons
from remac_env.backends.physics.controllers.scripted.verdicts import FREE, Hit, NoWay
from remac_env.backends.physics.pose import Pose
from remac_env.kitchen.frame import WORLD
from remac_env.robots.rotation import Array

STANDS = [np.array([x, 0.0, 0.0]) for x in (0.0, 1.0, 2.0)]
GRASPS = [Grasp(np.full(3, float(k)), np.eye(3), WORLD, before=np.zeros(3)) for k in range(4)]


@dataclass
class Counted:
    """Stands in for the collision checker."""

    checks: int = 0
    keep_out: tuple[object, ...] = ()


class Three:
    """A planner that reaches every pose in three ways."""

    def reach(self, pose: Pose, base: Array, near: Array, *, most: int) -> list[Array]:
        return [np.array([base[0], pose.position[0], k]) for k in range(most)]


def look(checker: Counted, budget: Budget, right: tuple[float, float, float] | None = None) -> tuple[Any, list[Any]]:
    """Search with one collision check a try; what is found, and all that was tried."""
    tried = []

    def attempt(base: Array, pose: Grasp, q: Array) -> str | None:
        checker.checks += 1
        tried.append(tuple(q))
        return "found" if tuple(q) == right else None

    def poses(base: Array) -> Iterable[Grasp]:
        return GRASPS

    found = search.search(cast(Any, Three()), budget, STANDS, poses, attempt, ready=lambda base: base, most=3)
    return found, tried


def test_the_first_that_works_in_the_order_of_stances_poses_and_branches() -> None:
    checker = Counted()
    found, tried = look(checker, Budget(cast(Any, checker), 1000), (1.0, 2.0, 1.0))
    assert found == "found" and tried == sorted(tried) and len(tried) == 20
    assert look(checker, Budget(cast(Any, checker), 1000))[0] is None


@pytest.mark.parametrize("checks", [0, 5, 10])
def test_a_search_keeps_to_its_budget(checks: int, monkeypatch: pytest.MonkeyPatch) -> None:
    checker = Counted()
    assert len(look(checker, Budget(cast(Any, checker), checks))[1]) <= checks + 3, "to the end of a pose at most"
    monkeypatch.setattr(Budget, "spent", False)
    assert len(look(checker, Budget(cast(Any, checker), checks))[1]) == 36, "without it everything is tried"


def test_what_was_worked_out_once_is_known_and_its_checks_count_again() -> None:
    checker, asked = Counted(), []

    def find() -> int:
        checker.checks += 5
        asked.append(checker.checks)
        return len(asked)

    known = Known(cast(Any, checker))
    one, other = np.zeros(3), np.ones(3)
    assert [known.get(find, *at) for at in ((one,), (other,), (one,), (one, other), (one,))] == [1, 2, 1, 3, 1]
    assert len(asked) == 3 and checker.checks == 25, "or a search would go on for longer than without memory"


def test_a_budget_is_small_behind_keep_out_planes_and_can_be_narrowed() -> None:
    checker = Counted(checks=7)
    usual, confined = (Budget(cast(Any, each), search.CHECKS) for each in (checker, Counted(7, ("plane",))))
    checker.checks = 7 + 1501
    confined.checker = cast(Any, checker)
    assert confined.spent and not usual.spent
    usual.narrow(10)
    checker.checks += 11
    assert usual.spent
    usual.narrow(1000)
    assert usual.spent, "never wider"


def test_reaching_and_inserting_share_it() -> None:
    for room in (reach, insert):
        assert room.search is search.search and room.Budget is Budget, room


def test_verdicts_are_values() -> None:
    assert FREE and not Hit("a", "b") and not NoWay("too far")
    assert Hit("a", "b") == Hit("a", "b") and str(Hit("a", "b")) == "a meets b" and str(NoWay("too far")) == "too far"


def test_the_commonest_reasons_are_told() -> None:
    why = Reasons()
    assert (why.failure().reason, why.failure().detail) == ("unreachable", "no configuration reaches it")
    for name, count in (("door", 3), ("wall", 1), ("mug", 2), ("hob", 1)):
        for _ in range(count):
            why.add("goal", Hit("hand", name))
    why.add("no path to the pre-grasp")
    assert why.failure().reason == "blocked"
    assert why.failure().detail == "goal: hand meets door (3); goal: hand meets mug (2); goal: hand meets wall (1)"
