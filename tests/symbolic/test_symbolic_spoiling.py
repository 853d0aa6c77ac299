"""No plan is cut off because something spoils: what is counted until it is shut away is never above the truth."""

from __future__ import annotations

import heapq
import math
from collections import defaultdict
from collections.abc import Hashable, Iterator
from dataclasses import replace
from itertools import combinations
from typing import Any

import pytest

import remac_env
from remac_env.backends.symbolic import nominal
from remac_env.events import spoiling
from remac_env.events.makespan import _Search, makespan
from remac_env.events.spoiling import ShutAway
from remac_env.rules.facts import Quirk, Rules
from remac_env.rules.processes import chosen
from remac_env.rules.subtasks import Subtask
from remac_env.start import Start
from remac_env.state import WorldState, base_place

BOTH = ("fish", "meat")
DOORS = (*BOTH, "cabinet", "microwave")


def kitchen(robots: int, layout: str = "one_wall_large") -> Any:
    env = remac_env.parallel_env("FrozenInTime", robots=robots, backend="symbolic", clock="events", layout=layout)
    env.reset(seed=1)
    return env


def with_processes(start: Start, processes: Any) -> Start:
    return replace(start, scene=replace(start.scene, processes=tuple(processes)))


def melting_after(start: Start, seconds: float) -> Start:
    return with_processes(start, [replace(process, seconds=seconds) for process in start.scene.processes])


class Everything:
    """All moments that robots can come to who use these nouns alone, and what lies between them, without any bound."""

    def __init__(self, env: Any, names: tuple[str, ...], nouns: tuple[str, ...]) -> None:
        self.search = _Search(with_processes(env.start, ()), env.goal, math.inf, nominal)
        self.rules, self.names = env.start.scene, names
        commands = [each for each in self.search._commands if each.target in ("", *nouns)]
        vessels = [name for name in nouns if name in self.rules.objects and self.rules.objects[name].holds]
        self.search._commands = [*commands, *(Subtask("pick up", name) for name in vessels)]
        first = self.search._moment({}, None)
        self.moments, self.before = {first.key: first}, defaultdict[Hashable, list[tuple[Hashable, float]]](list)
        queue = [first]
        for moment in queue:  # grows while it is read
            for after in self.search._next(moment):
                self.before[after.key].append((moment.key, after.now - moment.now))
                if after.key not in self.moments:
                    self.moments[after.key] = after
                    queue.append(after)

    def truth(self) -> Iterator[tuple[WorldState, frozenset[str], float]]:
        """(The world once what is under way has ended, what has yet to be behind a shut door, s that this takes)."""
        subsets = [frozenset(some) for size in range(len(self.names) + 1) for some in combinations(self.names, size)]
        shut = {key: _shut_away(self.rules, each.backend[0], self.names) for key, each in self.moments.items()}
        nearest = [(0.0, number, key, frozenset[str]()) for number, key in enumerate(self.moments)]
        count, known = len(nearest), set[tuple[Hashable, frozenset[str]]]()
        while nearest:
            seconds, _, key, left = heapq.heappop(nearest)
            if (key, left) in known:
                continue
            known.add((key, left))
            if left and not left & shut[key]:
                yield self.search._backend.foreseen(*self.moments[key].backend[:2]), left, seconds
            for before, took in self.before[key]:
                for more in subsets:
                    if more - shut[key] == left:
                        count += 1
                        heapq.heappush(nearest, (seconds + took, count, before, more))


def _shut_away(rules: Rules, world: WorldState, names: tuple[str, ...]) -> frozenset[str]:
    places = {name: base_place(world, name) for name in names}
    slots = {name: rules.slots[place.where] for name, place in places.items() if place.relation == "slot"}
    return frozenset(name for name, slot in slots.items() if world.fixtures[slot.fixture].door == "closed")


def above_the_truth(everything: Everything) -> tuple[int, int]:
    """For how many moments the shortest way is known, and for how many of them it is shorter than the bound says."""
    bound = ShutAway(everything.rules, everything.names)
    found = [bound._seconds(world, left) > seconds + 1e-6 for world, left, seconds in everything.truth()]
    return len(found), sum(found)


@pytest.mark.parametrize(
    ("robots", "layout", "names", "nouns", "moments"),
    [
        (1, "one_wall_large", BOTH, DOORS, 490),
        (2, "one_wall_large", ("fish",), ("fish", "cabinet"), 200),
        pytest.param(1, "one_wall_large", BOTH, (*DOORS, "plate", "bowl"), 4000, marks=pytest.mark.long),
        pytest.param(1, "galley", BOTH, (*DOORS, "counter", "sink"), 6000, marks=pytest.mark.long),
        pytest.param(2, "one_wall_large", BOTH, (*BOTH, "cabinet"), 3000, marks=pytest.mark.long),
    ],
)  # fmt: skip
def test_no_bound_is_above_the_truth(
    robots: int, layout: str, names: tuple[str, ...], nouns: tuple[str, ...], moments: int
) -> None:
    """Held against the shortest way from each moment, found without any bound."""
    looked_at, wrong = above_the_truth(Everything(kitchen(robots, layout), names, nouns))
    assert looked_at >= moments and wrong == 0


@pytest.mark.parametrize("skill", ["PICK", "PLACE", "OPEN", "CLOSE", "DRIVE"])
def test_a_bound_that_counts_too_much_is_found(skill: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(spoiling, skill, 2 * getattr(spoiling, skill))
    assert above_the_truth(Everything(kitchen(1), ("fish",), ("fish", "cabinet")))[1] > 0


def test_nobody_shuts_doors_that_move_by_themselves() -> None:
    env = kitchen(1)
    rules, all_of_it = env.start.scene, frozenset(BOTH)
    falling = replace(rules, processes=(*rules.processes, *chosen([("falling_shut", ("cabinet",))])))
    odd = replace(rules, quirks=(Quirk("swinging door", "cabinet"),))
    by_hand = ShutAway(rules, BOTH)._seconds(env.world, all_of_it)
    for other in (falling, odd):
        assert ShutAway(other, BOTH)._seconds(env.world, all_of_it) == by_hand - 2 * (spoiling.OPEN + spoiling.CLOSE)


@pytest.mark.long
def test_one_robot_has_both_behind_shut_doors_after_106_seconds_and_two_after_53() -> None:
    """It is found by whoever may take that long, and by nobody who may not."""
    for robots, seconds in ((1, 106.0), (2, 53.0)):
        env = kitchen(robots)
        found = makespan(melting_after(env.start, seconds), env.goal)
        assert (found.proof, found.seconds) == ("search", seconds)
        assert makespan(melting_after(env.start, seconds - 1.0), env.goal).proof == "exhausted"
