"""Goals made of goals state themselves, judge a world, report progress, travel, and are searched for exactly."""

from __future__ import annotations

from dataclasses import replace

import pytest
from plain_kitchens import kitchen

from remac_agents.isolation.codec import dumps, loads
from remac_env.oracle import certify
from remac_env.oracle.bounds import make_bound
from remac_env.rules.marks import too_early
from remac_env.rules.rounds import at_rest
from remac_env.state import FLOOR, Place
from remac_env.tasks.compound import AnyOf, Before, Count, ForAll, Not
from remac_env.tasks.goals import All, DoorIs, Goal, Inside, Marked, SwitchedOn, lost, progress

IN = Inside("{each}", "microwave")
GOALS: dict[str, tuple[Goal, tuple[str, str, str]]] = {
    "any": (
        AnyOf(Inside("carrot", "cabinet"), Inside("carrot", "sink")),
        (
            "pick up the carrot and place it into the cabinet or sink",
            "place the carrot into the sink or cabinet",
            "put the carrot into the cabinet or sink",
        ),
    ),
    "not": (
        All(Not(Inside("carrot", "counter")), Not(SwitchedOn("stove"))),
        (
            "keep the carrot out of the counter and turn off the stove",
            "turn off the stove and keep the carrot out of the counter",
            "keep the carrot out of the counter and leave the stove off",
        ),
    ),
    "all": (
        ForAll("fruit", Inside("{each}", "sink"), ("{one}", "apple")),
        (
            "pick up the carrot and place it into the sink and pick up the apple and place it into the sink",
            "place all fruits into the sink",
            "put every fruit into the sink",
        ),
    ),
    "count": (
        Count("food", Inside("{each}", "sink"), ("carrot", "apple"), least=1),
        ("pick up a food and place it into the sink", "place a food into the sink", "put a food into the sink"),
    ),
    "before": (
        Before("carrot", "washed", "heated"),
        (
            "wash the carrot, then heat the carrot",
            "heat the carrot after it has been washed",
            "wash the carrot and heat it after that",
        ),
    ),
    "marks": (All(Marked("carrot", "cooled"), Marked("carrot", "seasoned"), DoorIs("cabinet", "closed")),
              ("cool the carrot, season the carrot and close the cabinet door",
               "close the cabinet door, season the carrot and cool the carrot",
               "cool the carrot, season the carrot and close the cabinet door")),
}  # fmt: skip


@pytest.mark.parametrize("name", GOALS)
def test_a_goal_states_itself_in_three_wordings_and_travels(name: str) -> None:
    goal, said = GOALS[name]
    bound = goal.bind({"one": "carrot"})
    assert tuple(bound.told(wording) for wording in (1, 2, 3)) == said
    assert "{" not in bound.text
    assert loads(dumps(bound)) == bound
    assert set(bound.names()) <= {"carrot", "apple", "cabinet", "sink", "counter", "stove"}


def test_goals_judge_a_world_and_report_progress() -> None:
    scene, world = kitchen()
    both = ForAll("food", Inside("{each}", "sink"), ("carrot", "apple"))
    one = world.with_object("apple", place=Place("slot", "sink.0"))
    assert not both.holds(scene, one) and progress(both, scene, one) == 0.5
    some = Count("food", Inside("{each}", "sink"), ("carrot", "apple", "plate"), least=2)
    assert progress(some, scene, one) == 0.5 and not some.holds(scene, one)
    assert Count("food", Inside("{each}", "sink"), ("carrot", "apple"), least=1).holds(scene, one)
    either = AnyOf(All(Inside("apple", "sink"), DoorIs("cabinet", "open")), Inside("carrot", "sink"))
    assert progress(either, scene, one) == 0.5 and not either.holds(scene, one)
    assert Not(Inside("apple", "counter")).holds(scene, one) and not Not(Inside("apple", "sink")).holds(scene, one)


def test_only_what_cannot_be_done_without_is_lost() -> None:
    scene, world = kitchen()
    down = world.with_object("apple", place=FLOOR)
    assert lost(ForAll("food", IN, ("carrot", "apple")), scene, down)
    assert not lost(Count("food", IN, ("carrot", "apple"), least=1), scene, down)
    assert not lost(AnyOf(Inside("apple", "sink"), Inside("carrot", "sink")), scene, down)
    assert lost(AnyOf(Inside("apple", "sink"), Inside("apple", "cabinet")), scene, down)
    assert not lost(Not(Inside("apple", "counter")), scene, down)


def test_what_comes_too_early_cannot_be_made_good() -> None:
    scene, world = kitchen(gives={"stove": "heated"})
    scene = replace(scene, orders=(("washed", "heated"),))
    goal = Before("carrot", "washed", "heated")
    heated = at_rest(scene, world.with_object("carrot", marks=frozenset({"heated"})))
    assert too_early("washed", "heated") in heated.objects["carrot"].marks
    assert lost(goal, scene, heated) and not goal.holds(scene, heated)
    washed = at_rest(scene, world.with_object("carrot", marks=frozenset({"washed"})))
    assert progress(goal, scene, washed) == 0.5
    assert goal.holds(scene, at_rest(scene, washed.with_object("carrot", marks=frozenset({"washed", "heated"}))))


@pytest.mark.parametrize("name", ["any", "count", "marks"])
def test_the_search_finds_a_shortest_plan_and_the_bound_is_never_above_it(name: str) -> None:
    scene, world = kitchen(gives={"stove": "heated", "microwave": "cooled"})
    goal = GOALS[name][0] if name != "marks" else Marked("carrot", "cooled")
    found = certify(scene, world, goal, max_rounds=12)
    assert found.optimum == {"any": 4, "count": 4, "marks": 8}[name]
    assert make_bound(scene, goal)(world) <= found.optimum
