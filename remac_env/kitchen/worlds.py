"""Where kitchens come from: layouts, categories and vocabulary of the package and of a task, and each start."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from pathlib import Path

from remac_env.errors import OptionError, check_choice
from remac_env.kitchen import layout as layouts
from remac_env.kitchen import style as styles
from remac_env.kitchen.floor_plan import Layout
from remac_env.kitchen.objects import catalogue
from remac_env.kitchen.objects.catalogue import Category
from remac_env.kitchen.parking import for_robots
from remac_env.kitchen.starts import sample
from remac_env.kitchen.stated import stated_start
from remac_env.robots.bodies import STANDARD
from remac_env.seeding import generator
from remac_env.start import Start
from remac_env.tasks.spec import TaskSpec
from remac_env.vocabulary import Vocabulary, built_in


class Worlds:
    """The layouts and categories of the package."""

    @property
    def categories(self) -> Mapping[str, Category]:
        """The catalogue."""
        return catalogue.load()

    def layout(self, name: str, style: str) -> Layout:
        """A layout with the variants of fixtures that a style has; raises UnknownNameError."""
        return layouts.load(name, styles.load(style).models)

    def layout_of(self, start: Start) -> Layout:
        """The layout of a start, with a parking place for each of its robots."""
        return for_robots(self.layout(start.layout, start.style), len(start.scene.robots), start.body)


class TaskWorlds(Worlds):
    """Everything about a task that is the same in all its episodes, read on demand. layout: the one asked for."""

    def __init__(self, spec: TaskSpec, layout: str | None = None) -> None:
        self.spec = spec
        self._asked = layout

    def __reduce__(self) -> tuple[object, ...]:
        # What is read on demand is read again: copies and other processes get the task alone.
        return TaskWorlds, (self.spec, self._asked)

    def of(self, seed: int) -> TaskWorlds:
        """Those of the task that is played with a seed: with every seed the same."""
        return self

    @property
    def marks(self) -> tuple[str, ...]:
        """Marks that fixtures give, beside those that all kitchens know."""
        return self.spec.gives

    @cached_property
    def vocabulary(self) -> Vocabulary:
        """The built-in vocabulary, with the task's own nouns appended, and those of its layouts."""
        own = list(self.spec.nouns)
        for layout in (*self.spec.layouts, *([self._asked] if self._asked else [])):
            said = {noun.name for noun in own}
            own += [noun for noun in layouts.nouns(layout) if noun.name not in said]
        return built_in().extended(own) if own else built_in()

    @cached_property
    def categories(self) -> Mapping[str, Category]:
        """The catalogue, with the task's own categories."""
        own = {
            name: catalogue.parse(name, table, source=f"categories of {self.spec.name}")
            for name, table in self.spec.categories.items()
        }
        return {**catalogue.load(), **own}

    def layout(self, name: str, style: str) -> Layout:
        """A layout of the package or of the task, with the variants of fixtures that a style has."""
        if name in self.spec.layout_files:
            return layouts.read(Path(self.spec.layout_files[name]), styles.load(style).models)
        return super().layout(name, style)

    def check_cell(self, style: str | None, layout: str | None) -> None:
        """Raise UnknownNameError for a style or layout that does not exist; None means that the seed picks."""
        if style is not None:
            check_choice("style", style, styles.names())
        if layout is not None:
            check_choice("layout", layout, (*layouts.names(*layouts.FAMILIES), *self.spec.layout_files))

    def start(
        self,
        seed: int,
        *,
        style: str | None,
        layout: str | None,
        starts: str,
        robots: tuple[str, ...],
        perception_noise: float,
        naming: str = "role",
        knowledge: str = "full",
        body: str = STANDARD,
    ) -> tuple[Start, dict[str, str]]:
        """The start of the episode with this seed, and what the object of each role is called."""
        self.check_cell(style, layout)
        cell = generator(seed, "cell", self.spec.name)
        picks = [str(cell.choice(names)) for names in (self.spec.styles, self.spec.layouts)]
        style = style or picks[0]
        if self.spec.setup is not None:
            if layout not in (None, *self.spec.layouts):
                told = f"{self.spec.name} states its start; valid: {self.spec.layouts[0]}"
                raise OptionError(f"layout {layout!r} is not that of the task: {told}")
            room = for_robots(self.layout(layout or picks[1], style), len(robots), body)
            start, names = stated_start(
                self.spec, self.spec.setup, room, self.categories, style=style, seed=seed, robots=robots,
                perception_noise=perception_noise, knowledge=self.spec.knowledge or knowledge,
            )  # fmt: skip
            return replace(start, body=body), names
        return sample(
            self.spec,
            for_robots(self.layout(layout or picks[1], style), len(robots), body),
            self.categories,
            style=style,
            starts=starts,
            seed=seed,
            robots=robots,
            perception_noise=perception_noise,
            body=body,
            naming=naming,
            knowledge=knowledge,
        )

    def nouns(self, start: Start, names: Mapping[str, str]) -> dict[str, str]:
        """The noun of each role, as the goal sentence has it, whatever the naming."""
        if self.spec.setup is not None:
            return dict(names)
        found = {}
        for role in self.spec.roles:
            kind = self.categories[start.categories[names[role.name]]]
            called = (names[role.name], *kind.roles)
            found[role.name] = next((noun for noun in role.nouns if noun in called), names[role.name])
        return found
