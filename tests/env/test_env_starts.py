"""Starts: a pure function of task, cell, kind and seed; what paper and mixed starts are like."""

from __future__ import annotations

import os
import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import remac_env
from remac_env.kitchen import layout as layouts
from remac_env.kitchen.objects import catalogue
from remac_env.kitchen.starts import INWARD_YAW
from remac_env.kitchen.worlds import TaskWorlds
from remac_env.oracle import solve
from remac_env.rules.conditions import condition
from remac_env.rules.facts import ASIDE
from remac_env.state import base_place, inside, occupant
from remac_env.tasks.goals import All, Inside, Released, SwitchedOn
from remac_env.tasks.spec import Role, TaskSpec
from remac_env.testing import check_world

TASKS = tuple(remac_env.tasks())
ROOT = Path(__file__).resolve().parents[2]

every_task = pytest.mark.parametrize("task", TASKS)
some_seeds = pytest.mark.parametrize("seeds", [range(3), pytest.param(range(3, 8), marks=pytest.mark.long)])


def make(task: str, **options: Any) -> Any:
    return remac_env.parallel_env(task, **({"backend": "symbolic"} | options))


def digest(env: Any, seed: int) -> str:
    _, infos = env.reset(seed=seed)
    return infos["robot_0"]["episode"]["digest"]


@pytest.mark.parametrize("starts", ["paper", "mixed"])
@every_task
def test_seeds_give_starts_and_nothing_else_does(task: str, starts: str) -> None:
    env, other = make(task, starts=starts), make(task, starts=starts, max_rounds=3, wording=1, text="states")
    there = [digest(env, seed) for seed in range(10)]
    back = [digest(other, seed) for seed in reversed(range(10))]
    assert there == back[::-1]
    assert len(set(there)) == 10
    assert there != [digest(make(task, starts="mixed" if starts == "paper" else "paper"), seed) for seed in range(10)]


def test_other_processes_draw_the_same_starts(tmp_path: Path) -> None:
    code = (
        "import sys, remac_env\n"
        "for task in remac_env.tasks():\n"
        "    env = remac_env.parallel_env(task, backend='symbolic', starts='mixed')\n"
        "    for seed in (3, 0, 899999):\n"
        "        sys.stdout.write(env.reset(seed=seed)[1]['robot_1']['episode']['digest'] + ' ')\n"
    )
    here = [digest(make(task, starts="mixed"), seed) for task in TASKS for seed in (3, 0, 899_999)]
    for hashes in ("2",):
        environ = os.environ | {"PYTHONHASHSEED": hashes, "PYTHONPATH": str(ROOT), "LC_ALL": "C"}
        done = subprocess.run(
            [sys.executable, "-O", "-c", code], capture_output=True, text=True, check=True, env=environ, cwd=tmp_path
        )
        assert done.stdout.split() == here


@every_task
def test_the_number_of_robots_changes_neither_things_nor_places(task: str) -> None:
    one, two = make(task, robots=1, starts="mixed"), make(task, robots=2, starts="mixed")
    for seed in range(10):
        one.reset(seed=seed)
        two.reset(seed=seed)
        assert one.world.objects == two.world.objects and one.world.fixtures == two.world.fixtures
        assert one.start.offsets == two.start.offsets and one.start.categories == two.start.categories
        assert one.start.robots["robot_0"] == two.start.robots["robot_0"]


@every_task
def test_paper_starts(task: str) -> None:
    env = make(task)
    for seed in range(30):
        env.reset(seed=seed)
        scene, world, spec = env.start.scene, env.world, env.worlds.spec
        check_world(scene, world)
        assert all(robot.station == ASIDE and robot.holding is None for robot in world.robots.values())
        assert {state.door for state in world.fixtures.values()} <= {None, "closed"}
        assert not any(state.on for state in world.fixtures.values())
        assert all(0 <= angle <= 0.02 for angle in env.start.doors.values())
        assert set(env.start.doors) == {name for name, facts in scene.fixtures.items() if facts.door}
        target = next(noun for noun in spec.roles[0].nouns if noun in world.objects)
        assert inside(scene, world, target, "counter")
        for role in spec.roles:
            noun = next(noun for noun in role.nouns if noun in world.objects)
            assert inside(scene, world, noun, role.at)
        assert not any(item.marks for item in world.objects.values())
        # Two robots can work at the same time: what the goal needs is used from stations that do not conflict.
        used = [scene.slots[base_place(world, n).where].station for n in env.goal.names() if n in world.objects]
        assert len(set(used)) == len(used)


@every_task
def test_things_lie_within_their_slots_and_categories_vary(task: str) -> None:
    env = make(task)
    seen: set[str] = set()
    for seed in range(60):
        env.reset(seed=seed)
        plan = env.worlds.layout(env.start.layout, env.start.style)
        for noun, item in env.world.objects.items():
            offset, half = env.start.offsets[noun], plan.slots[item.place.where].half
            assert abs(offset.dx) <= half[0] and abs(offset.dy) <= half[1]
        seen |= set(env.start.categories.values())
        parked = [place for place, _ in env.start.robots.values()]
        assert len(set(parked)) == 2 and set(parked) <= set(range(len(plan.asides)))
    assert len(seen) >= 5


def test_a_hand_gets_at_what_stands_in_a_cavity() -> None:
    """It straddles what it takes, so that nothing stands nearer to a side than 0.14 m, where the cavity is so wide."""
    near = 0
    for task in TASKS:
        env = make(task, starts="mixed")
        for seed in range(12):
            env.reset(seed=seed)
            plan = env.worlds.layout(env.start.layout, env.start.style)
            for noun, item in env.world.objects.items():
                slot = plan.slots.get(item.place.where)
                if slot is None or slot.kind != "cavity" or env.worlds.categories[env.start.categories[noun]].vessel:
                    continue
                aside = slot.half[0] - abs(env.start.offsets[noun].dx)
                assert aside >= min(0.14, slot.half[0]) - 1e-9, (task, seed, noun)
                near += aside < 0.16
    assert near > 5, "some stand as near to a side as they may"


def test_no_robot_has_a_fixed_parking_place() -> None:
    env = make("HeatOnStove")
    places = Counter()
    for seed in range(60):
        env.reset(seed=seed)
        places[env.start.robots["robot_0"][0]] += 1
    assert min(places[0], places[1]) > 15


def doors(env: Any) -> list[Any]:
    """The fixtures with a door that the goal does not speak of."""
    return [facts for name, facts in env.start.scene.fixtures.items() if facts.door and name not in env.goal.names()]


def slots_of_the_goal(env: Any) -> tuple[str, ...]:
    """The slots of the fixture in which the goal wants objects."""
    fixtures = env.start.scene.fixtures
    return next(fixtures[at].slots for a in env.goal.atoms() if (at := getattr(a, "container", None)) in fixtures)


def kinds(env: Any) -> set[str]:
    """What is unlike a paper start."""
    scene, world, goal = env.start.scene, env.world, env.goal
    found = {f"door {state.door}" for state in world.fixtures.values() if state.door}
    vessel = next((a.name for a in goal.atoms() if scene.objects.get(getattr(a, "name", "")) and
                   scene.objects[a.name].holds), None)  # fmt: skip
    target = next(atom.name for atom in goal.atoms() if not scene.objects[atom.name].holds)
    if vessel is not None:
        place = world.objects[vessel].place
        if scene.slots[place.where].fixture in goal.names():
            found.add("vessel in place")
        if any(item.place.where == vessel for item in world.objects.values()):
            found.add("vessel occupied")
        if world.objects[target].place.where == vessel:
            found.add("target in the vessel")
        elif scene.fixtures[scene.slots[place.where].fixture].door:
            found.add("vessel behind a door")
    first = slots_of_the_goal(env)[0]
    there = {noun for noun in scene.objects if base_place(world, noun).where == first and not scene.objects[noun].holds}
    if there - set(goal.names()):
        found.add("place taken")
    if any(state.on for state in world.fixtures.values()):
        found.add("switched on")
    fixture = scene.slots[base_place(world, target).where].fixture
    if scene.fixtures[fixture].door:
        found.add(f"target behind a door that is {world.fixtures[fixture].door}")
        assert fixture not in goal.names()
    return found or {"nothing"}


def looks_inwards(env: Any, noun: str) -> bool:
    """Whether a hand that comes in through a door finds an object lengthwise before it, if it is behind one."""
    fixture = env.start.scene.slots[base_place(env.world, noun).where].fixture
    grasp = catalogue.get(env.start.categories[noun]).grasp
    yaw = abs(env.start.offsets[noun].yaw)
    free = not env.start.scene.fixtures[fixture].door or grasp.mode != "side" or grasp.any_yaw
    return free or abs(yaw - 0.5 * np.pi) <= INWARD_YAW + 1e-9


@pytest.mark.few(3)
@every_task
def test_all_kinds_of_mixed_starts_occur(task: str) -> None:
    env = make(task, starts="mixed")
    counts: Counter[str] = Counter()
    for seed in range(150):
        env.reset(seed=seed)
        scene, world = env.start.scene, env.world
        check_world(scene, world, where=f"seed {seed}")
        assert not env.goal.holds(scene, world)
        laid = [noun for noun, state in world.objects.items() if state.place.relation == "vessel"]
        assert all(looks_inwards(env, noun) for noun in laid), f"seed {seed}"
        assert all(condition("graspable", noun).holds(scene, world) for noun in laid), f"seed {seed}"
        for name, angle in env.start.doors.items():
            door = world.fixtures[name].door
            low, high = {"closed": (0.0, 0.02), "ajar": (0.2, 0.6), "open": (0.9, 1.6)}[str(door)]
            assert low <= angle <= high, (name, door, angle)
        counts.update(kinds(env))
    wanted = ["door closed", "door ajar", "door open"]
    wanted += [f"target behind a door that is {door}" for door in ("closed", "ajar", "open")]
    if any(isinstance(atom, SwitchedOn) for atom in env.goal.atoms()):
        wanted += ["switched on"]
    vessels = [a.container for a in env.goal.atoms() if getattr(a, "container", None) in env.start.scene.objects]
    if vessels:
        wanted += ["vessel in place", "vessel occupied", "target in the vessel"]
    if any(f.kind not in env.start.scene.objects[v].too_big_for for v in vessels for f in doors(env)):
        wanted += ["vessel behind a door"]
    if len(slots_of_the_goal(env)) == 1:
        wanted += ["place taken"]
    rare = {kind: counts[kind] for kind in wanted if counts[kind] < 2}
    assert not rare, counts


@pytest.mark.long
def test_mixed_starts_are_of_all_lengths() -> None:
    """From one step before the end to puzzles of fourteen rounds and more, and everything between."""
    lengths = set()
    for task in ("OpenCabinetPnP", "DefrostInBowl", "HeatOnStove", "WashPnPHeat"):
        env = make(task, robots=1, starts="mixed")
        for seed in range(70):
            env.reset(seed=seed)
            plan = solve(env.start.scene, env.world, env.goal)
            assert plan is not None, (task, seed)
            lengths.add(plan.length)
    assert set(range(4, 15)) | {2} <= lengths, sorted(lengths)


@every_task
@some_seeds
def test_mixed_starts_can_be_solved(task: str, seeds: range) -> None:
    env = make(task, robots=1, starts="mixed")
    lengths = set()
    for seed in seeds:
        env.reset(seed=seed)
        plan = solve(env.start.scene, env.world, env.goal)
        assert plan is not None and plan.length > 0, seed
        lengths.add(plan.length)
    assert len(lengths) > 1, "all starts are the same planning problem"


@pytest.mark.long
@every_task
def test_many_mixed_starts_can_be_solved(task: str) -> None:
    for robots, count in ((1, 300), (2, 20)):
        env = make(task, robots=robots, starts="mixed")
        for seed in range(count):
            env.reset(seed=seed)
            assert solve(env.start.scene, env.world, env.goal) is not None, (robots, seed)


@every_task
def test_no_distractor_can_be_mistaken_for_what_the_goal_names(task: str) -> None:
    env = make(task, starts="mixed")
    for seed in range(60):
        env.reset(seed=seed)
        catalogue, things = env.worlds.categories, env.start.categories
        for noun, category in things.items():
            others = {name for name in things if name != noun}
            assert not others & {category, *catalogue[category].roles}, (seed, noun, things)


def test_slots_hold_one_thing() -> None:
    env = make("HeatOnStove", starts="mixed")
    for seed in range(60):
        env.reset(seed=seed)
        places = [item.place for item in env.world.objects.values()]
        assert len(set(places)) == len(places)
        for slot in env.start.scene.slots:
            obj = occupant(env.world, slot)
            assert obj is None or env.world.objects[obj].place.where == slot


@pytest.mark.few(3)
@every_task
@pytest.mark.parametrize("starts", ["mixed", "paper"])
def test_three_to_eight_distractors_stand_about(task: str, starts: str) -> None:
    """As many as are drawn, each number equally likely, and one slot in the open stays free to put objects down."""
    env = make(task, starts=starts)
    counts: Counter[int] = Counter()
    for seed in range(150):
        env.reset(seed=seed)
        scene, world = env.start.scene, env.world
        counts[len(scene.objects) - len(env.worlds.spec.roles)] += 1
        assert any(occupant(world, slot) is None for slot in scene.fixtures["counter"].slots), seed
    assert set(counts) == set(range(3, 9)) and min(counts.values()) >= 8, counts


@pytest.mark.parametrize("layout", layouts.names())
@pytest.mark.parametrize("tasks", [TASKS[:2], pytest.param(TASKS[2:], marks=pytest.mark.long)], ids=["two", "others"])
def test_every_layout_has_room_for_all_distractors(layout: str, tasks: tuple[str, ...]) -> None:
    for task in tasks:
        env = make(task, layout=layout)
        counts = set()
        for seed in range(40):
            env.reset(seed=seed)
            counts.add(len(env.start.scene.objects) - len(env.worlds.spec.roles))
        assert {3, 8} <= counts <= set(range(3, 9)), (task, counts)


def test_small_kitchens_have_fewer_distractors() -> None:
    """A kitchen from outside with few slots: as many as there is room for."""
    small = TaskSpec(
        name="FewSlots",
        wordings=("place the {food} into the pantry",) * 3,
        goal=All(Inside("{food}", "pantry"), Released("{food}")),
        roles=(Role("food", ("vegetable",), at="bench"),),
        fixtures=("bench", "pantry"),
        layouts=("scullery",),
        layout_files={"scullery": str(ROOT / "tests" / "data" / "galley_for_tests.toml")},
    )
    for seed in range(10):
        start, _ = TaskWorlds(small).start(
            seed, style=None, layout=None, starts="paper", robots=("robot_0",), perception_noise=0.0
        )
        assert len(start.scene.objects) == 3, "the vegetable, two others, and one of four slots free"


@every_task
@some_seeds
def test_namings_are_one_start_in_other_words(task: str, seeds: range) -> None:
    """By category an object goes by what it is; the sentence keeps the noun, and the goal knows the object."""
    plain, named = make(task, robots=1), make(task, robots=1, naming="category")
    for seed in seeds:
        _, told = plain.reset(seed=seed)
        _, infos = named.reset(seed=seed)
        assert infos["robot_0"]["goal"] == told["robot_0"]["goal"]
        assert list(plain.start.categories.values()) == list(named.start.categories.values())
        assert all(noun == category for noun, category in named.start.categories.items())
        assert set(named.goal.names()) <= {*named.start.scene.fixtures, *named.start.scene.objects}
        one = solve(plain.start.scene, plain.world, plain.goal)
        other = solve(named.start.scene, named.world, named.goal)
        assert one is not None and other is not None and one.length == other.length


@every_task
def test_targets_suit_their_task(task: str) -> None:
    env = make(task)
    seen = set()
    for seed in range(60):
        env.reset(seed=seed)
        role, noun = env.worlds.spec.roles[0], env.goal.names()[0]
        category = env.worlds.categories[env.start.categories[noun]]
        assert category.attributes >= set(role.needs)
        seen.add(category.name)
    assert len(seen) > 3, seen


@pytest.mark.parametrize("layout", ["one_wall_large", "galley"])
def test_what_is_too_big_for_its_place_is_not_drawn(layout: str) -> None:
    """A drumstick is meat that freezes, and does not go into a microwave: the next that does takes its place."""
    task = remac_env.parallel_env("FrozenInTime", backend="symbolic", clock="events", starts="paper", layout=layout)
    drawn = set()
    for seed in range(10):
        task.reset(seed=seed)
        rules = task.start.scene
        for atom in task.goal.atoms():
            if isinstance(atom, Inside):
                assert rules.fixtures[atom.container].kind not in rules.objects[atom.name].too_big_for
        drawn.add(rules.objects["meat"].category)
    assert "drumstick" not in drawn and len(drawn) > 1
    defrost = remac_env.parallel_env("DefrostInBowl", backend="symbolic", starts="paper", layout=layout)
    kinds = {defrost.reset(seed=seed) and defrost.start.categories.get("meat") for seed in range(40)}
    assert "drumstick" in kinds, "where it goes in, it is drawn as before"
