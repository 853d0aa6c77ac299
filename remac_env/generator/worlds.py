"""The kitchens of the task Generated: with every seed those of another task."""

from __future__ import annotations

from functools import cached_property

from remac_env.errors import OptionError
from remac_env.generator import pools, templates
from remac_env.generator.making import candidates, make
from remac_env.generator.templates import built_name
from remac_env.kitchen import layout as layouts
from remac_env.kitchen.worlds import TaskWorlds
from remac_env.options import Options
from remac_env.quoting import quoted
from remac_env.robots import bodies
from remac_env.rules.marks import COOLED, DRIED, HEATED
from remac_env.rules.quirks import QUIRKS
from remac_env.tasks.generated import SPEC
from remac_env.tasks.spec import TaskSpec
from remac_env.vocabulary import Vocabulary, built_in

DEFAULT_GRADE = 1


class GeneratedWorlds(TaskWorlds):
    """Draws a task for every seed, from the options that say of which sort. All have one vocabulary."""

    def __init__(self, options: Options) -> None:
        super().__init__(SPEC)
        self._options = options

    def __reduce__(self) -> tuple[object, ...]:
        return GeneratedWorlds, (self._options,)

    @cached_property
    def vocabulary(self) -> Vocabulary:
        """The built-in vocabulary, with the words of all generated tasks appended, and those of their floor plans."""
        options = self._options
        rows = candidates(options.grade or DEFAULT_GRADE, options.template, options.robots)
        plans = {name: None for row in rows if row.family for name in layouts.names(row.family)}
        own = {noun.name: noun for noun in pools.nouns()}
        further = {noun.name: noun for name in plans for noun in layouts.nouns(name) if noun.name not in own}
        return built_in().extended((*own.values(), *further.values()))

    @property
    def marks(self) -> tuple[str, ...]:
        """Those that any generated task may ask for."""
        return (HEATED, COOLED, DRIED)

    def of(self, seed: int) -> TaskWorlds:
        """The kitchens of the task of a seed."""
        options = self._options
        drawn = make(
            grade=options.grade or DEFAULT_GRADE,
            seed=seed,
            template=options.template,
            quirks=options.quirks,
            knowledge=options.knowledge,
            robots=options.robots,
        )
        check_backend(drawn.spec, options)
        worlds = TaskWorlds(drawn.spec)
        worlds.__dict__["vocabulary"] = self.vocabulary  # the same one, not built again
        return worlds


def worlds_for(spec: TaskSpec, options: Options) -> TaskWorlds:
    """Where the kitchens of a task come from.

    Raises:
        OptionError: for options of generated tasks with another task, or a task that physics cannot have.
    """
    if spec.name == SPEC.name and spec.setup is None:
        return _checked(GeneratedWorlds(options), options)
    for name in ("grade", "template", "quirks"):
        if value := getattr(options, name):
            given = f"{name}={quoted(value)} is for task {SPEC.name!r}"
            raise OptionError(f"{given}; {spec.name} states its own (`TaskSpec`)")
    check_backend(spec, options)
    return _checked(TaskWorlds(spec, options.layout), options)


def _checked(worlds: TaskWorlds, options: Options) -> TaskWorlds:
    worlds.check_cell(options.style, options.layout)
    bodies.get(options.body)
    return worlds


def check_backend(spec: TaskSpec, options: Options) -> None:
    """Raise OptionError for a kitchen with something in it that only the skill table knows, or that has no room."""
    if spec.symbolic_only and options.backend != "symbolic":
        pool = "physics teams" if any(QUIRKS[quirk.kind].team for quirk in spec.quirks) else "physics"
        lacks = "for which physics has no shape and no place in a floor plan; only the skill table knows them"
        valid = f"backend='symbolic', or template={pool!r} for a task without"
        if (twin := built_name(spec.generated.get("template", ""))) in templates.load():
            valid += f", or template={twin!r} for one where they are built"
        raise OptionError(f"task {spec.name} has {spec.symbolic_only}, {lacks}; valid: {valid}")
    if spec.setup is not None and options.backend != "symbolic":
        slots = {place.where: noun for noun, place in spec.setup.places.items() if place.relation == "slot"}
        for quirk in (quirk for quirk in spec.quirks if QUIRKS[quirk.kind].fills):
            if held := [noun for where, noun in slots.items() if where.partition(".")[0] == quirk.about]:
                said = f"the {held[0]} is in the {quirk.about}, which is to be full ({quirk.kind}) from the start"
                raise OptionError(f"task {spec.name}: {said}; valid: an empty one, or backend='symbolic'")
