"""What a task is: a declaration that general code reads. The tasks of the suite are the other files of this folder."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from remac_env.errors import OptionError
from remac_env.options import WORDINGS
from remac_env.quoting import quoted
from remac_env.rules.facts import Quirk
from remac_env.rules.quirks import QUIRKS
from remac_env.tasks.goals import GOAL, Goal
from remac_env.tasks.setup import Setup
from remac_env.tasks.shape import (
    ANY,
    NAME,
    SECONDS,
    SWITCH,
    TEXT,
    WHOLE,
    Shape,
    check_fields,
    one_of,
    optional,
    pair,
    several,
    table,
)
from remac_env.values import python_fields

if TYPE_CHECKING:
    from remac_env.vocabulary import Noun


def _is_noun(value: object) -> bool:
    from remac_env.vocabulary import Noun

    return isinstance(value, Noun)


_TEXTS = several(TEXT)
_ROLE = {"name": NAME, "nouns": several(NAME, least=1), "at": NAME, "needs": _TEXTS}
"""Field -> what it has to be."""


@dataclass(frozen=True)
class Role:
    """An object the task needs. One of `nouns` is drawn; its category plays the noun's role in the catalogue.

    `name` is what wordings and goals call it, in braces. `at` names the fixture in whose slots it stands at the
    start. `needs` are attributes that its category must have (`catalogue.Attribute`).
    """

    name: str
    nouns: tuple[str, ...]
    at: str = "counter"
    needs: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Take values of NumPy as Python's, and refuse fields of another shape: OptionError."""
        python_fields(self)
        check_fields(self, _ROLE, "role")


_TASK = {
    "name": TEXT,
    "wordings": several(TEXT, least=3, most=3),
    "goal": GOAL,
    "roles": several(one_of(Role, "a Role")),
    **dict.fromkeys(("fixtures", "styles", "layouts", "annexes", "gives"), _TEXTS),
    "verbs": table(_TEXTS),
    "in_table": SWITCH,
    "phases": several(pair(TEXT, GOAL)),
    "processes": several(pair(TEXT, _TEXTS)),
    "deadline": optional(SECONDS),
    "distractors": pair(WHOLE, WHOLE),
    "nouns": several(Shape("a remac_env.vocabulary.Noun", _is_noun)),
    "categories": table(one_of(Mapping, "tables")),
    "layout_files": table(one_of((str, PurePath), "paths")),
    "quirks": several(one_of(Quirk, "a remac_env.rules.quirks.Quirk")),
    "orders": several(pair(TEXT, TEXT)),
    "setup": optional(one_of(Setup, "a Setup")),
    "rounds": optional(WHOLE),
    "knowledge": optional(TEXT),
    "generated": table(ANY),
}
"""Field -> what it has to be."""


@dataclass(frozen=True)
class TaskSpec:
    """A task by declaration.

    Attributes:
        name: CamelCase id, part of the Gymnasium id.
        wordings: the goal sentence in three wordings, with `{role}` fields.
        goal: the terminal goal, with `{role}` fields.
        roles: the objects it needs.
        fixtures: names of the fixtures it needs.
        verbs: goal verb -> commands that the verb itself implies once the object is in place ("heat": the burner).
            Public data: planners are told.
        styles, layouts: the task's rows of the style table.
        in_table: whether it belongs to the suite's table of 27 task styles.
        phases: (name, goal) in order, for tasks that are scored by phases: one counts once its goal has held after the
            one before it.
        processes: what takes its time by itself, by the names of `remac_env/rules/processes.toml`, each with what it is
            about (`{role}` fields; everything that it can be about where empty). Such a task needs the event clock.
        deadline: s after which it is too late, None where only the episode's own end counts.
        distractors: how many other objects stand about, (least, most), as far as there is room: one slot in the open
            stays free.
        nouns: words that the built-in vocabulary lacks.
        categories: further object categories, in the form of the catalogue's tables.
        layout_files: layout name -> path of a TOML file, for kitchens from outside.
        annexes: further fixtures, of kitchen/annexes.toml; symbolic only.
        quirks: facts about this kitchen that nobody is told (`remac_env.rules.quirks`).
        gives: the marks that fixtures of this kitchen give (heated, cooled, dried), beside washed.
        orders: pairs of marks, (first, then), whose order a goal speaks of (`Before`).
        setup: the start, where it is stated and not drawn.
        rounds: rounds after which an episode is truncated, where the task needs more than `Options.max_rounds`.
        knowledge: what robots know at the start, in place of `Options.knowledge`; with a setup only.
        generated: what it was generated from (grade, template, seed ...), for those that were.
    """

    name: str
    wordings: tuple[str, str, str]
    goal: Goal
    roles: tuple[Role, ...]
    fixtures: tuple[str, ...]
    verbs: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    styles: tuple[str, ...] = ("modern_1",)
    layouts: tuple[str, ...] = ("one_wall_large",)
    in_table: bool = False
    phases: tuple[tuple[str, Goal], ...] = ()
    processes: tuple[tuple[str, tuple[str, ...]], ...] = ()
    deadline: float | None = None
    distractors: tuple[int, int] = (3, 8)
    nouns: tuple[Noun, ...] = ()
    categories: Mapping[str, Mapping[str, object]] = field(default_factory=dict)
    layout_files: Mapping[str, str] = field(default_factory=dict)
    annexes: tuple[str, ...] = ()
    quirks: tuple[Quirk, ...] = ()
    gives: tuple[str, ...] = ()
    orders: tuple[tuple[str, str], ...] = ()
    setup: Setup | None = None
    rounds: int | None = None
    knowledge: str | None = None
    generated: Mapping[str, Any] = field(default_factory=dict)

    @property
    def symbolic_only(self) -> str:
        """Why physics cannot have it, "" where it can."""
        plans = [quirk.kind for quirk in self.quirks if QUIRKS[quirk.kind].across]
        return f"annexes ({', '.join(self.annexes)})" if self.annexes else ", ".join(plans)

    def __post_init__(self) -> None:
        """Take values of NumPy as Python's, and refuse fields of another shape: OptionError."""
        python_fields(self)
        check_fields(self, _TASK, f"task {quoted(self.name)}")
        for name in _TASK:
            if isinstance(value := getattr(self, name), list):
                object.__setattr__(self, name, tuple(value))

    @property
    def timed(self) -> bool:
        """Whether it can be played by the event clock alone."""
        return bool(self.processes) or self.deadline is not None

    def sentence(self, wording: int, nouns: Mapping[str, str]) -> str:
        """The goal sentence in wording 1, 2 or 3, with the noun of each role.

        Raises:
            OptionError: if there is no such wording.
        """
        if wording not in WORDINGS:
            raise OptionError(f"wording {wording!r} is not valid; valid: {', '.join(map(str, WORDINGS))}")
        return self.wordings[wording - 1].format(**nouns)
