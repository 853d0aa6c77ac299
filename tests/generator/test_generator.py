"""Generated tasks: the same for the same values, solvable by construction, quirky where they say so, refused aloud."""

from __future__ import annotations

from dataclasses import replace

import pytest

import remac_env
from remac_env.errors import KitchenFileError, OptionError, SamplingError, UnknownNameError
from remac_env.generator import GRADES, make, scene_of, templates
from remac_env.generator.making import candidates
from remac_env.kitchen import annexes
from remac_env.oracle import solvable
from remac_env.rules.facts import Quirk
from remac_env.rules.quirks import QUIRKS
from remac_env.rules.rounds import transition
from remac_env.tasks.goals import progress
from remac_env.vocabulary import built_in

ROWS = templates.load()
LEAST = [
    pytest.param(name, min(row.sizes), marks=[pytest.mark.long] if at % 8 else [])
    for at, (name, row) in enumerate(ROWS.items())
    if not row.team
]


def played(task: object, robots: int, knowledge: str = "full") -> float:
    """The progress that a task's plan makes by the table."""
    scene, world = scene_of(task.spec, robots, knowledge)  # type: ignore[attr-defined]
    for joint in task.plan.rounds:  # type: ignore[attr-defined]
        world, _ = transition(scene, world, joint)
    return progress(task.spec.goal, scene, world)  # type: ignore[attr-defined]


@pytest.mark.parametrize(("name", "grade"), LEAST)
def test_every_template_gives_a_task_whose_plan_reaches_its_goal(name: str, grade: int) -> None:
    task = make(grade=grade, seed=1, template=name)
    scene, world = scene_of(task.spec, 1, "full")
    assert not task.spec.goal.holds(scene, world)
    assert played(task, 1) == 1.0
    assert task.lower <= task.upper and (task.proof == "witness" or task.lower == task.upper)
    assert GRADES.get(grade - 1, 0) < task.upper <= GRADES[grade] or task.spec.quirks
    assert all(sentence == sentence.strip(" .") and "{" not in sentence for sentence in task.spec.wordings)


def test_the_same_values_make_the_same_task_and_others_another() -> None:
    one, same = (remac_env.generate(2, 5, quirks=1, knowledge="seen") for _ in range(2))
    assert one == same
    assert remac_env.generate(2, 6, quirks=1, knowledge="seen") != one


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_plan_that_knows_of_no_quirk_fails_for_each_of_them(seed: int) -> None:
    task = make(grade=2, seed=seed, quirks=2)
    assert len({quirk.kind for quirk in task.spec.quirks}) == 2 and task.hidden == 2
    assert played(task, 1) == 1.0
    plain = make_plain(task.spec)
    for quirk in task.spec.quirks:
        scene, world = scene_of(replace(task.spec, quirks=(quirk,)), 1, "full")
        for joint in plain:
            world, _ = transition(scene, world, joint)
        assert not task.spec.goal.holds(scene, world), quirk


def make_plain(spec: remac_env.registry.TaskSpec) -> list[dict[str, object]]:
    """A shortest plan in the kitchen without quirks."""
    from remac_env.oracle import solve

    scene, world = scene_of(replace(spec, quirks=()), 1, "full")
    plan = solve(scene, world, spec.goal)
    assert plan is not None
    return list(plan.rounds)  # type: ignore[arg-type]


def test_what_cannot_be_made_is_said_of_each_template() -> None:
    with pytest.raises(SamplingError, match="lights out"):
        make(grade=1, seed=0, template="lights out", quirks=3)
    with pytest.raises(UnknownNameError, match="grade of template 'lights out'"):
        make(grade=5, seed=0, template="lights out")
    with pytest.raises(UnknownNameError, match="fruit into the pantry"):
        make(grade=1, seed=0, template="fruit into the moon")
    with pytest.raises(OptionError, match="robots=2"):
        make(grade=2, seed=0, template="teams")
    with pytest.raises(OptionError, match="quirks"):
        make(grade=2, seed=0, quirks=9)


def test_templates_of_the_pools_do_not_overlap() -> None:
    drawn = {pool: {row.name for row in candidates(2, pool, 2)} for pool in (None, "held out", "teams")}
    assert all(ROWS[name].held_out for name in drawn["held out"])
    assert all(ROWS[name].team for name in drawn["teams"])
    assert not any(ROWS[name].held_out or ROWS[name].team for name in drawn[None])
    assert len(ROWS) >= 60 and sum(row.held_out for row in ROWS.values()) >= 15
    assert make(grade=2, seed=0, template="held out").spec.generated["template"] in drawn["held out"]


TEAMS = [name for name, row in ROWS.items() if row.team]


@pytest.mark.few(2)
@pytest.mark.parametrize("name", ["dishwasher for two", *(name for name in TEAMS if name != "dishwasher for two")])
def test_a_task_for_a_team_has_no_plan_for_one_and_one_for_two(name: str) -> None:
    task = make(grade=min(ROWS[name].sizes), seed=0, template=name, robots=2)
    assert QUIRKS[task.spec.quirks[0].kind].team
    scene, world = scene_of(task.spec, 1, "full")
    assert solvable(scene, world, task.spec.goal, max_states=20_000) is False
    assert played(task, 2) == 1.0


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"goal": [{"all": "fruit", "inside": "pantry"}]}, "into"),
        ({"goal": [{"all": "mug", "into": "pantry"}]}, "mug"),
        ({"annexes": []}, "annexes lacks pantry"),
        ({"colour": "red"}, "colour"),
    ],
)
def test_a_template_that_cannot_be_read_is_refused(change: dict[str, object], told: str) -> None:
    row = {"name": "bad", "hides": "-", "sizes": {"1": [1, 1]}, "groups": {"fruit": {"at": ["counter"]}},
           "annexes": ["pantry"], "goal": [{"all": "fruit", "into": "pantry"}]}  # fmt: skip
    templates.parse(row)
    with pytest.raises(KitchenFileError, match=told):
        templates.parse({**row, **change})


def test_built_in_tokens_stay_where_they_are() -> None:
    env = remac_env.parallel_env("Generated", robots=1, backend="symbolic")
    assert [env.vocabulary.decode(t) for t in range(len(built_in()))] == [
        built_in().decode(t) for t in range(len(built_in()))
    ]
    assert {"open pantry door", "pick up red mug", "turn on grill"} <= {
        env.vocabulary.decode(t) for t in range(len(env.vocabulary))
    }
    assert set(annexes.load()) <= set(env._facts.fixtures)


def test_the_task_generated_is_the_generated_task() -> None:
    env = remac_env.parallel_env("Generated", robots=1, backend="symbolic", grade=2, quirks=1)
    _, infos = env.reset(seed=4)
    spec = remac_env.generate(2, 4, quirks=1)
    assert env.goal == spec.goal and env.start.scene.quirks == spec.quirks
    assert infos["robot_0"]["goal"] == spec.wordings[2]
    again = remac_env.parallel_env(spec, robots=1, backend="symbolic")
    again.reset(seed=11)
    assert again.world == env.world
    for joint in make(grade=2, seed=4, quirks=1).plan.rounds:
        _, rewards, *_ = env.step({robot: env.vocabulary.encode(s.text) for robot, s in joint.items()})
    assert rewards["robot_0"] == 1.0 and not env.agents


def test_physics_and_other_tasks_refuse_what_they_have_not() -> None:
    with pytest.raises(OptionError, match=r"annexes.*backend='symbolic'"):
        remac_env.parallel_env(remac_env.generate(1, 0), robots=1)
    with pytest.raises(OptionError, match="quirks=1 is for task 'Generated'"):
        remac_env.parallel_env("HeatOnStove", backend="symbolic", quirks=1)
    with pytest.raises(OptionError, match="is that of the tasks"):
        remac_env.register_task(remac_env.generate(1, 0))


def test_quirks_of_ones_own_are_part_of_a_task() -> None:
    spec = remac_env.generate(1, 0, template="fruit into the pantry")
    assert spec.setup is not None
    spec = replace(spec, quirks=(Quirk("jammed door", "pantry"),), setup=replace(spec.setup, doors={}))
    env = remac_env.parallel_env(spec, robots=1, backend="symbolic")
    env.reset(seed=0)
    for text, succeeds in (("navigate to pantry", True), ("open pantry door", False), ("open pantry door", True)):
        *_, infos = env.step({"robot_0": env.vocabulary.encode(text)})
        assert (infos["robot_0"]["outcome"]["status"] == "success") == succeeds
