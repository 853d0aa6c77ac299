"""Tasks with other nouns and other hidden constraints climb the same staircase."""

from __future__ import annotations

import pytest
from agent_kitchens import MadeUpKitchen, play

import remac_agents
from remac_env.rules.facts import FixtureFacts, ObjectFacts
from remac_env.tasks.goals import All, DoorIs, Inside, SwitchedOn

BENCH = FixtureFacts("bench", "bench", "bench_left", slots=("bench.0", "bench.1", "bench.2", "bench.3"))
STATIONS = {"bench.2": "bench_right", "bench.3": "bench_right"}


def towels(**changes: object) -> MadeUpKitchen:
    """Hidden: the dryer's door is closed, and it runs only when shut again."""
    dryer = FixtureFacts(
        "dryer", "dryer", "dryer", door=True, switches=("dryer",), slots=("dryer.0",), shut_to_run=True
    )
    settings: dict[str, object] = {
        "name": "DryTowel",
        "sentence": "dry the towel in the dryer",
        "goal": All(Inside("towel", "dryer"), DoorIs("dryer", "closed"), SwitchedOn("dryer")),
        "fixtures": {"bench": BENCH, "dryer": dryer},
        "objects": {"towel": ObjectFacts("towel", "towel"), "soap": ObjectFacts("soap", "soap")},
        "places": {"towel": "bench.0", "soap": "bench.3"},
        "verbs": {"dry": ("turn on dryer",)},
        "slot_stations": STATIONS,
    }
    return MadeUpKitchen(**(settings | changes))  # type: ignore[arg-type]


def dough(**changes: object) -> MadeUpKitchen:
    """Hidden: dough needs a tray in the furnace."""
    furnace = FixtureFacts("furnace", "furnace", "furnace", slots=("furnace.0",))
    lamp = FixtureFacts("burner plate", "lamp", "furnace", switches=("burner plate",))
    settings: dict[str, object] = {
        "name": "BakeDough",
        "sentence": "bake the dough in the furnace",
        "goal": All(Inside("dough", "tray"), Inside("tray", "furnace"), SwitchedOn("burner plate")),
        "fixtures": {"bench": BENCH, "furnace": furnace, "burner plate": lamp},
        "objects": {
            "dough": ObjectFacts("dough", "dough", needs_vessel_in=frozenset({"furnace"})),
            "tray": ObjectFacts("tray", "tray", vessel_in=frozenset({"furnace"}), holds=2),
        },
        "places": {"dough": "bench.0", "tray": "bench.2"},
        "verbs": {"bake": ("turn on burner plate",)},
        "slot_stations": STATIONS,
    }
    return MadeUpKitchen(**(settings | changes))  # type: ignore[arg-type]


@pytest.mark.parametrize(("kitchen", "alone", "team"), [(towels, 8, 6), (dough, 9, 7)])
def test_the_staircase(kitchen: object, alone: int, team: int) -> None:
    env = kitchen()  # type: ignore[operator]
    assert not play(env, remac_agents.make("BASE")).success
    agent = remac_agents.make("REMAC")
    reports = [play(env, agent) for _ in range(4)]
    assert all(report.success for report in reports)
    assert reports[0].adjusted
    assert reports[0].final_plan_length > alone
    assert reports[1].initial_plan_length == alone
    assert not reports[1].adjusted
    assert [report.initial_plan_length for report in reports[2:]] == [team, team]


def test_a_thing_in_the_way_is_learnt_about_in_a_second_lesson() -> None:
    objects = dict(dough().objects) | {"jar": ObjectFacts("jar", "jar")}
    env = dough(objects=objects, places={"dough": "bench.0", "tray": "bench.2", "jar": "furnace.0"})
    agent = remac_agents.make("RE")
    first, second = play(env, agent), play(env, agent)
    assert first.success
    assert second.success
    assert second.initial_plan_length < first.final_plan_length
    assert "pick up jar" in " ".join(second.initial_plan["robot_0"])


def test_what_is_done_already_is_left_out() -> None:
    sentence = "turn on the burner plate and bake the dough in the furnace"
    env = dough(sentence=sentence, verbs={"bake": ()}, robots=("robot_0",))
    env.start = env.start.with_fixture("burner plate", on=frozenset({"burner plate"}))
    agent = remac_agents.make("RE")
    first, second = play(env, agent), play(env, agent)
    assert first.success
    assert second.initial_plan_length == second.final_plan_length == 8
    assert "turn on burner plate" not in second.initial_plan["robot_0"]


def test_without_a_shelf_to_put_things_on_the_method_still_ends() -> None:
    fixtures = {name: facts for name, facts in towels().fixtures.items() if name != "bench"}
    hook = FixtureFacts("hook", "hook", "hook", door=True, slots=("hook.0", "hook.1"))
    env = towels(
        fixtures=fixtures | {"hook": hook}, places={"towel": "hook.0", "soap": "hook.1"}, slot_stations={}
    )
    for name in remac_agents.methods():
        agent = remac_agents.make(name)
        for _ in range(3):
            play(env, agent)
