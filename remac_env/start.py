"""One exact start of an episode, as data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from remac_env.rules.facts import Rules
from remac_env.seeding import digest
from remac_env.state import WorldState


@dataclass(frozen=True, slots=True)
class Offset:
    """A pose relative to the middle of a slot, vessel or parking place: `dx`, `dy` m, `yaw` rad, in the world frame."""

    dx: float = 0.0
    dy: float = 0.0
    yaw: float = 0.0


@dataclass(frozen=True)
class Start:
    """One exact start of an episode, complete enough for either backend.

    Attributes:
        scene, world: the symbolic facts and their state.
        layout, style: names of the kitchen's files.
        categories: noun -> category of every object ("vegetable" -> "carrot").
        offsets: noun -> pose relative to its slot or vessel.
        robots: robot -> (index of its parking place in the layout, offset from it).
        doors: fixture -> door angle, rad.
        seed: the episode's seed; further generators are named from it.
        perception_noise: standard deviation of the poses that controllers see, m.
        body: of all robots, by name.
    """

    scene: Rules
    world: WorldState
    layout: str
    style: str
    categories: Mapping[str, str]
    offsets: Mapping[str, Offset]
    robots: Mapping[str, tuple[int, Offset]]
    doors: Mapping[str, float]
    seed: int
    perception_noise: float = 0.0
    body: str = "panda"

    @cached_property
    def digest(self) -> str:
        """A name for this start that is the same on every platform (figures rounded to 1e-6)."""

        def rounded(offset: Offset) -> list[float]:
            return [round(float(v), 6) + 0.0 for v in (offset.dx, offset.dy, offset.yaw)]

        objects = {
            name: [self.categories[name], state.place.relation, state.place.where, *rounded(self.offsets[name])]
            for name, state in self.world.objects.items()
        }
        fixtures = {
            name: [state.door, sorted(state.on), round(self.doors.get(name, 0.0), 6)]
            for name, state in self.world.fixtures.items()
        }
        robots = {name: [place, *rounded(offset)] for name, (place, offset) in self.robots.items()}
        other = [] if self.body == "panda" else [self.body]
        return digest([self.layout, self.style, objects, fixtures, robots, round(self.perception_noise, 6), *other])
