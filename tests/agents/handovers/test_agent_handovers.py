"""Sharing a plan between two robots: prerequisites first, nobody in the way, and only where it gains."""

from __future__ import annotations

from dataclasses import replace

import pytest
from agent_kitchens import MadeUpKitchen
from made_up_tasks import dough, towels

from remac_agents.checkers.noisy import NoisyChecker
from remac_agents.handovers.schedule import schedule
from remac_agents.plan import Commands, Plan
from remac_agents.roles import HandoverRequest, View
from remac_agents.wiring.catalogue import make_role
from remac_env.rules.conditions import condition
from remac_env.rules.facts import FixtureFacts
from remac_env.rules.scene import public_scene
from remac_env.rules.subtasks import STEP_ASIDE, WAIT, Subtask

ALONE = (
    "navigate to tray",
    "pick up tray",
    "navigate to furnace",
    "place to furnace",
    "navigate to dough",
    "pick up dough",
    "navigate to furnace",
    "place to tray",
    "turn on burner plate",
)


def request(steps: tuple[str, ...], env: MadeUpKitchen | None = None) -> HandoverRequest:
    env = env or dough()
    commands = Commands(env.commands)
    view = View(env.sentence, public_scene(env.scene), {"a": None}, world=env.start, rules=env.scene)
    plan = tuple(commands[text] for text in steps)
    return HandoverRequest(env.sentence, plan, "robot_1", "robot_0", (), tuple(env.commands), view)


@pytest.mark.parametrize(("name", "rounds"), [("reflections", 7), ("search", 6)])
def test_what_comes_before_the_main_object_goes_to_the_helper(name: str, rounds: int) -> None:
    plan = make_role("handover", name).share(request(ALONE))
    assert isinstance(plan, Plan)
    assert plan.length == rounds
    assert set(plan.robots) == {"robot_0", "robot_1"}
    if name == "reflections":
        assert plan.row("robot_0") == tuple(request((*ALONE[:4], "navigate aside")).plan)


def test_a_careful_hand_over_tries_nothing_new_where_it_counts() -> None:
    careful = make_role("handover", "reflections,careful=true")
    assert isinstance(careful.share(request(ALONE)), Plan)
    assert careful.share(replace(request(ALONE), untried=True)) is None
    assert isinstance(make_role("handover", "reflections").share(replace(request(ALONE), untried=True)), Plan)


@pytest.mark.parametrize("name", ["reflections", "search"])
def test_what_cannot_be_shared_is_done_alone(name: str) -> None:
    assert make_role("handover", name).share(request(ALONE[4:6])) is None


def test_the_leading_robot_waits_for_a_thing_that_is_still_being_moved() -> None:
    facts = dough().scene
    steps = Commands(dough().commands)
    main = [steps[t] for t in ("navigate to dough", "pick up dough", "navigate to tray", "place to tray")]
    work = [steps[t] for t in ("navigate to tray", "pick up tray", "navigate to furnace", "place to furnace")]
    plan = schedule("a", main, "b", work, facts)
    placed = plan.row("b").index(Subtask("place to", "furnace"))
    assert plan.row("a").index(Subtask("navigate to", "tray")) > placed
    assert [step for step in plan.row("a") if step.skill != "wait"] == main


@pytest.mark.parametrize("name", ["reflections", "search"])
def test_who_keeps_something_open_leaves_when_the_leading_robot_comes(name: str) -> None:
    commands = Commands(towels().commands)
    opened = ("navigate to dryer", "open dryer door")
    long_way = ("navigate to towel", "pick up towel", "navigate to bench", "navigate to dryer", "place to dryer")
    plan = tuple(commands[text] for text in (*opened, *long_way))
    view = View("t", public_scene(towels().scene), {}, world=towels().start, rules=towels().scene)
    given = HandoverRequest("the towel", plan, "robot_0", "robot_1", (), tuple(towels().commands), view)
    shared = make_role("handover", name).share(replace(given, kept=(commands["open dryer door"],)))
    assert isinstance(shared, Plan) and shared.row("robot_0") == plan[2:]
    assert shared.row("robot_1") == (*plan[:2], WAIT, STEP_ASIDE), "it would leave one round earlier"
    early = schedule("robot_0", plan[2:], "robot_1", plan[:2], view.scene)
    assert early.row("robot_1") == (*plan[:2], STEP_ASIDE)


def test_who_keeps_something_open_comes_back_between_two_visits() -> None:
    visit = ("navigate to dryer", "place to dryer")
    fetched = ("navigate to towel", "pick up towel", *visit, "navigate to soap", "pick up soap", *visit)
    given = request(("navigate to dryer", "open dryer door", *fetched), towels())
    way, opened, plan = given.plan[0], given.plan[1], given.plan
    careful = make_role("handover", "reflections,careful=true")
    shared = careful.share(replace(given, lead="robot_0", helper="robot_1", kept=(opened,), untried=True))
    assert isinstance(shared, Plan) and shared.row("robot_0") == plan[2:]
    assert shared.row("robot_1") == (*plan[:2], STEP_ASIDE, WAIT, way, WAIT, STEP_ASIDE)


def test_what_never_came_about_is_tried_while_the_helper_stands_at_one_place_after_the_other() -> None:
    env = dough()
    lamps = {
        name: FixtureFacts(name, "lamp", station, switches=(name,))
        for name, station in (("near lamp", "furnace"), ("desk lamp", "desk"), ("hall lamp", "hall"))
    }
    given = request(ALONE, dough(fixtures={**env.scene.fixtures, **lamps}))
    never = given.plan[-1]
    careful = make_role("handover", "reflections,careful=true")
    shared = careful.share(replace(given, failing=(never,), untried=True))
    assert isinstance(shared, Plan)
    assert shared.row("robot_1") == (*given.plan, never), "once for each place where two can stand at once"
    tour = tuple(Subtask("navigate to", name) for name in ("desk lamp", "hall lamp"))
    assert shared.row("robot_0") == (*[WAIT] * (len(ALONE) - 2), *tour, STEP_ASIDE)


def test_robots_that_need_each_others_place_take_turns() -> None:
    facts = towels().scene
    steps = Commands(towels().commands)
    main = [steps[t] for t in ("navigate to dryer", "turn on dryer")]
    work = [steps[t] for t in ("navigate to dryer", "close dryer door")]
    plan = schedule("a", main, "b", work, facts)
    assert plan.length == 4
    assert plan.row("b")[:2] == tuple(work)


def test_noise_depends_on_seed_and_iteration() -> None:
    env = dough()
    view = View("", public_scene(env.scene), {}, world=env.start, rules=env.scene)
    checker = NoisyChecker(false_alarm=0.5, miss=0.5)

    def verdicts(seed: int, iteration: int) -> list[bool]:
        checker.begin_episode(seed, iteration)
        return [v.value for _ in range(40) for v in checker.check([condition("unloaded", "tray")], view)]

    assert verdicts(1, 0) == verdicts(1, 0)
    assert len({tuple(verdicts(seed, iteration)) for seed in (1, 2) for iteration in (0, 1)}) == 4
