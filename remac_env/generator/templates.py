"""Templates of generated tasks, read from templates.toml, and the goals that their clauses make."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from importlib import resources
from typing import Any

from remac_env.errors import KitchenFileError, check_choice
from remac_env.kitchen import annexes
from remac_env.kitchen import layout as layouts
from remac_env.rules.facts import Quirk
from remac_env.rules.quirks import QUIRKS
from remac_env.state import Door
from remac_env.tasks.compound import EACH, AnyOf, Before, Count, ForAll, Not
from remac_env.tasks.goals import All, DoorIs, Goal, Inside, Marked, Released, SwitchedOn

FILE = "templates.toml"

RICH, BUILT = "rich", "built"
"""The folders of layouts with more than the usual fixtures, and with annexes, so that physics can have them."""

HIDDEN = "hidden"
"""Where objects are that stand behind a shut door that the goal does not name."""

Clause = Mapping[str, Any]
Members = Mapping[str, Sequence[str]]
"""Kind -> the objects of it in one kitchen."""


@dataclass(frozen=True, kw_only=True)
class Group:
    """The objects of one kind: where they are at the start, and how many, 0 where that goes by the grade."""

    kind: str
    at: tuple[str, ...]
    n: int = 0


@dataclass(frozen=True, kw_only=True)
class Template:
    """One row; templates.toml says what stands in it."""

    name: str
    hides: str
    sizes: Mapping[int, tuple[int, int]]
    groups: tuple[Group, ...]
    goal: tuple[Clause, ...]
    annexes: tuple[str, ...] = ()
    family: str = ""
    doors: Mapping[str, Door] = field(default_factory=dict)
    on: tuple[str, ...] = ()
    held_out: bool = False
    team: Quirk | None = None

    @property
    def gives(self) -> tuple[str, ...]:
        """The marks that its clauses ask for."""
        marks = [mark for clause in self.goal for mark in (*clause.get("order", ()), clause.get("mark"))]
        return tuple(dict.fromkeys(mark for mark in marks if mark))

    @property
    def orders(self) -> tuple[tuple[str, str], ...]:
        """The pairs of marks of whose order its clauses speak."""
        return tuple(dict.fromkeys((first, then) for first, then in (c["order"] for c in self.goal if "order" in c)))

    @property
    def named(self) -> frozenset[str]:
        """The fixtures and kinds that its clauses name."""
        words: list[str] = []
        for clause in self.goal:
            for value in clause.values():
                words += [value] if isinstance(value, str) else value if isinstance(value, list) else []
        return frozenset(words)

    def goal_of(self, members: Members, clauses: Sequence[Clause] = ()) -> Goal:
        """Its goal for these objects; of these clauses where they are not its own alone."""
        goals = [_clause(clause, members) for clause in clauses or self.goal]
        held = [Released(name) for group in self.groups for name in members[group.kind]]
        return All(*goals, *held)


def _clause(clause: Clause, members: Members) -> Goal:
    for key, make in _OF_FIXTURES.items():
        if key in clause:
            return make(clause[key])
    if "keep" in clause:
        return Inside(clause["keep"], clause["into"])
    kind = clause.get("all") or clause["some"]
    each = _each(clause)
    if "all" in clause:
        return ForAll(kind, each, tuple(members[kind]))
    return Count(kind, each, tuple(members[kind]), least=clause["least"])


_OF_FIXTURES: dict[str, Callable[[str], Goal]] = {
    "on": SwitchedOn,
    "off": lambda name: Not(SwitchedOn(name)),
    "shut": lambda name: DoorIs(name, "closed"),
    "opened": lambda name: DoorIs(name, "open"),
}


def _each(clause: Clause) -> Goal:
    one = f"{{{EACH}}}"
    if "mark" in clause:
        return Marked(one, clause["mark"])
    if "order" in clause:
        return Before(one, *clause["order"])
    if "out" in clause:
        return Not(Inside(one, clause["out"]))
    into = clause["into"]
    return Inside(one, into) if isinstance(into, str) else AnyOf(*(Inside(one, name) for name in into))


@cache
def load() -> Mapping[str, Template]:
    """Every template by its name, in the order of the file; then those with annexes once more, where they are built."""
    text = resources.files("remac_env.generator").joinpath(FILE).read_text("utf-8")
    table = tomllib.loads(text)
    rows = [parse(row) for row in table["template"]]
    twins = [twin for row in rows if (twin := _built(row, table["built"].get(row.name, {})))]
    return {row.name: row for row in (*rows, *twins)}


def _built(row: Template, where: Mapping[str, Any]) -> Template | None:
    """The same template in a kitchen that has its annexes; None where there is no such kitchen, or no room in it."""
    across = row.team is not None and QUIRKS[row.team.kind].across
    family = str(where.get("family", BUILT))
    own = {int(grade): (int(span[0]), int(span[1])) for grade, span in where.items() if grade != "family"}
    sizes = {grade: span for grade, span in {**row.sizes, **own}.items() if span[0] <= span[1]}
    if not row.annexes or across or not sizes:
        return None
    return replace(row, name=built_name(row.name), annexes=(), family=family, sizes=sizes)


def built_name(name: str) -> str:
    """What a template is called that is set where its annexes are built."""
    return f"{name} ({BUILT})"


def get(name: str) -> Template:
    """A template by its name; raises UnknownNameError."""
    check_choice("template", name, load())
    return load()[name]


def parse(row: Mapping[str, Any]) -> Template:
    """A template from its table.

    Raises:
        KitchenFileError: for keys that there are not, or a clause that says nothing.
    """
    name = str(row.get("name", "?"))
    try:
        sizes = {int(grade): (int(least), int(most)) for grade, (least, most) in row["sizes"].items()}
        groups = tuple(Group(kind=kind, **{**g, "at": tuple(g["at"])}) for kind, g in row["groups"].items())
        lists: dict[str, Any] = {key: tuple(row[key]) for key in ("annexes", "on", "goal") if key in row}
        team = Quirk(**row["team"]) if "team" in row else None
        rest = {key: row[key] for key in row if key not in ("sizes", "groups", "team", *lists)}
        template = Template(sizes=sizes, groups=groups, team=team, **lists, **rest)
        check_choice("family", template.family, layouts.FAMILIES)
        template.goal_of({group.kind: ("one",) for group in groups})
        if missing := (template.named & annexes.load().keys()) - set(template.annexes):
            raise ValueError(f"annexes lacks {', '.join(sorted(missing))}")
    except (KeyError, TypeError, ValueError) as error:
        where, valid = f"template {name!r}", ("what the head of the file says",)
        raise KitchenFileError(FILE, where, f"cannot be read ({error!r})", valid) from error
    return template
