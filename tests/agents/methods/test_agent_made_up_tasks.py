"""Tasks with other nouns and other hidden constraints climb the same staircase."""

from __future__ import annotations

import pytest
from agent_kitchens import play
from made_up_tasks import dough, towels

import remac_agents
from remac_env.rules.facts import FixtureFacts, ObjectFacts


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
