"""Tasks by grade: drawn, given quirks, certified, and drawn again until one fits; never quietly another one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np

from remac_env.errors import OptionError, SamplingError, check_choice, whole_number
from remac_env.generator import templates
from remac_env.generator.certified import Certified, beyond_one, certified, scene_of, with_others
from remac_env.generator.drawing import draw
from remac_env.generator.obstacles import obstructed, untold
from remac_env.generator.quirking import with_quirks
from remac_env.generator.templates import BUILT, RICH, Template
from remac_env.options import KNOWLEDGE, MAX_ROBOTS, MOST_QUIRKS
from remac_env.oracle.witness import witness
from remac_env.seeding import SEED_MAX, generator
from remac_env.values import python_values

GRADES = {1: 6, 2: 12, 3: 20, 4: 40, 5: 80}
"""Grade -> the most rounds that its shortest known plan has without its quirks; more than those of the grade below."""

EXACT_STATES = {1: 800, 2: 800}
"""States that the search for an optimum looks at, by grade; none for those where it would give up in any case. For
more robots fewer: each costs more."""

POOLS: dict[str | None, Callable[[Template], bool]] = {
    None: lambda row: not (row.held_out or row.team or row.family),
    "held out": lambda row: row.held_out and not row.family,
    "teams": lambda row: row.team is not None and not row.family,
    "physics": lambda row: row.family == RICH and not (row.held_out or row.team),
    "physics teams": lambda row: row.family == RICH and row.team is not None,
    "built": lambda row: row.family == BUILT and not (row.held_out or row.team),
    "built held out": lambda row: row.family == BUILT and row.held_out,
    "built teams": lambda row: row.family == BUILT and row.team is not None,
}
"""What stands for several templates -> which they are."""

TRIES = 60
"""Draws until a task fits."""

LEEWAY = 2.5
"""Rounds after which an episode is truncated, as a multiple of the longest plan of its grade."""


def make(
    *,
    grade: int,
    seed: int,
    template: str | None = None,
    quirks: int = 0,
    knowledge: str = "full",
    robots: int = 1,
) -> Certified:
    """The task of these values, with its certificate; the same for the same values, everywhere.

    It is the same task for any number of robots, unless its template is for a team: one robot can do it, and the others
    wait in its plan.

    Raises:
        UnknownNameError, OptionError: for values that are not valid.
        SamplingError: saying of each template why no task of it fits.
    """
    grade, seed, template, quirks, robots = python_values([grade, seed, template, quirks, robots])
    _check(grade, quirks, knowledge, robots)
    whole_number("seed", seed, 0, SEED_MAX)
    if template is not None and not isinstance(template, str):
        check_choice("template", template, templates.load())
    return _made(grade, seed, template, quirks, knowledge, robots)


@lru_cache(maxsize=1024)
def _made(grade: int, seed: int, template: str | None, quirks: int, knowledge: str, robots: int) -> Certified:
    options = candidates(grade, template, robots)
    team = robots if any(row.team for row in options) else 1
    rng = generator(seed, "generate", grade, template, quirks, knowledge)
    why: dict[str, str] = {}
    for _ in range(TRIES):
        row = options[int(rng.integers(len(options)))]
        found = _attempt(row, grade, rng, quirks=quirks, knowledge=knowledge, robots=team)
        if not isinstance(found, str):
            found = found if team == robots else with_others(found, robots, knowledge)
            told = {"grade": grade, "seed": seed, "template": row.name, "quirks": quirks, "knowledge": knowledge,
                    "robots": robots, **found.told}  # fmt: skip
            rounds = round(LEEWAY * GRADES[grade])
            return replace(found, spec=replace(found.spec, generated=told, rounds=rounds, knowledge=knowledge))
        why[row.name] = found
    said = "; ".join(f"{name}: {reason}" for name, reason in why.items())
    raise SamplingError(f"no task of grade {grade} (seed {seed}, quirks {quirks}, robots {robots}) was found: {said}")


def _check(grade: int, quirks: int, knowledge: str, robots: int) -> None:
    check_choice("grade", grade, GRADES)
    whole_number("quirks", quirks, 0, MOST_QUIRKS)
    whole_number("robots", robots, 1, MAX_ROBOTS)
    check_choice("knowledge", knowledge, KNOWLEDGE)


@lru_cache(maxsize=64)
def candidates(grade: int, template: str | None, robots: int) -> tuple[Template, ...]:
    """The templates that a task may be drawn from."""
    if template in POOLS:
        rows = [row for row in templates.load().values() if grade in row.sizes and POOLS[template](row)]
        if not rows:
            raise OptionError(f"no template of {template!r} has tasks of grade {grade}")
    else:
        row = templates.get(str(template))
        check_choice(f"grade of template {template!r}", grade, row.sizes)
        rows = [row]
    if robots < 2 and any(row.team for row in rows):
        raise OptionError(f"template {template!r} is for a team; valid: robots=2 or more")
    return tuple(rows)


def for_team(grade: int | None, template: str | None) -> bool:
    """Whether generated tasks of this grade and template, if any are given, need two robots."""
    return template is not None and any(row.team for row in candidates(grade or min(GRADES), template, MAX_ROBOTS))


def _attempt(
    row: Template, grade: int, rng: np.random.Generator, *, quirks: int, knowledge: str, robots: int
) -> Certified | str:
    """A task that fits, or why this one does not."""
    try:
        spec = draw(row, grade, rng)
    except SamplingError as error:
        return str(error)
    scene, world = scene_of(spec, robots, knowledge)
    if spec.goal.holds(scene, world):
        return "the goal held at the start"
    if obstructed(row, grade) and not untold(scene, world, spec.goal):
        return "nothing is in its way"
    plan = witness(scene, world, spec.goal)
    if plan is None:
        return "no plan was found"
    if row.team and not beyond_one(spec):
        return "one robot may be able to do it alone"
    # A grade is that of the kitchen without its quirks, so that the same task can be had with and without them.
    plain = certified(spec, scene, world, plan, states=EXACT_STATES.get(grade, 0) // robots**3)
    if not GRADES.get(grade - 1, 0) < plain.upper <= GRADES[grade]:
        return f"its plan has {plain.upper} rounds"
    if not quirks:
        return plain
    found = with_quirks(spec, plain.plan, rng, wanted=quirks, knowledge=knowledge, robots=robots)
    if found is None:
        return f"no {quirks} quirks were found that matter and can be got round"
    spec, plan = found
    return certified(spec, *scene_of(spec, robots, knowledge), plan, states=EXACT_STATES.get(grade, 0) // robots**3)
