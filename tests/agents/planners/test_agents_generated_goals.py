"""Rule-based planners before generated goals: kinds and numbers are read, and what failed is tried otherwise."""

from __future__ import annotations

from dataclasses import replace

import pytest

import remac_env
from remac_agents.plan import Commands, Plan
from remac_agents.planners.common_sense import members
from remac_agents.planners.literal import LiteralPlanner
from remac_agents.planners.sentence import SentenceReader
from remac_agents.planning.exploring import explored, failed_always
from remac_agents.reflectors.rule import RuleReflector
from remac_agents.roles import PlanRequest, PreviousTry, Ran
from remac_env.rules.scene import PublicScene, public_scene
from remac_env.rules.subtasks import Subtask


def kitchen(template: str = "everything put away", seed: int = 0) -> tuple[PublicScene, Commands]:
    """The names and commands of a generated kitchen."""
    spec = remac_env.generate(2, seed, template=template)
    env = remac_env.parallel_env(spec, robots=1, backend="symbolic")
    _, infos = env.reset(seed=0)
    return public_scene(env.start.scene), Commands(infos["robot_0"]["commands"])


def read(sentence: str, facts: PublicScene, commands: Commands) -> list[str]:
    """The steps of a sentence, as text."""
    verbs = {"wash": ("turn on faucet",)}
    return [step.text for step in SentenceReader(facts, commands, verbs).read(sentence)]


def test_kinds_and_numbers_are_read() -> None:
    facts, commands = kitchen()
    fruit, mug = members("every fruit", facts), members("all mugs", facts)
    assert len(fruit) == 1 and len(mug) == 1 and mug[0].endswith(" mug")
    assert members("two of the mugs", facts) == mug and members("the moon", facts) == ()
    steps = read("put every fruit into the pantry or sideboard", facts, commands)
    assert steps == [f"navigate to {fruit[0]}", f"pick up {fruit[0]}", "navigate to pantry", "place to pantry"]
    assert "place to counter" not in read("keep every mug out of the counter", facts, commands)
    assert read("wash every mug", facts, commands)[-1] == "turn on faucet"
    assert "place to sink" in read("wash every mug", facts, commands)


def request(steps: list[str], failed: list[str], *, success: bool = False, goal: str = "") -> PlanRequest:
    """A request after an iteration in which these steps were run, some of them in vain."""
    facts, commands = kitchen()
    ran = tuple(Ran(n, "robot_0", text, text not in failed) for n, text in enumerate(steps, 1))
    previous = PreviousTry({"robot_0": tuple(steps)}, success, ran)
    return PlanRequest(goal, "", facts, ("robot_0",), "robot_0", tuple(commands), previous=previous)


def test_what_failed_every_time_is_tried_otherwise() -> None:
    steps = ["navigate to faucet", "turn on faucet"]
    tried = [step.text for step in explored([], request(steps, ["turn on faucet"]))]
    assert tried[-2:] == ["navigate to faucet", "turn on faucet"]
    assert {"turn on stove", "turn on microwave", "close pantry door"} <= set(tried)
    put = request(["place to pantry"], ["place to pantry"], goal="put every fruit into the pantry or sideboard")
    assert [step.text for step in explored([], put)] == ["place to sideboard"]


def test_what_worked_is_done_again_and_what_worked_once_has_not_failed() -> None:
    steps = ["navigate to faucet", "turn on faucet"]
    again = explored([Subtask("wait")], request(steps, ["turn on faucet"], success=True))
    assert [step.text for step in again] == steps
    ran = (Ran(1, "robot_0", "turn on faucet", False), Ran(2, "robot_0", "turn on faucet", True))
    assert failed_always(PreviousTry({}, False, ran)) == []


def test_a_plan_for_several_robots_is_kept_whole() -> None:
    opened = ("navigate to pantry", "open pantry door", "navigate aside")
    fetched = ("wait", "navigate to sink", "pick up mug", "navigate to pantry", "place to pantry")
    facts, commands = kitchen()
    mug = members("every mug", facts)[0]
    rows = {"robot_0": opened, "robot_1": tuple(text.replace("mug", mug) for text in fetched)}
    ran = tuple(Ran(n, robot, text, True) for robot, row in rows.items() for n, text in enumerate(row, 1))
    told = PlanRequest("put every mug into the pantry", "", facts, tuple(rows), "robot_0", tuple(commands))
    planner = LiteralPlanner(explores=True)
    again = planner.plan(replace(told, previous=PreviousTry(rows, True, ran)))
    assert isinstance(again, Plan)
    assert {robot: tuple(step.text for step in again.row(robot)) for robot in rows} == rows
    failed = replace(told, previous=PreviousTry(rows, False, ran))
    assert [step.text for step in explored([], failed)] == [*opened[:2], *rows["robot_1"][1:]], "part after part"


@pytest.mark.parametrize("success", [True, False])
def test_of_the_places_that_were_searched_the_last_is_remembered(success: bool) -> None:
    lessons = [
        'Before "navigate to red mug", do "navigate to pantry", "open pantry door".',
        'Before "turn on faucet", do "navigate to stove".',
        'Before "navigate to red mug", do "navigate to chest", "open chest door".',
    ]
    assert RuleReflector().review(lessons, success=success) == lessons[1:]
