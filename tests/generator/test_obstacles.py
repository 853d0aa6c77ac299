"""From grade 3 on something is in the way of a task that no sentence tells, and whoever reads the goal alone fails."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import remac_env
from remac_env.generator import make, scene_of, templates
from remac_env.generator.drawing import draw
from remac_env.generator.making import candidates
from remac_env.generator.obstacles import ANY_ORDER, obstructed, put_back, untold
from remac_env.rules.knowledge import in_view
from remac_env.rules.rounds import transition
from remac_env.state import Place, base_place
from remac_env.tasks.goals import DoorIs, Inside


@pytest.mark.few(2)
@pytest.mark.parametrize("grade", [3, 4, 5])
def test_something_is_in_the_way_and_the_plan_gets_round_it(grade: int) -> None:
    task = make(grade=grade, seed=3)
    assert task.untold >= 1 and task.spec.generated["untold"] == task.untold
    scene, world = scene_of(task.spec, 1, "full")
    for joint in task.plan.rounds:
        world, _ = transition(scene, world, joint)
    assert task.spec.goal.holds(scene, world)


def test_it_is_counted_by_what_has_to_be_done_about_it() -> None:
    spec = remac_env.generate(1, 0, template="fruit into the pantry")
    scene, world = scene_of(spec, 1, "full")
    (noun,) = [name for name in spec.goal.names() if name in scene.objects]
    shut = next(slot for slot, facts in scene.slots.items() if facts.fixture == "pantry")
    assert untold(scene, world, Inside(noun, "trolley")) == 0
    place = replace(world.objects[noun].place, relation="slot", where=shut)
    behind = world.with_object(noun, place=place).with_fixture("pantry", door="closed")
    assert untold(scene, behind, Inside(noun, "trolley")) == 1


def test_in_grade_5_the_sentence_is_in_no_order_of_work_and_says_so() -> None:
    spec = make(grade=5, seed=4).spec
    assert all(told.endswith(ANY_ORDER) for told in spec.wordings)
    assert spec.wordings[2] != spec.goal.told(3) + ANY_ORDER
    assert sorted(clauses(spec.wordings[2].removesuffix(ANY_ORDER))) == sorted(clauses(spec.goal.told(3)))
    assert make(grade=4, seed=4).spec.wordings[2] == make(grade=4, seed=4).spec.goal.told(3)


@pytest.mark.long
@pytest.mark.parametrize("grade", [4, 5])
def test_a_sentence_does_not_tell_behind_which_doors_things_are(grade: int) -> None:
    """Of doors that are to be shut again some hide nothing, and what is to be put back stands in the open."""
    named = hiding = kept = 0
    for seed in range(24):
        spec = make(grade=grade, seed=seed).spec
        scene, world = scene_of(spec, 1, "seen")
        unseen = {scene.slots[base_place(world, n).where].fixture for n in set(world.objects) - in_view(scene, world)}
        doors = [goal.fixture for goal in spec.goal.atoms() if isinstance(goal, DoorIs) and goal.door == "closed"]
        doors = [name for name in doors if scene.fixtures[name].slots and not scene.fixtures[name].switches]
        named, hiding = named + len(doors), hiding + sum(name in unseen for name in doors)
        for goal in spec.goal.atoms():
            if isinstance(goal, Inside) and goal.holds(scene, world):
                kept += 1
                assert goal.name not in unseen and not scene.fixtures[goal.container].door
    assert 0 < hiding < named and (kept > 0) == (grade == 5)


def clauses(said: str) -> list[str]:
    return said.replace(" and ", ", ").split(", ")


def test_what_fills_a_fixture_that_gives_a_mark_is_to_be_back_there_in_grade_5() -> None:
    template, scene = templates.get("washed vegetables"), scene_of(make(grade=5, seed=0).spec, 1, "full")[0]
    there = {"tea": Place("slot", scene.fixtures["sink"].slots[0]), "juice": Place("slot", "counter.0")}
    rng = np.random.default_rng(0)
    assert put_back(scene, there, template, 5, rng) == [{"keep": "tea", "into": "sink"}]
    assert put_back(scene, there, template, 4, rng) == []


def test_teams_and_kitchens_of_physics_have_none_and_draw_as_ever() -> None:
    rows = templates.load().values()
    assert not any(obstructed(row, 5) for row in rows if row.team or row.family)
    assert not any(obstructed(row, 2) for row in rows) and any(obstructed(row, 3) for row in rows)


@pytest.mark.long
def test_every_template_of_these_grades_can_have_something_in_its_way() -> None:
    without = []
    for grade in (3, 4, 5):
        for row in candidates(grade, None, 1):
            found = 0
            for seed in range(12):
                try:
                    spec = draw(row, grade, np.random.default_rng(seed))
                except remac_env.errors.SamplingError:
                    continue
                found += untold(*scene_of(spec, 1, "full"), spec.goal) > 0
            without += [(row.name, grade)] if not found else []
    assert without == []
