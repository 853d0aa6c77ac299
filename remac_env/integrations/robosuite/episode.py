"""One episode as robosuite needs it: which start, and what is in it. Knows nothing of robosuite."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any

from remac_env.errors import OptionError
from remac_env.kitchen.layout import Layout
from remac_env.kitchen.objects.catalogue import Category
from remac_env.kitchen.worlds import TaskWorlds
from remac_env.start import Start
from remac_env.tasks.goals import Goal

WORDING = 3  # of the sentence that comes with an episode: the simplest


@dataclass(frozen=True)
class Cell:
    """What an episode is drawn from: its seed, options of `remac_env.parallel_env`, and how many robots there are."""

    seed: int
    style: str | None
    layout: str | None
    starts: str
    naming: str
    robots: int


@dataclass(frozen=True)
class Episode:
    """A start with its layout, its objects (name -> category), the name of each role's object, goal and sentence."""

    cell: Cell
    start: Start
    layout: Layout
    objects: Mapping[str, Category]
    roles: Mapping[str, str]
    goal: Goal
    sentence: str

    @property
    def facts(self) -> dict[str, Any]:
        """What a recording keeps, JSON-able: enough to draw the very same start again, and which one it was."""
        return {**asdict(self.cell), "start": self.start.digest}


def draw(worlds: TaskWorlds, cell: Cell) -> Episode:
    """The episode of a cell: a pure function of the task and the cell.

    Raises:
        UnknownNameError: for an unknown style, layout, kind of start or naming.
        SamplingError: if the kitchen has no room for what the task needs.
    """
    start, roles = worlds.start(
        cell.seed, style=cell.style, layout=cell.layout, starts=cell.starts, naming=cell.naming, perception_noise=0.0,
        robots=tuple(f"robot_{index}" for index in range(cell.robots)),
    )  # fmt: skip
    spec = worlds.spec
    return Episode(
        cell=cell,
        start=start,
        layout=worlds.layout_of(start),
        objects={name: worlds.categories[category] for name, category in start.categories.items()},
        roles=roles,
        goal=spec.goal.bind(roles),
        sentence=spec.sentence(WORDING, worlds.nouns(start, roles)),
    )


def redraw(worlds: TaskWorlds, facts: Mapping[str, Any], robots: int) -> Episode:
    """The episode whose `facts` a recording has kept, for an environment with so many robots.

    Raises:
        OptionError: if these are not an episode's facts, it has another number of robots, or its start is another one
            today, so that recorded states would not fit.
    """
    cell = {name: value for name, value in facts.items() if name != "start"}
    if set(cell) != {field.name for field in fields(Cell)}:
        raise OptionError(f"these are not the facts of a recorded episode: {dict(facts)!r}")
    if cell["robots"] != robots:
        raise OptionError(f"this recording has {cell['robots']} robots, and this environment {robots}")
    episode = draw(worlds, Cell(**cell))
    if facts.get("start") != episode.start.digest:
        raise OptionError(
            f"this recording is of the start {facts.get('start')}, but seed {cell['seed']} of {worlds.spec.name} is "
            f"now {episode.start.digest}: it was made with another version of this package or for another task"
        )
    return episode
