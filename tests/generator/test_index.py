"""The index of certified tasks says what is made again from grade and seed."""

from __future__ import annotations

import pytest

from remac_env.generator import GRADES, index, make, templates

SAMPLE = [0, 1, 333, 450, 801]


def same(entry: index.Entry) -> bool:
    """Whether what is made now is what the index says."""
    task = make(grade=entry.grade, seed=entry.seed)
    told = {**task.told, "template": task.spec.generated["template"]}
    return all(getattr(entry, name) == value for name, value in told.items())


def test_the_index_holds_a_thousand_tasks_of_all_grades() -> None:
    entries = index.load()
    assert len(entries) >= 1000 and {entry.grade for entry in entries} == set(GRADES)
    assert all(GRADES.get(e.grade - 1, 0) < e.upper <= GRADES[e.grade] and e.lower <= e.upper for e in entries)
    assert not any(templates.get(entry.template).held_out for entry in entries)
    assert len({entry.problem for entry in entries}) > 800


@pytest.mark.parametrize("at", SAMPLE)
def test_a_task_of_the_index_is_made_again(at: int) -> None:
    assert same(index.load()[at])


@pytest.mark.long
def test_every_tenth_task_of_the_index_is_made_again() -> None:
    assert [entry for entry in index.load()[::10] if not same(entry)] == []
