"""What models are told: how commands ended, how the try before went, all that is wrong with an answer - each once."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest
from agent_kitchens import play
from chaos_server import Asked, refuses
from pydantic import BaseModel
from remac_bench.plans.ask import Cell, judged, teach_by
from scripted_model import NAIVE, RIGHT, TASK, ScriptedModel, agent_of, run, scripted

import remac_agents
from remac_agents.llm import BadAnswer
from remac_agents.prompting import wording
from remac_agents.prompting.model_role import reads, texts_in
from remac_agents.roles import AdjustRequest, Advice, FreeText, PlanRequest, PreviousTry, Ran, StopEpisode
from remac_agents.roles.request_json import as_json
from remac_agents.wiring.catalogue import make_role

TOO_FAR = "open microwave door"
"""Fails wherever the robot does not stand at the microwave, as it does not at the start."""

STUMBLING = f"{TOO_FAR}, navigate to vegetable, pick up vegetable, navigate to microwave, place to microwave"


def text_of(asked: Asked) -> str:
    """All that a request says, system and user."""
    parts = [message["content"] for message in asked.body["messages"]]
    return "\n".join(part if isinstance(part, str) else part[0]["text"] for part in parts)


def heard(model: ScriptedModel, name: str) -> list[str]:
    return [user for asked, user in model.heard if asked == name]


def checks_only(*commands: str) -> Callable[[ScriptedModel], Callable[[str], str]]:
    """Pre-conditions of these commands alone."""

    def of(model: ScriptedModel) -> Callable[[str], str]:
        def answer(user: str) -> str:
            command = re.findall(r'is to run "(.+?)"', user)[-1]
            return model._conditions_before(user) if command in commands else '{"conditions": []}'

        return answer

    return of


# -- how commands ended ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("feedback", ["status", "reason"])
def test_an_adjuster_hears_how_each_command_ended(feedback: str) -> None:
    with scripted(feedback=feedback) as model:
        model.plan_before = STUMBLING
        model.answers = {"conditions_before": checks_only("place to microwave")(model)}
        assert run(model, "CC").adjusted
        why = ": not_at_station" if feedback == "reason" else ""
        for name in ("analysis", "adjustment"):
            told = heard(model, name)[0]
            assert f"1. robot_0: {TOO_FAR}: failure{why}\n" in told
            assert f"2. robot_0: {TOO_FAR}: failure{why} (2 times so far)\n" in told
            assert f"3. robot_0: {TOO_FAR}: failure{why} (3 times so far)\n" in told
            assert "4. robot_0: navigate to vegetable: success\n" in told


def test_who_mends_or_shares_a_plan_hears_how_the_kitchen_is_used() -> None:
    said = ("In a round", "The same place serves the sink and the faucet", "take one thing each", "cannot be picked up")
    with scripted(robots=2) as model:
        agent = agent_of(model, "REMAC")
        for _ in range(4):
            play(model.env, agent)
        for name in ("planner", "analysis", "adjustment", "handover"):
            for told in heard(model, name):
                assert [told.count(words) for words in said] == [1] * len(said), (name, told)
        assert heard(model, "analysis") and heard(model, "handover")


def test_both_robots_stand_in_one_line_a_round() -> None:
    ran = [Ran(1, "a", "pick up x", True), Ran(1, "b", "turn on y", False, "blocked"), Ran(3, "b", "turn on y", None)]
    assert wording.rounds(ran) == "1. a: pick up x: success; b: turn on y: failure: blocked\n3. b: turn on y: unknown"
    assert wording.rounds([]) == ""


def test_the_next_iteration_hears_how_the_try_before_went() -> None:
    with scripted() as model:
        model.plan_before = STUMBLING
        model.answers = {"conditions_before": checks_only("place to microwave")(model)}
        agent = agent_of(model, "RE")
        reports = [play(model.env, agent) for _ in range(3)]
        assert [report.success for report in reports] == [True, True, True]
        first, second, third = heard(model, "planner")
        assert "try before" not in first
        assert f"robot_0: [{STUMBLING}]\nIt reached the goal in" in second
        assert f"Commands that failed: robot_0: {TOO_FAR} (3 times).\nIt was changed on the way. What was run" in second
        assert f"2. robot_0: {TOO_FAR}: failure (2 times so far)" in second
        assert f"robot_0: [{RIGHT}]\nIt reached the goal in 6 rounds.\nIt was not changed on the way." in third


def test_an_adjuster_hears_how_the_try_before_went() -> None:
    with scripted() as model:
        model.answers = {"planner": f"Plan: [{NAIVE}]"}
        agent = agent_of(model, "RE")
        for _ in range(2):
            play(model.env, agent)
        for name in ("analysis", "adjustment"):
            first, second = heard(model, name)
            assert "try before" not in first
            assert f"The plan of the try before this one, and how that went:\nrobot_0: [{NAIVE}]\nIt reached" in second
            assert "4. robot_0: navigate to counter: success" in second


def test_a_try_that_failed_is_told_as_one() -> None:
    plan = {"a": ("go", "wait", "put")}
    lost = PreviousTry(plan, False, (Ran(1, "a", "go", True), Ran(3, "a", "put", False), Ran(4, "a", "put", False)))
    assert not lost.changed and lost.rounds == 4 and lost.failed == {"a: put": 2}
    told = wording.previous_try(lost)
    assert "It did not reach the goal in 4 rounds.\nCommands that failed: a: put (2 times)." in told
    assert PreviousTry(plan, True, (Ran(1, "a", "put", True),)).changed
    assert PreviousTry(plan, True, (Ran(1, "b", "go", True),)).changed


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("round 3, robot_0: place to x (failure: door_closed)", Ran(3, "robot_0", "place to x", False, "door_closed")),
        ("robot_0: place to x (success)", Ran(0, "robot_0", "place to x", True)),
        ("robot_0: place to x (unknown)", None),
        ("what a day", None),
    ],
)
def test_lines_of_the_memory_old_and_new(line: str, told: Ran | None) -> None:
    assert Ran.read(line) == told
    if told is not None and told.round:
        assert told.line == line


def test_planners_elsewhere_are_told_the_same() -> None:
    requests: list[PlanRequest] = []

    def plan(request: PlanRequest) -> Any:
        requests.append(request)
        return {"robot_0": RIGHT.split(", ")[:3] if len(requests) > 1 else ["fly"]}

    with scripted() as model:
        agent = remac_agents.make("RE", planner=plan)
        for _ in range(2):
            play(model.env, agent)
    first, second, third = (json.loads(json.dumps(as_json(request))) for request in requests)
    assert first["repairs"] == [] and first["previous"] is None and first["ran"] == []
    assert second["repairs"] == [{"answer": '{"robot_0": ["fly"]}', "problems": [second["failure"]]}]
    assert third["previous"]["plan"] == third["previous_plan"] == {"robot_0": RIGHT.split(", ")[:3]}
    assert third["previous"]["success"] is False and third["previous"]["rounds"] >= 3
    assert third["previous"]["ran"][0] == {
        "round": 1, "robot": "robot_0", "command": "navigate to microwave", "succeeded": True, "reason": None
    }  # fmt: skip


@pytest.mark.parametrize("method", ["RE", "REMAC", "REFLECT+CC", "CAPE", "SMART-LLM"])
def test_the_goal_stands_once_in_every_prompt(method: str) -> None:
    with scripted() as model:
        agent = agent_of(model, method)
        if method.startswith("REFLECT"):
            agent = agent_of(model, method, adjuster=lambda r: Advice("", row=r.plan.row(r.robot)))
        for _ in range(3 if agent.method.iterates else 1):
            play(model.env, agent)
        goal = next(iter(model.env.reset(seed=3)[1].values()))["goal"]
        for (name, _), asked in zip(model.heard, model.server.asked, strict=True):
            assert text_of(asked).count(goal) == (not name.startswith("checker")), (name, text_of(asked))


def test_a_states_text_is_that_of_the_moment() -> None:
    with scripted(text="states") as model:
        run(model, "CAPE")
        first, *_, last = heard(model, "planner_step")
        assert "The microwave door is closed." in first and "The microwave door is open." not in first
        assert "The microwave door is open." in last and "The microwave door is closed." not in last


def test_a_model_learns_from_its_own_first_iteration() -> None:
    with scripted() as model:
        given = {"name": "custom:scripted", "base_url": model.server.url}
        planner, reflector = (make_role(role, given) for role in ("planner", "reflector"))
        lessons = teach_by(Cell(task=TASK), planner=planner, reflector=reflector)
        assert judged(Cell(task=TASK), planner, lessons).optimal
        assert [name for name, _ in model.heard] == ["planner", "reflector", "planner"]
        assert "- Why: a full hand opens no door." in model.heard[2][1] and f"[{NAIVE}]" in model.heard[2][1]


def test_an_endpoint_that_is_down_teaches_nothing_and_says_so() -> None:
    with scripted() as model:
        model.server.script = [refuses(401)]
        planner = make_role("planner", {"name": "custom:scripted", "base_url": model.server.url})
        with pytest.raises(StopEpisode, match="unauthorised"):
            teach_by(Cell(task=TASK), planner=planner, reflector="rule")


# -- repairs -----------------------------------------------------------------------------------------------------------


def test_a_refused_plan_is_shown_with_everything_that_is_wrong() -> None:
    answers = iter(
        (
            "robot_7: [fly to moon]\nrobot_0: [navigate to vegetables, pick up vegetable]",
            f"Plan: [{RIGHT}]\nPlan: [navigate aside]",
            f"Plan: [{RIGHT}]",
        )
    )
    with scripted() as model:
        model.answers = {"planner": lambda user: next(answers)}
        report = run(model, "BASE")
        assert report.success and len(report.errors) == 2 and len(model.server.asked) == 3
        bodies = [asked.body["messages"] for asked in model.server.asked]
        assert [len(body) for body in bodies] == [2, 4, 6]
        said = ["assistant", "user"]
        assert [message["role"] for message in bodies[2]] == ["system", "user", *said, *said]
        assert bodies[2][:4] == bodies[1] and bodies[1][2]["content"].startswith("robot_7: [fly to moon]")
        for told in ("'robot_7'", "'fly to moon'", "'navigate to vegetables'", "nearest: 'navigate to vegetable'"):
            assert told in bodies[1][3]["content"] and told in report.errors[0]
        assert "2 different plans" in bodies[2][5]["content"]


def test_a_refused_answer_in_json_is_shown_with_everything_that_is_wrong() -> None:
    answers = iter(('{"reason": 3, "next_steps": ["fly"]}', '{"reason": "x", "next_steps": ["fly", "wash up"]}', "{}"))
    with scripted() as model:
        model.answers = {"analysis": lambda user: next(answers)}
        report = run(model, "CC", max_adjustments=1)
        asked = [a.body["messages"] for a in model.server.asked if "something that must be true" in text_of(a)]
        assert [len(body) for body in asked] == [2, 4, 6] and not report.success
        assert "reason" in asked[1][3]["content"] and "'fly'" in asked[1][3]["content"]
        assert "'fly'" in asked[2][5]["content"] and "'wash up'" in asked[2][5]["content"]
        assert any("reason" in error and "next_steps" in error for error in report.errors)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("I cannot tell.", "there is no JSON in the answer"),
        ('{"why": [1, 2', "the JSON breaks off before its last closing bracket"),
        ("{'why': 1}", "a name in double quotes is expected"),
        ('{"why": tru}', "in line 1, at 'tru}', a value is expected"),
        ('{"why": [1 2]}', "a comma or a closing bracket is expected"),
    ],
)
def test_what_is_wrong_with_json_is_told_in_plain_words(text: str, told: str) -> None:
    class Shape(BaseModel):
        why: str

    answer = reads(Shape)(text)
    assert isinstance(answer, BadAnswer) and told in answer.problem
    assert not re.search(r"Expecting|char \d|delimiter|Input should|column", answer.problem)


def test_entries_count_from_one_and_null_is_named_where_it_may_stand() -> None:
    class Shape(BaseModel):
        verdicts: list[bool | None]
        steps: list[bool]
        step: int | None = None

    answer = reads(Shape)('{"verdicts": [null, "maybe"], "steps": [null], "step": "2"}')
    assert isinstance(answer, BadAnswer)
    assert answer.problem.split("; valid: a JSON object")[0] == (
        'entry 2 of "verdicts" is "maybe"; valid: true or false, or null; '
        'entry 1 of "steps" is null; valid: true or false; '
        '"step" is "2"; valid: a whole number, or null'
    )
    missing = reads(Shape)("{}")
    assert isinstance(missing, BadAnswer) and missing.problem.startswith('"verdicts" is missing; "steps" is missing;')


def test_shape_and_content_are_told_together() -> None:
    class Shape(BaseModel):
        why: str
        steps: list[str]

    read = reads(Shape, lambda value: [f"{text} is odd" for text in texts_in(value, "steps") if text == "fly"])
    told = read('{"why": 3, "steps": ["fly", 7, "go"]}')
    assert isinstance(told, BadAnswer)
    assert told.problem.startswith('fly is odd; "why" is 3; valid: a text; ') and "why, steps" in told.problem
    assert 'entry 2 of "steps" is 7; valid: a text;' in told.problem
    assert isinstance(read('{"why": "x", "steps": ["fly"]}'), BadAnswer)
    assert read('{"why": "x", "steps": ["go"], "more": 1}') == Shape(why="x", steps=["go"])
    assert isinstance(read("[]"), BadAnswer) and isinstance(read('{"steps": 3}'), BadAnswer)


@pytest.mark.parametrize("method", ["BASE", "CAPE"])
def test_three_times_in_all(method: str) -> None:
    with scripted() as model:
        model.answers = {"planner": "no idea", "planner_step": "no idea"}
        report = run(model, method)
        assert len(model.server.asked) == 3 == report.usage.calls == len(report.errors)


def test_a_step_that_was_refused_stays_told_while_answers_are_sent_back() -> None:
    answers = iter(("Plan: [pick up vegetable]", "fly", "Plan: [done]"))
    with scripted() as model:
        model.answers = {"planner_step": lambda user: next(answers)}
        run(model, "CAPE")
        last = [a.body["messages"] for a in model.server.asked if len(a.body["messages"]) == 4]
        assert "Error: I cannot pick up vegetable" in last[0][1]["content"] and last[0][2]["content"] == "fly"


# -- asked once --------------------------------------------------------------------------------------------------------


def test_the_same_conditions_are_asked_for_once_an_episode() -> None:
    with scripted() as model:
        agent = agent_of(model, "RE", planner=lambda request: ["navigate aside", "wait", "navigate aside"])
        reports = [play(model.env, agent) for _ in range(2)]
        asked = [heard(model, name) for name in ("conditions_before", "conditions_after")]
        assert all(len(questions) == 2 * len(set(questions)) for questions in asked)
        for report in reports:
            assert report.usage.repeats >= 2
            assert report.usage.calls == len(report.exchanges)


def test_a_question_that_got_no_usable_answer_is_put_again() -> None:
    with scripted() as model:
        model.answers = {"conditions_before": "no idea"}
        run(model, "CC", planner=lambda request: ["navigate aside", "wait", "navigate aside"])
        first = [q for q in heard(model, "conditions_before") if "could not be used" not in q]
        assert len(first) == 2 and len(set(first)) == 1


def test_a_picture_is_judged_once() -> None:
    with scripted(obs="state+images", image_size=32) as model:
        plan = ["navigate aside", "navigate aside", "navigate aside"]
        report = run(model, "CC", planner=lambda request: plan, conditions="rule")
        questions = [text_of(asked) for asked in model.server.asked]
        pictures = [str(asked.body["messages"][-1]["content"])[-2000:] for asked in model.server.asked]
        alike = len(questions) - len(set(zip(questions, pictures, strict=True)))
        assert alike == 0
        assert report.usage.repeats


def test_what_is_known_is_asked_once_and_other_pictures_are_another_question() -> None:
    with scripted() as model:
        aside = ["navigate aside", "wait", "navigate aside"]
        known = FreeText.of("a robot may stand aside")
        seen = FreeText.of("the floor is dry")
        conditions = SimpleNamespace(before=lambda *_: [known, seen], after=lambda *_: [])
        run(model, "CC", planner=lambda request: aside, conditions=conditions)
        assert len(heard(model, "checker_known")) == 1
        assert len(heard(model, "checker_seen")) == 2


def test_an_adjuster_is_asked_each_time() -> None:
    with scripted() as model:
        adjuster = agent_of(model, "CC").roles.adjuster

        def twice(request: AdjustRequest) -> Advice:
            return [adjuster.adjust(request) for _ in range(2)][1]

        assert play(model.env, remac_agents.make("CC", adjuster=twice)).adjusted
        assert [name for name, _ in model.heard[:4]] == ["analysis", "adjustment"] * 2
        assert model.heard[0] == model.heard[2]
