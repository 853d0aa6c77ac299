"""Quirks of kitchens: each has its way, shows in the condition that its row names, and has the remedy that it names."""

from __future__ import annotations

from dataclasses import replace

import pytest
from plain_kitchens import kitchen, play

from remac_env.errors import UnknownNameError
from remac_env.oracle import certify
from remac_env.rules.conditions import condition
from remac_env.rules.facts import Quirk
from remac_env.rules.quirks import QUIRKS, QuirkKind, laid_out, sentence_of
from remac_env.rules.rounds import transition
from remac_env.rules.subtasks import Subtask
from remac_env.state import FrozenMap, Place, occupant
from remac_env.tasks.goals import All, DoorIs, Inside, Marked, Released, SwitchedOn

FETCH = "navigate to {0}, pick up {0}, navigate to {1}, place to {1}"
PAN_ON = FETCH.format("pan", "stove")
CASES = {
    "jammed door": ("cabinet", "", "navigate to cabinet, open cabinet door", "open cabinet door", ("cabinet",)),
    "stuck object": ("carrot", "", "navigate to carrot, pick up carrot", "pick up carrot", ("robot_0", "carrot")),
    "cold burner": ("stove.0", "", f"{PAN_ON}, turn on stove", "", ("stove",)),
    "dead switch": ("stove", "", f"{PAN_ON}, turn on stove", "", ("stove",)),
    "enabling switch": (
        "stove", "faucet", "navigate to stove, turn on stove",
        "navigate to faucet, turn on faucet, navigate to stove, turn on stove", ("stove",),
    ),
    "guard door": (
        "stove", "cabinet", "navigate to cabinet, open cabinet door, navigate to stove, turn on stove",
        "navigate to cabinet, close cabinet door, navigate to stove, turn on stove", ("stove",),
    ),
    "fuse": (
        "faucet", "stove", "navigate to stove, turn on stove, navigate to faucet, turn on faucet",
        "navigate to stove, turn on stove", ("stove",),
    ),
    "spring switch": (
        "faucet", "", "navigate to faucet, turn on faucet, navigate aside", "navigate to faucet, turn on faucet, wait",
        ("faucet",),
    ),
    "falling door": ("cabinet", "", "navigate to cabinet, open cabinet door, navigate aside", "", ("cabinet",)),
    "swinging door": (
        "cabinet", "", "navigate to cabinet, open cabinet door, close cabinet door, navigate aside",
        "navigate to cabinet, open cabinet door, close cabinet door, wait", ("cabinet",),
    ),
    "full shelf": (
        "cabinet", "", f"navigate to cabinet, open cabinet door, {FETCH.format('carrot', 'cabinet')}", "",
        ("carrot", "cabinet"),
    ),
    "hot vessel": (
        "stove", "", f"{PAN_ON}, turn on stove, pick up pan", "turn off stove, pick up pan", ("robot_0", "pan"),
    ),
    "dirty vessel": (
        "plate", "", f"{FETCH.format('carrot', 'sink')}, turn on faucet, {FETCH.format('carrot', 'plate')}",
        "", ("carrot", "washed"),
    ),
    "two hands": ("stove", "microwave", "navigate to stove, turn on stove", "", ("stove",)),
    "narrow galley": ("cabinet", "counter", "navigate to stove, navigate to cabinet", "", ("robot_0", "cabinet")),
}  # fmt: skip


def test_there_are_ten_kinds_or_more_and_each_has_a_case() -> None:
    assert len(QUIRKS) >= 10 and set(CASES) == set(QUIRKS)


@pytest.mark.parametrize("kind", CASES)
def test_a_quirk_shows_in_its_condition_and_nowhere_without_it(kind: str) -> None:
    about, other, plan, remedy, names = CASES[kind]
    shown = condition(QUIRKS[kind].shows, *names)
    plain, world = kitchen()
    without, _ = play(plain, world, plan)
    assert shown.holds(plain, without)
    scene, _ = kitchen(Quirk(kind, about, other))
    after, ends = play(scene, world, plan)
    assert not shown.holds(scene, after), sentence_of(scene.quirks[0])
    if QUIRKS[kind].hinders:
        assert not ends[-1]
    if remedy:
        mended, _ = play(scene, after, remedy)
        assert shown.holds(scene, mended), QUIRKS[kind].remedy


@pytest.mark.parametrize(
    ("kind", "plan"),
    [("", "open microwave door"), ("jammed door", "open microwave door"), ("swinging door", "navigate aside")],
)
def test_what_runs_only_shut_stops_whatever_opens_its_door(kind: str, plan: str) -> None:
    scene, world = kitchen(*([Quirk(kind, "microwave")] if kind else []))
    world = world.with_fixture("microwave", door="closed", on=frozenset({"microwave"}))
    after, _ = play(scene, world.with_robot("robot_0", station="microwave"), plan)
    assert after.fixtures["microwave"].door == ("ajar" if kind else "open") and not after.fixtures["microwave"].on


def test_what_it_takes_two_robots_for_they_can_do_together() -> None:
    scene, world = kitchen(Quirk("falling door", "cabinet"), robots=2)
    way = "navigate to carrot, pick up carrot, navigate to carrot, navigate to carrot, navigate to cabinet"
    after, _ = play(scene, world, way, other="navigate to cabinet, open cabinet door, wait, navigate aside, wait")
    assert after.fixtures["cabinet"].door == "closed"  # it fell before the other one came
    scene, world = kitchen(Quirk("two hands", "stove", "microwave"), robots=2)
    after, ends = play(scene, world, "navigate to stove, turn on stove", other="navigate to microwave, wait")
    assert ends[-1] and after.fixtures["stove"].on


def test_over_a_counter_that_nobody_gets_past_things_are_passed() -> None:
    scene, world = kitchen(Quirk("narrow galley", "cabinet", "counter"), robots=2)
    scene = laid_out(scene)
    assert scene.fixtures["cabinet"].station in scene.stations_of("counter")
    way = "navigate to stove, navigate to carrot, pick up carrot, place to counter"
    after, ends = play(scene, world, way, other="navigate to cabinet, open cabinet door, navigate to stove")
    assert all(ends) and after.robots["robot_1"].station == scene.fixtures["cabinet"].station
    after, _ = play(scene, after, "wait, wait", other="pick up carrot, place to cabinet")
    assert after.objects["carrot"].place.where.startswith("cabinet")
    stays, ends = play(scene, after, "navigate aside")
    assert not ends[0] and stays.robots["robot_0"].station == after.robots["robot_0"].station


def test_both_sides_put_something_down_at_once() -> None:
    scene, world = kitchen(Quirk("narrow galley", "cabinet", "counter"), robots=2)
    scene = laid_out(scene)
    at = {"robot_0": scene.fixtures["counter"].station, "robot_1": scene.fixtures["cabinet"].station}
    for (robot, station), name in zip(at.items(), ("carrot", "apple"), strict=True):
        world = world.with_robot(robot, station=station, holding=name)
        world = world.with_object(name, place=Place("held", robot))
    after, ends = play(scene, world, "place to counter", other="place to counter")
    assert ends[0] and after.robots["robot_1"].holding is None
    assert after.objects["carrot"].place != after.objects["apple"].place


def test_two_robots_on_two_sides_do_not_put_two_things_into_one_slot() -> None:
    scene, world = kitchen(Quirk("narrow galley", "cabinet", "counter"), robots=2)
    scene = laid_out(scene)
    counter = scene.fixtures["counter"]
    free, *others = (name for name in counter.slots if occupant(world, name) is None)
    scene = replace(scene, slots=FrozenMap({n: s for n, s in scene.slots.items() if n not in others}))
    scene = replace(scene, fixtures=scene.fixtures.with_("counter", replace(counter, slots=(free,))))
    sides = zip(scene.robots, ("carrot", "apple"), scene.slots[free].stations, strict=True)
    for robot, name, station in sides:
        world = world.with_object(name, place=Place("held", robot)).with_robot(robot, station=station, holding=name)
    both = dict.fromkeys(scene.robots, Subtask("place to", "counter"))
    after, outcomes = transition(scene, world, both)
    assert after == world and {outcome.reason for outcome in outcomes.values()} == {"station_occupied"}


@pytest.mark.parametrize("kind", ["cold burner", "enabling switch", "hot vessel", "jammed door", "spring switch"])
def test_the_search_gets_round_a_quirk_and_needs_more_rounds(kind: str) -> None:
    about, other, *_ = CASES[kind]
    goal = {
        "jammed door": All(Inside("carrot", "cabinet"), Released("carrot")),
        "hot vessel": All(Marked("carrot", "heated"), Inside("pan", "counter"), Released("carrot")),
    }.get(kind, All(Inside("pan", "stove"), SwitchedOn("stove", under="pan"), Released("pan")))
    about = "stove" if kind == "spring switch" else about
    if kind == "spring switch":
        goal = All(goal, DoorIs("microwave", "open"))
    plain, world = kitchen(gives={"stove": "heated"})
    scene, _ = kitchen(Quirk(kind, about, other), gives={"stove": "heated"})
    if kind == "hot vessel":
        food = world.with_object("pan", place=Place("slot", "stove.0"))
        world = food.with_object("carrot", place=Place("vessel", "pan"))
    first, second = (certify(each, world, goal, max_rounds=20) for each in (plain, scene))
    assert first.optimum is not None and second.optimum is not None
    assert second.optimum > first.optimum or kind in ("hot vessel", "spring switch")
    assert second.plan is not None
    state = world
    for joint in second.plan.rounds:
        state, _ = transition(scene, state, joint)
    assert goal.holds(scene, state)


def test_a_row_that_shows_in_no_condition_is_refused() -> None:
    with pytest.raises(UnknownNameError, match="shows"):
        QuirkKind(name="ghost", sentence="{0}", shows="haunted", looks="", remedy="", draws=lambda rules: iter(()))


def test_who_is_not_given_the_truth_is_given_the_kitchen_without_quirks() -> None:
    scene, _ = kitchen(Quirk("dead switch", "stove"))
    plain, _ = kitchen()
    assert scene.without_quirks == plain and plain.without_quirks is plain


def test_marks_are_given_by_fixtures_at_work_alone() -> None:
    scene, world = kitchen(gives={"stove": "heated", "microwave": "heated"})
    after, _ = play(scene, world, f"{FETCH.format('carrot', 'stove')}, turn on stove")
    assert "heated" not in after.objects["carrot"].marks  # it lies on the flame itself
    after, _ = play(scene, world, f"{PAN_ON}, {FETCH.format('carrot', 'pan')}, turn on stove")
    assert "heated" in after.objects["carrot"].marks and "heated" in after.objects["pan"].marks
    bare, world = kitchen()
    after, _ = play(bare, world, f"{PAN_ON}, {FETCH.format('carrot', 'pan')}, turn on stove")
    assert not after.objects["carrot"].marks
