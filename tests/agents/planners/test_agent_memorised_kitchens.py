"""What the floor `memorised` knows of generated tasks: one plan a template and number of objects."""

from __future__ import annotations

from remac_agents.planners.memorised import _generated, clauses, denoted, recalled
from remac_env.generator import make, scene_of, templates
from remac_env.rules.scene import public_scene

KNOWN = (
    ("put every mug into the chest", 1, ("pick up {0}",)),
    ("put every mug into the chest", 2, ("pick up {0}", "pick up {1}")),
    ("put every mug into the chest, leave the lamp off", 1, ("turn off lamp",)),
)


def test_the_longest_sentence_counts_and_then_the_number_of_objects() -> None:
    assert recalled(KNOWN, "put every mug into the chest", 1) == ("pick up {0}",)
    assert recalled(KNOWN, "put every mug into the chest", 5) == ("pick up {0}", "pick up {1}")
    assert recalled(KNOWN, clauses("put every mug into the chest and leave the lamp off"), 2) == ("turn off lamp",)
    assert recalled(KNOWN, "leave the lamp off, put every mug into the chest", 2) == ("turn off lamp",)
    assert recalled(KNOWN, "dry every mug", 2) == () and recalled(KNOWN, "put every mug into the chest", 0) == ()


def test_words_for_kinds_mean_the_objects_of_the_kitchen() -> None:
    task = make(grade=2, seed=5, template="fruit into the pantry")
    scene, _ = scene_of(task.spec, 1, "full")
    meant = denoted(task.spec.wordings[2], public_scene(scene))
    assert set(meant) == {name for name in task.spec.goal.names() if name in scene.objects}


def test_nothing_is_known_of_templates_that_are_held_out() -> None:
    known = {said for said, _, _ in _generated()}
    rows = [row for row in templates.load().values() if row.held_out and not row.family]
    goals = [clauses(row.goal_of({group.kind: ("one",) for group in row.groups}).told(3)) for row in rows]
    assert known and not [goal for goal in goals if goal in known]
