"""How many rounds a goal still needs at least: what makes the search exact and quick.

Two bounds, of which the larger counts: the longest chain of steps that must follow one another for one part of the
goal, and the steps that all parts need together, shared out evenly among the robots. Both leave out whatever is not
certain, so that neither is ever above the truth; tests hold them against searches without any bound.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

from remac_env.oracle.commands import to_mark
from remac_env.rules.facts import Rules
from remac_env.rules.marks import SEASONED, WASHED
from remac_env.rules.places import stations_of
from remac_env.state import WorldState, contents, inside, supports
from remac_env.tasks.compound import AnyOf, Before, Count
from remac_env.tasks.goals import DoorIs, Goal, Inside, Marked, SwitchedOn

IMPOSSIBLE = 1_000_000
"""The bound of a world from which no plan leads to the goal: what must be moved lies on the floor."""


def make_bound(scene: Rules, goal: Goal) -> Callable[[WorldState], int]:
    """A function from a world to rounds that the goal needs from there at least."""
    needs = _Needs(scene, goal)
    return needs.at_least


class _Needs:
    """What one goal needs in one kitchen; what does not change is looked up once."""

    def __init__(self, scene: Rules, goal: Goal) -> None:
        self._scene, self._atoms = scene, tuple(goal.atoms())
        self._to_wash = frozenset(to_mark(goal, WASHED))
        self._basins = tuple(basin for facts in scene.fixtures.values() for basin in facts.wets)
        self._shakers = tuple(name for name, facts in scene.objects.items() if facts.seasons)

    def at_least(self, world: WorldState) -> int:
        """The larger of the two bounds; 0 where the goal holds."""
        missing = [atom for atom in self._atoms if not atom.holds(self._scene, world)]
        if not missing:
            return 0
        longest = max(self._chain(world, atom) for atom in missing)
        return longest if longest >= IMPOSSIBLE else max(longest, self._shared(world, missing))

    # -- one after the other ---------------------------------------------------------------------------------

    def _chain(self, world: WorldState, atom: Goal) -> int:
        if isinstance(atom, Inside):
            return self._carrying(world, atom)
        if isinstance(atom, Marked) and atom.mark == WASHED:
            return self._washing(world, atom.name)
        if isinstance(atom, Marked) and atom.mark == SEASONED:
            return self._seasoning(world, atom.name)
        if isinstance(atom, SwitchedOn):
            shut = not self._scene.fixtures[atom.fixture].shut_to_run or world.fixtures[atom.fixture].door == "closed"
            return self._approach(world, self._scene.stations_of(atom.fixture)) + (1 if shut else 2)
        if isinstance(atom, DoorIs):
            return 1 + self._approach(world, self._scene.stations_of(atom.fixture))
        if isinstance(atom, Marked):
            return self._giving(world, atom.name, atom.mark)
        return self._compound(world, atom)

    def _compound(self, world: WorldState, goal: Goal) -> int:
        """Of several ways the shortest; of so many of a kind, as long as the last of the nearest."""
        if isinstance(goal, AnyOf):
            return min(self._whole(world, part) for part in goal.goals)
        if isinstance(goal, Count):
            parts = sorted(self._whole(world, part) for part in goal.parts)
            return parts[goal.least - 1] if goal.least <= len(parts) else IMPOSSIBLE
        if isinstance(goal, Before):
            return IMPOSSIBLE if goal.beyond(self._scene, world) else 1
        return 1

    def _whole(self, world: WorldState, goal: Goal) -> int:
        """Of all atoms of a part that are missing, the longest."""
        missing = [atom for atom in goal.atoms() if not atom.holds(self._scene, world)]
        return max((self._chain(world, atom) for atom in missing), default=0)

    def _giving(self, world: WorldState, name: str, mark: str) -> int:
        """Rounds until a fixture has left its mark on an object."""
        givers = [facts for facts in self._scene.givers if facts.gives == mark]
        around = supports(self._scene, world, name)
        if not givers or any(facts.name in around for facts in givers):
            return 1
        if not around or around[-1] not in self._scene.fixtures:
            held = any(world.robots[robot].holding in (name, *around) for robot in self._scene.robots)
            return 1 if held else IMPOSSIBLE
        return 2 if any(world.objects[other].place.relation == "vessel" for other in (name,)) else 3

    def _carrying(self, world: WorldState, atom: Inside) -> int:
        after = self._closing(atom.container)
        if atom.name in self._to_wash and WASHED not in world.objects[atom.name].marks:
            return self._washing(world, atom.name) + self._from_basin(world, atom.container) + after
        if (robot := self._bearer(world, atom.name)) is not None:
            stands = world.robots[robot].station in stations_of(self._scene, world, atom.container)
            return (1 if stands else 2) + after
        taken = self._taking(world, atom.name)
        return taken + self._way(world, atom.name, atom.container) + 1 + after

    def _taking(self, world: WorldState, name: str) -> int:
        """Rounds until somebody holds an object that lies somewhere."""
        around = supports(self._scene, world, name)
        if not around or around[-1] not in self._scene.fixtures:
            return IMPOSSIBLE  # what lies on the floor stays there
        door = world.fixtures[around[-1]].door
        stations = stations_of(self._scene, world, name)
        return self._approach(world, stations) + (door not in (None, "open")) + bool(contents(world, name)) + 1

    def _washing(self, world: WorldState, name: str) -> int:
        """Rounds until water has run on an object."""
        if any(inside(self._scene, world, name, basin) for basin in self._basins):
            return 1
        if (robot := self._bearer(world, name)) is not None:
            at = world.robots[robot].station
            return 1 if any(at in stations_of(self._scene, world, basin) for basin in self._basins) else 2
        ways = (self._way(world, name, basin) for basin in self._basins)
        return self._taking(world, name) + min(ways, default=IMPOSSIBLE) + 1

    def _bearer(self, world: WorldState, name: str) -> str | None:
        """Who has an object in hand, or the vessel that it is in, which may be put down with it."""
        carried = (name, *supports(self._scene, world, name))
        return next((robot for robot in self._scene.robots if world.robots[robot].holding in carried), None)

    def _from_basin(self, world: WorldState, container: str) -> int:
        """Rounds from the basin into a container, which may be the basin or stand in it."""
        if container in self._basins or container in self._scene.objects:
            return 0
        basins = {station for basin in self._basins for station in self._scene.stations_of(basin)}
        return 2 if basins & set(self._scene.stations_of(container)) else 3

    def _seasoning(self, world: WorldState, name: str) -> int:
        """Rounds until a shaker was shaken over an object."""
        there = stations_of(self._scene, world, name)
        holders = [state for state in world.robots.values() if state.holding in self._shakers]
        if any(state.station in there for state in holders):
            return 1
        return 2  # it goes there, or a shaker is taken up by one who stands there

    def _closing(self, container: str) -> int:
        """Rounds that are left once the last object has gone into a container: its door was open then."""
        facts = self._scene.fixtures.get(container)
        if facts is None or not facts.door or len(self._scene.stations_of(container)) > 1:
            return 0  # from two stations, putting in and closing may fall into one round
        rest = [atom for atom in self._atoms if isinstance(atom, SwitchedOn | DoorIs) and atom.fixture == container]
        runs = any(isinstance(atom, SwitchedOn) for atom in rest) and facts.shut_to_run
        shut = any(isinstance(atom, DoorIs) and atom.door == "closed" for atom in rest)
        return 2 if runs else int(shut)

    def _approach(self, world: WorldState, stations: Iterable[str]) -> int:
        """1 where somebody has to come to one of these stations first."""
        here = {state.station for state in world.robots.values()}
        return int(here.isdisjoint(stations))

    def _way(self, world: WorldState, name: str, container: str) -> int:
        """1 where an object and its container are not used from one station; a container may yet be carried there."""
        if container in self._scene.objects:
            return 0
        first = stations_of(self._scene, world, name)
        return int(set(first).isdisjoint(self._scene.stations_of(container)))

    # -- all together ----------------------------------------------------------------------------------------

    def _shared(self, world: WorldState, missing: list[Goal]) -> int:
        """The steps of all parts that are missing, each step counted once, over the number of robots."""
        steps = 0
        doors: set[str] = set()
        bearers: set[str] = set()
        for name, container in self._to_move(world, missing).items():
            bearer = self._bearer(world, name)
            # What is in a vessel in hand goes with it, all at once.
            steps += 2 + self._way(world, name, container) if bearer is None else bearer not in bearers
            bearers.update(() if bearer is None else (bearer,))
            around = supports(self._scene, world, name) if bearer is None else []
            doors.update(other for other in (*around, container) if other in self._scene.fixtures)
        steps += sum(world.fixtures[name].door not in (None, "open") for name in doors)
        for atom in missing:
            if isinstance(atom, SwitchedOn):
                steps += not atom.under or not world.fixtures[atom.fixture].on
            elif isinstance(atom, DoorIs):
                steps += atom.door == "closed" or atom.fixture not in doors
            elif isinstance(atom, Marked) and atom.mark == SEASONED:
                steps += 1
        return math.ceil(steps / len(self._scene.robots))

    def _to_move(self, world: WorldState, missing: list[Goal]) -> dict[str, str]:
        """Object -> one container into which it has yet to go."""
        wanted: dict[str, str] = {}
        for atom in missing:
            if isinstance(atom, Inside) and world.objects[atom.name].place.relation != "floor":
                wanted.setdefault(atom.name, atom.container)
        return wanted
