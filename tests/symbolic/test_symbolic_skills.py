"""The skill table, row by row: each false condition has the one result that the design says."""

from __future__ import annotations

import pytest
from table_kitchen import A, TableKitchen

from remac_env.rules.claims import first_false
from remac_env.rules.facts import ASIDE
from remac_env.rules.outcomes import REASONS
from remac_env.rules.predicates import PREDICATES
from remac_env.rules.skills import SKILLS
from remac_env.rules.subtasks import Subtask
from remac_env.state import FLOOR, Place

AT_STATION = ("navigate to", "navigate aside", "wait", "done")


@pytest.fixture
def kitchen() -> TableKitchen:
    return TableKitchen()


def refused(kitchen: TableKitchen, command: str, reason: str) -> None:
    """The command fails for this reason, and nothing changes."""
    before = kitchen.world
    kitchen.run(**{A: command})
    assert kitchen.reason() == reason
    assert kitchen.world == before


@pytest.mark.parametrize(
    ("command", "holding"),
    [
        ("pick up vegetable", None),
        ("place to counter", "fish"),
        ("place to bowl", "fish"),
        ("open cabinet door", None),
        ("close cabinet door", None),
        ("turn on faucet", None),
        ("turn off stove", None),
        ("season vegetable", "seasoning"),
    ],
)
@pytest.mark.parametrize("station", [ASIDE, "fridge"])
def test_away_from_the_station_it_is_declined(
    kitchen: TableKitchen, command: str, holding: str | None, station: str
) -> None:
    kitchen.stand(A, station)
    if holding:
        kitchen.hold(A, holding)
    refused(kitchen, command, "not_at_station")


def test_wait_and_done_change_nothing(kitchen: TableKitchen) -> None:
    before = kitchen.world
    for command in ("wait", "done"):
        assert kitchen.run(**{A: command}).reason() is None
        assert kitchen.world == before


# -- going ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("target", "station"),
    [("faucet", "sink"), ("sink", "sink"), ("pan", "counter_right"), ("plate", "cabinet"), ("counter", "counter_mid")],
)
def test_navigate_ends_at_the_station_of_its_target(kitchen: TableKitchen, target: str, station: str) -> None:
    kitchen.run(**{A: f"navigate to {target}"})
    assert kitchen.reason() is None
    assert kitchen.world.robots[A].station == station


def test_navigate_to_the_counter_keeps_the_own_end_of_it(kitchen: TableKitchen) -> None:
    """Unless that end is full: pan, fish and seasoning fill the right one."""
    assert kitchen.stand(A, "counter_right").run(**{A: "navigate to counter"}).world.robots[A].station == "counter_mid"
    kitchen.put("fish", "sink.0").stand(A, "counter_right").run(**{A: "navigate to counter"})
    assert kitchen.world.robots[A].station == "counter_right"


def test_navigate_aside(kitchen: TableKitchen) -> None:
    assert kitchen.stand(A, "sink").run(**{A: "navigate aside"}).world.robots[A].station == ASIDE


def test_what_is_held_or_on_the_floor_cannot_be_reached(kitchen: TableKitchen) -> None:
    kitchen.stand("robot_1", "sink").hold("robot_1", "vegetable").stand(A, "counter_mid")
    refused(kitchen, "navigate to vegetable", "unreachable")
    refused(kitchen, "pick up vegetable", "unreachable")
    kitchen.world = kitchen.world.with_object("fish", place=FLOOR)
    refused(kitchen, "navigate to fish", "unreachable")
    refused(kitchen, "pick up fish", "unreachable")
    refused(kitchen.hold(A, "seasoning"), "season fish", "unreachable")
    kitchen.world = kitchen.world.with_object("bowl", place=FLOOR)
    refused(kitchen, "place to bowl", "unreachable")


def test_where_another_robot_stands_is_not_free(kitchen: TableKitchen) -> None:
    navigate = Subtask("navigate to", "sink")
    assert first_false(kitchen.scene, kitchen.world, A, navigate, "refuse") is None
    kitchen.stand("robot_1", "sink")
    false = first_false(kitchen.scene, kitchen.world, A, navigate, "refuse")
    assert false is not None and false.reason == "station_occupied"
    refused(kitchen, "navigate to sink", "station_occupied")


# -- picking up -----------------------------------------------------------------------------------------------------


def test_pick_up(kitchen: TableKitchen) -> None:
    kitchen.stand(A, "counter_mid").run(**{A: "pick up vegetable"})
    assert kitchen.reason() is None
    assert kitchen.world.robots[A].holding == "vegetable"
    assert kitchen.place("vegetable") == Place("held", A)


def test_pick_up_with_a_full_hand(kitchen: TableKitchen) -> None:
    refused(kitchen.stand(A, "counter_mid").hold(A, "fish"), "pick up vegetable", "hands_full")


def test_a_loaded_vessel_is_not_lifted(kitchen: TableKitchen) -> None:
    refused(kitchen.stand(A, "counter_mid").put("vegetable", "bowl"), "pick up bowl", "loaded")
    assert kitchen.run(**{A: "pick up vegetable"}).reason() is None
    assert kitchen.run(**{A: "place to counter"}).run(**{A: "pick up bowl"}).reason() is None


@pytest.mark.parametrize("door", ["closed", "ajar"])
def test_a_door_that_is_not_open_keeps_things_in_and_out(kitchen: TableKitchen, door: str) -> None:
    kitchen.stand(A, "cabinet").door("cabinet", door)
    refused(kitchen, "pick up plate", "door_closed")
    kitchen.hold(A, "vegetable")
    for target in ("cabinet", "plate"):
        refused(kitchen, f"place to {target}", "door_closed")
        assert kitchen.world.robots[A].holding == "vegetable"
    kitchen.put("plate", "counter.2").put("vegetable", "cabinet.0").hold(A, "seasoning")
    refused(kitchen, "season vegetable", "door_closed")


# -- putting down ---------------------------------------------------------------------------------------------------


def test_place_to_a_fixture_fills_a_free_slot_at_hand(kitchen: TableKitchen) -> None:
    kitchen.stand(A, "counter_mid").hold(A, "fish").run(**{A: "place to counter"})
    assert kitchen.reason() is None
    assert kitchen.place("fish") == Place("slot", "counter.2")
    assert kitchen.world.robots[A].holding is None


def test_place_without_anything(kitchen: TableKitchen) -> None:
    refused(kitchen.stand(A, "counter_mid"), "place to counter", "hands_empty")


def test_place_where_there_is_no_room(kitchen: TableKitchen) -> None:
    kitchen.stand(A, "cabinet").door("cabinet", "open").put("vegetable", "plate").hold(A, "fish")
    refused(kitchen, "place to cabinet", "blocked")
    refused(kitchen, "place to plate", "blocked")
    kitchen.stand(A, "counter_right").put("bowl", "counter.3")
    # A vessel that stands there might take it, but does not take another vessel.
    refused(kitchen.put("vegetable", "pan").put("fish", "bowl").hold(A, "plate"), "place to counter", "blocked")


def test_what_fills_the_only_slot_takes_the_thing_if_it_is_a_vessel(kitchen: TableKitchen) -> None:
    kitchen.stand(A, "cabinet").door("cabinet", "open").hold(A, "vegetable").run(**{A: "place to cabinet"})
    assert kitchen.reason() is None
    assert kitchen.place("vegetable") == Place("vessel", "plate")
    free = TableKitchen().put("plate", "counter.2").stand(A, "cabinet").door("cabinet", "open").hold(A, "vegetable")
    assert free.run(**{A: "place to cabinet"}).place("vegetable") == Place("slot", "cabinet.0")


def test_vessels_and_standing_things_do_not_go_into_vessels(kitchen: TableKitchen) -> None:
    kitchen.stand(A, "counter_mid").hold(A, "pan")
    refused(kitchen, "place to bowl", "blocked")
    kitchen.put("pan", "stove.0").hold(A, "seasoning")
    refused(kitchen, "place to bowl", "blocked")


def test_what_is_wrong_but_possible_is_not_stopped(kitchen: TableKitchen) -> None:
    """Fish belongs into a bowl in the sink: `advise` is for checks, nothing physical enforces it."""
    kitchen.stand(A, "sink").hold(A, "fish")
    assert kitchen.false(A, "place to sink") == [("advise", "no_vessel_needed")]
    assert kitchen.run(**{A: "place to sink"}).reason() is None
    assert kitchen.place("fish") == Place("slot", "sink.0")
    for obj, target in (("vegetable", "sink"), ("bowl", "sink"), ("fish", "stove"), ("pan", "stove")):
        assert TableKitchen().stand(A, target).hold(A, obj).false(A, f"place to {target}") == [], (obj, target)
    raw = TableKitchen().stand(A, "stove").hold(A, "vegetable")
    assert raw.false(A, "place to stove") == [("advise", "no_vessel_needed")]


def test_a_pan_goes_onto_the_lit_burner(kitchen: TableKitchen) -> None:
    kitchen.stand(A, "stove").hold(A, "pan").on("stove", "stove.2").run(**{A: "place to stove"})
    assert kitchen.place("pan") == Place("slot", "stove.2")


# -- doors and switches ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("before", ["closed", "ajar"])
def test_open_door(kitchen: TableKitchen, before: str) -> None:
    kitchen.stand(A, "cabinet").door("cabinet", before).run(**{A: "open cabinet door"})
    assert kitchen.reason() is None
    assert kitchen.world.fixtures["cabinet"].door == "open"
    refused(kitchen, "open cabinet door", "already_done")


@pytest.mark.parametrize("before", ["open", "ajar"])
def test_close_door(kitchen: TableKitchen, before: str) -> None:
    kitchen.stand(A, "microwave").door("microwave", before).run(**{A: "close microwave door"})
    assert kitchen.reason() is None
    assert kitchen.world.fixtures["microwave"].door == "closed"
    refused(kitchen, "close microwave door", "already_done")


@pytest.mark.parametrize(
    ("command", "station", "fixture"),
    [
        ("open cabinet door", "cabinet", "cabinet"),
        ("close microwave door", "microwave", "microwave"),
        ("turn on faucet", "sink", "faucet"),
        ("turn off stove", "stove", "stove"),
    ],
)
def test_with_a_full_hand_the_thing_falls(kitchen: TableKitchen, command: str, station: str, fixture: str) -> None:
    kitchen.door("microwave", "open").on("stove", "stove.1").stand(A, station).hold(A, "vegetable")
    before = kitchen.world.fixtures[fixture]
    kitchen.run(**{A: command})
    assert kitchen.reason() == "dropped"
    assert kitchen.place("vegetable") == FLOOR
    assert kitchen.world.robots[A].holding is None
    assert kitchen.world.fixtures[fixture] == before


def test_already_done_comes_before_the_fall(kitchen: TableKitchen) -> None:
    refused(kitchen.on("faucet", "faucet").stand(A, "sink").hold(A, "fish"), "turn on faucet", "already_done")


def test_faucet_on_and_off(kitchen: TableKitchen) -> None:
    kitchen.stand(A, "sink").run(**{A: "turn on faucet"})
    assert kitchen.world.fixtures["faucet"].on == {"faucet"}
    kitchen.run(**{A: "turn off faucet"})
    assert kitchen.world.fixtures["faucet"].on == set()
    refused(kitchen, "turn off faucet", "already_done")


def test_the_knob_is_that_of_the_burner_under_the_pan(kitchen: TableKitchen) -> None:
    kitchen.put("pan", "stove.3").stand(A, "stove").run(**{A: "turn on stove"})
    assert kitchen.world.fixtures["stove"].on == {"stove.3"}


def test_an_unneeded_vessel_on_the_stove_does_not_take_the_knob_from_the_pan(kitchen: TableKitchen) -> None:
    kitchen.put("plate", "stove.1").put("pan", "stove.3").stand(A, "stove").run(**{A: "turn on stove"})
    assert kitchen.world.fixtures["stove"].on == {"stove.3"}


def test_turning_the_stove_off_turns_every_burner_off(kitchen: TableKitchen) -> None:
    kitchen.put("pan", "stove.3").on("stove", "stove.0", "stove.3").stand(A, "stove").run(**{A: "turn off stove"})
    assert kitchen.world.fixtures["stove"].on == set()


def test_without_a_pan_it_is_the_default_burner(kitchen: TableKitchen) -> None:
    assert kitchen.stand(A, "stove").run(**{A: "turn on stove"}).world.fixtures["stove"].on == {"stove.0"}


def test_the_microwave_runs_only_when_it_is_shut(kitchen: TableKitchen) -> None:
    refused(kitchen.stand(A, "microwave").door("microwave", "ajar"), "turn on microwave", "blocked")
    kitchen.door("microwave", "closed").run(**{A: "turn on microwave"})
    assert kitchen.world.fixtures["microwave"].on == {"microwave"}
    kitchen.run(**{A: "open microwave door"})
    assert kitchen.world.fixtures["microwave"].on == set()


def test_season(kitchen: TableKitchen) -> None:
    refused(kitchen.stand(A, "counter_mid"), "season vegetable", "hands_empty")
    refused(kitchen.hold(A, "fish"), "season vegetable", "hands_empty")
    kitchen.put("fish", "counter.3").hold(A, "seasoning").run(**{A: "season vegetable"})
    assert kitchen.world.objects["vegetable"].marks == {"seasoned"}
    assert kitchen.world.robots[A].holding == "seasoning"


# -- the table itself -----------------------------------------------------------------------------------------------


def test_every_row_gives_reasons_of_the_closed_list_and_sentences() -> None:
    for name, skill in SKILLS.items():
        for requirement in skill.requires(A, "stove"):
            assert requirement.reason in REASONS, name
            assert requirement.condition.sentence, name
            assert not requirement.drops or requirement.mark == "attempt", name
        assert all(achieved.sentence for achieved in skill.achieves(A, "stove", "fish")), name
        if name not in AT_STATION:
            assert "at" in [r.condition.predicate for r in skill.requires(A, "stove")], name


def test_what_can_be_asked_of_a_kitchen_can_still_be_asked() -> None:
    """Records and prompts know the predicates by these names; others may be added."""
    names = (
        "at aside station_free hand_empty holding hand_full holds_shaker placed accessible unloaded graspable room "
        "no_vessel_needed inside directly_on door_open door_not_open door_closed door_not_closed switched_on "
        "switched_off some_on all_off may_run marked"
    )
    assert set(names.split()) <= set(PREDICATES)


# -- what is too big for the hand inside ------------------------------------------------------------------------------


@pytest.mark.parametrize(("noun", "around"), [("pan", "cabinet"), ("bowl", "microwave"), ("seasoning", "cabinet")])
def test_a_thing_too_big_for_the_hand_is_not_put_in(kitchen: TableKitchen, noun: str, around: str) -> None:
    kitchen.put("plate", "counter.6").door(around, "open").stand(A, around).hold(A, noun)
    refused(kitchen, f"place to {around}", "blocked")


@pytest.mark.parametrize("noun", ["plate", "bowl"])
def test_a_thing_too_big_for_the_hand_is_not_taken_out(kitchen: TableKitchen, noun: str) -> None:
    kitchen.put(noun, "microwave.0").door("microwave", "open").stand(A, "microwave")
    refused(kitchen, f"pick up {noun}", "blocked")


@pytest.mark.parametrize("noun", ["vegetable", "fish"])
def test_a_thing_that_fits_goes_in_and_comes_out(kitchen: TableKitchen, noun: str) -> None:
    kitchen.door("microwave", "open").stand(A, "microwave").hold(A, noun)
    assert kitchen.run(**{A: "place to microwave"}).reason() is None
    assert kitchen.run(**{A: f"pick up {noun}"}).reason() is None


def test_what_is_too_big_is_not_put_on_a_vessel_inside_either() -> None:
    kitchen = TableKitchen(vegetable="strawberry")
    kitchen.door("cabinet", "open").stand(A, "cabinet").hold(A, "vegetable")
    refused(kitchen, "place to plate", "blocked")
    kitchen.put("plate", "counter.2").stand(A, "counter_mid")
    assert kitchen.run(**{A: "place to plate"}).reason() is None


def test_no_hand_reaches_into_a_bowl_in_a_cabinet() -> None:
    kitchen = TableKitchen().put("plate", "counter.6").put("bowl", "cabinet.0").door("cabinet", "open")
    kitchen.stand(A, "cabinet").hold(A, "fish")
    refused(kitchen, "place to bowl", "blocked")
    kitchen.put("fish", "bowl")
    kitchen.world = kitchen.world.with_robot(A, holding=None)
    refused(kitchen, "pick up fish", "blocked")
    kitchen.put("bowl", "counter.2").stand(A, "counter_mid")
    assert kitchen.run(**{A: "pick up fish"}).run(**{A: "place to bowl"}).reason() is None


def test_a_closed_door_is_told_before_the_depth_of_a_bowl_behind_it() -> None:
    kitchen = TableKitchen().put("plate", "counter.6").put("bowl", "cabinet.0").put("fish", "bowl").stand(A, "cabinet")
    refused(kitchen, "pick up fish", "door_closed")
