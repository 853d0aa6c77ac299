"""Rounds of two robots: claims are settled before motion, the same for both."""

from __future__ import annotations

import pytest
from table_kitchen import A, B, TableKitchen

from remac_env.rules.facts import ASIDE
from remac_env.state import Place


@pytest.fixture
def kitchen() -> TableKitchen:
    return TableKitchen()


def test_two_that_claim_one_station_both_stay(kitchen: TableKitchen) -> None:
    before = kitchen.world
    kitchen.run(robot_0="navigate to sink", robot_1="navigate to faucet")
    assert (kitchen.reason(A), kitchen.reason(B)) == ("station_occupied", "station_occupied")
    assert kitchen.world == before


def test_two_that_reach_for_one_thing_both_stop() -> None:
    """They would stand at one station, which the table never lets happen; the rule holds all the same."""
    kitchen = TableKitchen().stand(A, "counter_mid").stand(B, "counter_mid")
    kitchen.run(robot_0="pick up vegetable", robot_1="pick up vegetable")
    assert (kitchen.reason(A), kitchen.reason(B)) == ("station_occupied", "station_occupied")
    assert kitchen.place("vegetable") == Place("slot", "counter.0")


def test_arriving_where_another_stays(kitchen: TableKitchen) -> None:
    kitchen.stand(B, "sink").run(robot_0="navigate to sink", robot_1="turn on faucet")
    assert (kitchen.reason(A), kitchen.reason(B)) == ("station_occupied", None)
    assert kitchen.world.robots[A].station == ASIDE


def test_arriving_where_another_leaves(kitchen: TableKitchen) -> None:
    kitchen.stand(B, "sink").run(robot_0="navigate to sink", robot_1="navigate aside")
    assert (kitchen.reason(A), kitchen.reason(B)) == (None, None)
    assert (kitchen.world.robots[A].station, kitchen.world.robots[B].station) == ("sink", ASIDE)


def test_leaving_refused_means_arriving_refused(kitchen: TableKitchen) -> None:
    """B cannot leave for an object that A holds, so its station does not fall free."""
    kitchen.stand(A, "stove").hold(A, "fish").stand(B, "sink")
    kitchen.run(robot_0="navigate to sink", robot_1="navigate to fish")
    assert (kitchen.reason(A), kitchen.reason(B)) == ("station_occupied", "unreachable")
    assert (kitchen.world.robots[A].station, kitchen.world.robots[B].station) == ("stove", "sink")


def test_two_swap_their_stations(kitchen: TableKitchen) -> None:
    kitchen.stand(A, "stove").stand(B, "sink").run(robot_0="navigate to sink", robot_1="navigate to stove")
    assert (kitchen.reason(A), kitchen.reason(B)) == (None, None)
    assert (kitchen.world.robots[A].station, kitchen.world.robots[B].station) == ("sink", "stove")


def test_going_where_one_stands_already_while_another_wants_to_come(kitchen: TableKitchen) -> None:
    kitchen.stand(A, "sink").run(robot_0="navigate to faucet", robot_1="navigate to sink")
    assert kitchen.reason(B) == "station_occupied"
    assert (kitchen.world.robots[A].station, kitchen.world.robots[B].station) == ("sink", ASIDE)


def test_both_step_aside_at_once(kitchen: TableKitchen) -> None:
    kitchen.stand(A, "sink").stand(B, "stove").run(robot_0="navigate aside", robot_1="navigate aside")
    assert (kitchen.reason(A), kitchen.reason(B)) == (None, None)


def test_a_long_counter_has_room_for_two_when_one_is_there(kitchen: TableKitchen) -> None:
    kitchen.put("fish", "sink.0").stand(A, "counter_mid").run(robot_1="navigate to counter")
    assert (kitchen.reason(B), kitchen.world.robots[B].station) == (None, "counter_right")


def test_work_at_two_places_is_done_at_once(kitchen: TableKitchen) -> None:
    kitchen.stand(A, "counter_mid").stand(B, "cabinet").run(robot_0="pick up vegetable", robot_1="open cabinet door")
    assert (kitchen.reason(A), kitchen.reason(B)) == (None, None)
    assert kitchen.world.robots[A].holding == "vegetable"
    assert kitchen.world.fixtures["cabinet"].door == "open"


def test_one_robots_failure_does_not_stop_the_other(kitchen: TableKitchen) -> None:
    kitchen.stand(A, "counter_mid").stand(B, "cabinet").hold(B, "fish")
    kitchen.run(robot_0="pick up vegetable", robot_1="open cabinet door")
    assert (kitchen.reason(A), kitchen.reason(B)) == (None, "dropped")


def test_conditions_are_those_before_the_round(kitchen: TableKitchen) -> None:
    """A door that opens in this round is shut for whoever wants to put something in during the same round."""
    kitchen.stand(A, "cabinet").run(robot_0="open cabinet door", robot_1="navigate to plate")
    assert kitchen.reason(B) == "station_occupied"


def test_conflicting_stations_count_as_one(kitchen: TableKitchen) -> None:
    from dataclasses import replace

    near = frozenset({frozenset({"sink", "counter_mid"})})
    kitchen.scene = replace(kitchen.scene, conflicts=near)
    kitchen.run(robot_0="navigate to sink", robot_1="navigate to vegetable")
    assert (kitchen.reason(A), kitchen.reason(B)) == ("station_occupied", "station_occupied")
    kitchen.stand(A, "sink").run(robot_1="navigate to vegetable")
    assert kitchen.reason(B) == "station_occupied"
    kitchen.run(robot_0="navigate aside", robot_1="navigate to vegetable")
    assert (kitchen.reason(A), kitchen.reason(B)) == (None, None)
