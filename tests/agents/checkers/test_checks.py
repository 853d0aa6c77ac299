"""Three kinds of conditions, verdicts that cannot tell, and conditions in other words."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import pytest
from agent_kitchens import play, suite_kitchen
from chaos_server import Asked
from scripted_model import PICTURES, ScriptedModel, run, scripted

import remac_agents
from remac_agents.methods import METHODS
from remac_agents.prompting.prompt import load
from remac_agents.roles import FreeText, Ran, Report, Verdict, View
from remac_env.errors import OptionError, RemacError
from remac_env.rules.conditions import Condition, Denial, condition, denied
from remac_env.rules.predicates import PREDICATES
from remac_env.rules.scene import public_scene
from remac_env.rules.sentences import predicate_of, read_condition, sentence_forms
from remac_env.rules.skills import marks
from remac_env.sights import CAMERAS

TASK = "DefrostInBowl"


def kitchen(task: str = TASK) -> Any:
    env = suite_kitchen(task)
    env.reset(seed=3)
    return env


def view_of(env: Any, *, images: Any = None, holding: Any = None, world: Any = None) -> View:
    held = dict.fromkeys(env.start.scene.robots) if holding is None else holding
    seen = dict.fromkeys(held, PICTURES) if images is None else images
    return View("defrost", public_scene(env.start.scene), held, {}, seen, world)


def checker_of(model: ScriptedModel) -> Any:
    return remac_agents.make("CC", model="custom:scripted", base_url=model.server.url).roles.checker


def asked(model: ScriptedModel) -> list[str]:
    return [name for name, _ in model.heard]


def listed(user: str) -> list[str]:
    return re.findall(r"^\d+\. (.*)$", user, re.M)


def pictures_in(request: Asked) -> int:
    told = request.body["messages"][-1]["content"]
    return 0 if isinstance(told, str) else sum(part["type"] == "image_url" for part in told)


# -- kinds ----------------------------------------------------------------------------------------------------------


def test_every_predicate_has_a_kind_and_the_vessel_rule_is_knowledge() -> None:
    kinds = {name: Condition(name, ()).kind for name in PREDICATES}
    assert {name for name, kind in kinds.items() if kind == "felt"} == {
        "hand_empty",
        "hand_full",
        "holding",
        "holds_shaker",
    }
    assert kinds["no_vessel_needed"] == kinds["graspable"] == "known"
    assert kinds["door_open"] == kinds["at"] == kinds["unloaded"] == kinds["inside"] == "seen"
    assert denied(condition("no_vessel_needed", "robot_0", "sink")).kind == "known"
    assert FreeText.of("the fish must lie in a bowl before it touches the sink").kind == "known"
    assert FreeText.of("the water runs over the fish").kind == "seen"
    assert FreeText.of("the lid must be shut").kind == "seen"


def test_what_is_felt_is_the_truth_about_the_gripper_and_nobody_is_asked() -> None:
    with scripted(TASK) as model:
        scene = model.env.start.scene
        obj, robot = next(iter(scene.objects)), scene.robots[-1]
        conditions = [condition("holding", robot, obj), condition("hand_empty", robot), condition("hand_full", robot)]
        view = view_of(model.env, holding={robot: obj}, images={})
        checker = checker_of(model)
        assert [verdict.value for verdict in checker.check(conditions, view)] == [True, False, True]
        denials = [denied(c) for c in conditions]
        assert [verdict.value for verdict in checker.check(denials, view)] == [False, True, False]
        assert {verdict.reason for verdict in checker.check(conditions, view)} == {"felt in the gripper"}
        assert model.heard == []


def test_nobody_is_asked_whether_a_fixture_is_in_its_place() -> None:
    with scripted(TASK) as model:
        checker, view = checker_of(model), view_of(model.env)
        assert checker.check([condition("placed", "sink")], view)[0].value is True
        assert model.heard == []
        checker.check([condition("placed", "bowl")], view)
        assert asked(model) == ["checker_seen"]


def test_each_kind_is_asked_in_its_own_words() -> None:
    with scripted(TASK) as model:
        robot = "robot_0"
        conditions = [
            condition("no_vessel_needed", robot, "sink"),
            condition("hand_empty", robot),
            condition("door_open", "microwave"),
            FreeText.of("the bowl must hold the food before it touches the sink"),
        ]
        verdicts = checker_of(model).check(conditions, view_of(model.env))
        assert [verdict.condition for verdict in verdicts] == conditions
        told = dict(model.heard)
        assert asked(model) == ["checker_known", "checker_seen"]
        assert listed(told["checker_known"]) == [conditions[0].sentence, conditions[3].sentence]
        assert listed(told["checker_seen"]) == [conditions[2].sentence]
        assert [pictures_in(request) for request in model.server.asked] == [0, 2]
        assert "holds nothing" in told["checker_known"]


def test_no_rule_stands_under_words_that_forbid_to_judge_it() -> None:
    known = load("checker_known")
    assert not re.search(r"not what (should|ought)|do not judge|judge what you see", known.system, re.I)
    assert re.search(r"right|allowed", known.system + known.user)
    assert "Judge what is, not what should be" in load("checker_seen").system


def test_questions_are_the_same_for_the_same_moment() -> None:
    with scripted(TASK) as model:
        conditions = [condition("door_open", "microwave"), condition("no_vessel_needed", "robot_0", "sink")]
        for _ in range(2):
            checker_of(model).check(conditions, view_of(model.env))
        assert model.heard[:2] == model.heard[2:]


# -- what a checker is told ------------------------------------------------------------------------------------------


def test_marks_are_judged_by_what_was_run_and_no_picture_is_asked_for() -> None:
    with scripted(TASK) as model:
        obj = next(iter(model.env.start.scene.objects))
        ran = (Ran(1, "robot_0", "turn on faucet", True), Ran(2, "robot_0", f"pick up {obj}", False))
        view = replace(view_of(model.env, images={}), ran=ran)
        model.answers = {"checker_ran": verdicts(None)}
        for stated in (condition("marked", obj, "washed"), denied(condition("marked", obj, "washed"))):
            assert [verdict.value for verdict in checker_of(model).check([stated], view)] == [None]
        assert asked(model) == ["checker_ran", "checker_ran"]
        told = model.heard[0][1]
        assert f"1. robot_0: turn on faucet: success\n2. robot_0: pick up {obj}: failure" in told
        assert "none yet" not in told and [pictures_in(request) for request in model.server.asked] == [0, 0]


def test_a_sentence_that_names_no_robot_is_about_the_one_whose_command_is_checked() -> None:
    with scripted(TASK, robots=2) as model:
        reports = {
            "robot_0": Report("success", None, "wait"),
            "robot_1": Report("failure", "blocked", "open microwave door"),
        }
        sentences = [condition("door_open", "microwave"), FreeText.of("the fish may be put there")]
        for robot in ("robot_1", ""):
            view = replace(view_of(model.env), robot=robot, reports=reports)
            checker_of(model).check(sentences, view)
        (known, one), (_, all_of_them) = (told[1] for told in model.heard[:2]), (told[1] for told in model.heard[2:])
        assert "robot_1, side camera; robot_1, wrist camera." in one and "robot_0, side" not in one
        assert "Last commands: robot_1: open microwave door: failure (blocked)." in one
        assert "Grippers: robot_1 holds nothing." in one and "Grippers: robot_1 holds nothing." in known
        assert "Last commands: robot_0: waited; robot_1: open microwave door: failure (blocked)." in all_of_them
        assert "robot_0, side camera" in all_of_them and "robot_1, side camera" in all_of_them
        checker_of(model).check([condition("at", "robot_0", "sink")], replace(view_of(model.env), robot="robot_1"))
        assert "robot_0, side camera; robot_0, wrist camera." in model.heard[-1][1]


def test_a_checker_is_told_colours_cameras_things_and_room() -> None:
    with scripted(TASK, robots=2) as model:
        checker_of(model).check([condition("room", "robot_0", "sink")], view_of(model.env))
        told, scene = model.heard[0][1], public_scene(model.env.start.scene)
        assert "robot_0 blue, robot_1 orange" in told and "front camera" not in told
        for camera in ("side", "wrist"):
            assert f"The {camera} camera {CAMERAS[camera]}." in told
        assert f"Things: {', '.join(scene.objects)}." in told and "take one thing each" in told


def test_reports_in_runs_name_their_commands() -> None:
    with scripted(TASK, robots=2) as model:
        run(model, "CC", planner=lambda request: {"robot_1": ["navigate to sink", "wait", "turn on faucet"]})
        told = [user for name, user in model.heard if name == "checker_seen"]
        assert any("Last commands: robot_1: navigate to sink: success." in user for user in told)
        assert not any("robot_0, side camera" in user for user in told)


# -- cannot tell ----------------------------------------------------------------------------------------------------


def verdicts(*values: Any) -> str:
    return json.dumps({"verdicts": list(values), "reasons": ["because"] * len(values)})


def test_what_cannot_be_told_is_looked_at_again_with_the_other_pictures() -> None:
    with scripted(TASK) as model:
        given = iter([verdicts(None, True), verdicts(False)])
        model.answers = {"checker_seen": lambda user: next(given)}
        conditions = [condition("door_open", "microwave"), condition("at", "robot_0", "sink")]
        found = checker_of(model).check(conditions, view_of(model.env))
        assert [verdict.value for verdict in found] == [False, True]
        first, second = (user for _, user in model.heard)
        assert "robot_0, side camera; robot_0, wrist camera" in first and "front" not in first
        assert "robot_0, front camera" in second and "robot_0, side camera" not in second
        assert listed(second) == [conditions[0].sentence]


@pytest.mark.parametrize("word", [None, "cannot tell", "Unknown.", "null"])
def test_knowledge_that_hangs_on_what_is_seen_is_asked_again_with_pictures(word: Any) -> None:
    with scripted(TASK) as model:
        given = iter([verdicts(word), verdicts(True)])
        model.answers = {"checker_known": lambda user: next(given)}
        (verdict,) = checker_of(model).check([condition("no_vessel_needed", "robot_0", "sink")], view_of(model.env))
        assert (verdict.value, verdict.reason) == (True, "because")
        assert [pictures_in(request) for request in model.server.asked] == [0, 6]


@pytest.mark.parametrize("answer", ["no idea", '{"verdicts": []}', '{"verdicts": [1, 2]}', verdicts(True, True)])
def test_an_answer_that_is_of_no_use_is_no_verdict(answer: str) -> None:
    with scripted(TASK) as model:
        model.answers = {"checker_seen": answer}
        (verdict,) = checker_of(model).check([condition("door_open", "microwave")], view_of(model.env))
        assert verdict.value is None and verdict.reason.startswith("not judged: ")


class Blindfolded:
    """A checker that never can tell."""

    def check(self, conditions: Sequence[Condition], view: View) -> list[Verdict]:
        return [Verdict(condition, None, "too dark") for condition in conditions]


@pytest.mark.parametrize("method", remac_agents.methods())
def test_a_checker_that_cannot_tell_lets_every_method_go_on_and_end(method: str) -> None:
    agent = remac_agents.make(method, checker=Blindfolded())
    reports = [play(suite_kitchen(TASK), agent) for _ in range(2)]
    for report in reports:
        checks = (*report.pre_checks, *report.post_checks)
        assert {check.verdict for check in checks} <= {None}
        assert {check.reason for check in checks} <= {"too dark"}
        assert not report.success and report.retries == 0
        assert not report.adjusted or method.startswith("REFLECT")
    assert any(report.pre_checks for report in reports) == METHODS[method].checks
    assert not any(run.adjusted for run in agent.memory.all_runs())


def test_cc_without_verdicts_plays_as_base_does() -> None:
    base = play(suite_kitchen(TASK), remac_agents.make("BASE"))
    for checker in (Blindfolded(), "none"):
        report = play(suite_kitchen(TASK), remac_agents.make("CC", checker=checker))
        assert [step.subtask for step in report.executed] == [step.subtask for step in base.executed]


def test_denials_are_conditions_of_a_role_too() -> None:
    class Denying:
        def __init__(self, *conditions: Any) -> None:
            self.conditions = list(conditions)

        def before(self, subtask: Any, robot: str, view: View) -> list[Condition]:
            return self.conditions

        def after(self, subtask: Any, robot: str, view: View) -> list[Condition]:
            return []

    there = Denying(denied(condition("inside", "bowl", "sink")))
    report = play(suite_kitchen(TASK), remac_agents.make("CC", conditions=there))
    assert {check.verdict for check in report.pre_checks} == {True}
    for bad in (denied(condition("inside", "tray", "sink")), Denial("not", ()), denied(denied(there.conditions[0]))):
        with pytest.raises(RemacError):
            play(suite_kitchen(TASK), remac_agents.make("CC", conditions=Denying(bad)))


def test_a_model_that_cannot_tell_is_recorded_so() -> None:
    with scripted(TASK) as model:
        dark = lambda user: verdicts(*[None] * len(listed(user)))  # noqa: E731
        model.answers = {"checker_seen": dark, "checker_known": dark}
        report = run(model, "CC", planner="literal", conditions="rule", adjuster="rule", reflector="rule")
        untold = [check for check in report.pre_checks if check.verdict is None]
        answered = {check.reason for check in report.pre_checks if check.verdict is not None}
        assert untold and answered == {"felt in the gripper", "fixtures stay in their places"}
        assert {predicate_kind(check.condition) for check in untold} == {"seen", "known"}
        assert report.infrastructure is None and not report.adjusted


def predicate_kind(sentence: str) -> str:
    predicate = predicate_of(sentence)
    assert predicate is not None
    return Condition(predicate, ()).kind


def test_a_model_that_misreads_the_vessel_rule_is_found_out_by_kind() -> None:
    """Planted: everything is allowed. The audit shows it where it belongs: in what is known."""
    with scripted(TASK) as model:
        model.answers = {"checker_known": lambda user: verdicts(*[True] * len(listed(user)))}
        report = run(model, "CC", planner="literal", conditions="rule", adjuster="rule", reflector="rule")
        wrong = [check for check in report.pre_checks if check.verdict is not None and check.verdict != check.truth]
        assert {predicate_of(check.condition) for check in wrong} == {"no_vessel_needed"}
        assert not report.success
        right = run(model, "CC", planner="literal", checker="truth", conditions="rule", adjuster="rule")
        assert right.success


# -- pictures -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", remac_agents.methods())
def test_without_pictures_a_checker_with_eyes_is_refused_before_anything_is_asked(method: str) -> None:
    with scripted(TASK, pictures=False) as model:
        agent = remac_agents.make(method, model="custom:scripted", base_url=model.server.url)
        obs, infos = model.env.reset(seed=3)
        if not METHODS[method].checks:  # nobody looks there
            assert agent.picture_viewers == ()
            agent.reset(obs, infos)
            return
        assert agent.picture_viewers == ("checker",)
        with pytest.raises(OptionError, match=r'checker of .* valid: .*obs="state\+images"'):
            agent.reset(obs, infos)
        assert model.heard == []


def test_a_view_without_pictures_is_nobodys_verdict() -> None:
    with scripted(TASK) as model:
        checker = checker_of(model)
        with pytest.raises(remac_agents.StopEpisode, match=r"obs=.state\+images") as stopped:
            checker.check([condition("door_open", "microwave")], view_of(model.env, images={}))
        assert stopped.value.infrastructure and model.heard == []


@pytest.mark.parametrize("given", ["deepseek:deepseek-reasoner", "DeepSeek-R1"])
def test_a_model_without_eyes_is_no_checker_and_hears_what_is(given: str) -> None:
    with pytest.raises(OptionError, match=r"takes no images.*valid: .*'truth'.*'none'"):
        remac_agents.make("CC", checker=given)


# -- other words ----------------------------------------------------------------------------------------------------

SAME = {
    "The gripper of robot_0 is empty.": ("hand_empty", "robot_0"),
    "robot_0's gripper is empty": ("hand_empty", "robot_0"),
    "robot_0 holds nothing": ("hand_empty", "robot_0"),
    "robot_0 is not holding anything": ("hand_empty", "robot_0"),
    "its gripper is empty": ("hand_empty", "robot_0"),
    "the robot does not hold anything": ("hand_empty", "robot_0"),
    "robot_1 is holding a bowl": ("holding", "robot_1", "bowl"),
    "the bowl is in robot_1's gripper": ("holding", "robot_1", "bowl"),
    "the gripper of robot_0 isn't empty": ("hand_full", "robot_0"),
    "the bowl is inside the sink": ("inside", "bowl", "sink"),
    "the sink contains the bowl": ("inside", "bowl", "sink"),
    "There is a bowl in the sink": ("inside", "bowl", "sink"),
    "the bowl is on top of the counter": ("inside", "bowl", "counter"),
    "the microwave's door is shut": ("door_closed", "microwave"),
    "the door of the cabinet is not open": ("door_not_open", "cabinet"),
    "the cabinet is open": ("door_open", "cabinet"),
    "the faucet is on": ("switched_on", "faucet"),
    "the faucet is turned off": ("all_off", "faucet"),
    "the stove is not currently on": ("switched_off", "stove"),
    "robot_0 is standing next to the sink": ("at", "robot_0", "sink"),
    "the robot has reached the sink": ("at", "robot_0", "sink"),
    "the bowl is empty": ("unloaded", "bowl"),
    "the sink has enough space for what robot_0 holds": ("room", "robot_0", "sink"),
    "the bowl is not in the sink": ("not", "inside", "bowl", "sink"),
    "robot_0 is not holding the bowl": ("not", "holding", "robot_0", "bowl"),
    "it is not true that robot_0 is at the sink": ("not", "at", "robot_0", "sink"),
    "the microwave door must be open": ("door_open", "microwave"),
    "the bowl should not be in the sink": ("not", "inside", "bowl", "sink"),
    "robot_0 has to stand at the sink": ("at", "robot_0", "sink"),
    "robot_0 must not hold anything": ("hand_empty", "robot_0"),
}
OTHER = (
    "robot_9 is at the sink",
    "the bowl is clean",
    "the path is clear",
    "the bowl is near the sink",
    "robot_0 and robot_1 hold nothing",
    "it is not so that the bowl is not in the sink",
    "the dishwasher is open",
    "the b\u043ewl is in the sink",
    "",
)


@pytest.mark.parametrize("text", SAME)
def test_other_words_are_matched(text: str) -> None:
    found = read_condition(text, public_scene(kitchen().start.scene), robot="robot_0")
    assert found is not None and (found.predicate, *found.args) == SAME[text]


@pytest.mark.parametrize("text", OTHER)
def test_what_says_something_else_is_not_matched(text: str) -> None:
    assert read_condition(text, public_scene(kitchen().start.scene), robot="robot_0") is None


@pytest.mark.parametrize("task", ["DefrostInBowl", "HeatOnStove"])
def test_every_sentence_and_its_denial_come_back(task: str) -> None:
    env = kitchen(task)
    scene, world = env.start.scene, env.world
    names = {"robot": scene.robots, "fixture": scene.fixtures, "object": scene.objects}
    firsts = {kind: tuple(found)[-1] for kind, found in names.items()}
    vessel = next(name for name, facts in scene.objects.items() if facts.holds)
    door = next(name for name, facts in scene.fixtures.items() if facts.door)
    switch = next(name for name, facts in scene.fixtures.items() if facts.switches)
    firsts |= {"thing": firsts["object"], "vessel": vessel, "door": door, "switch": switch, "mark": "washed"}
    assert len(sentence_forms()) == len(PREDICATES) + len(marks()) - 1
    assert not any("MARK" in form for form in sentence_forms())
    assert {"the OBJECT has been washed", "the OBJECT has been seasoned"} <= set(sentence_forms())
    for predicate, row in PREDICATES.items():
        stated = Condition(predicate, tuple(firsts[kind] for kind in row.about))
        assert read_condition(stated.sentence, public_scene(scene)) == stated
        assert predicate_of(stated.sentence) == predicate
        denial = read_condition(denied(stated).sentence, public_scene(scene))
        assert denial == denied(stated)
        assert predicate_of(denied(stated).sentence) == f"not {predicate}"
        if not row.settled:
            assert denial.holds(scene, world) is not stated.holds(scene, world)


def test_words_that_match_nothing_are_never_true_and_are_counted() -> None:
    class Poet:
        def before(self, subtask: Any, robot: str, view: View) -> list[Condition]:
            return [FreeText.of("all is well in this kitchen")]

        def after(self, subtask: Any, robot: str, view: View) -> list[Condition]:
            return []

    for checker in ("truth", {"name": "noisy", "false_alarm": 1.0, "miss": 1.0}):
        report = play(suite_kitchen(TASK), remac_agents.make("CC", conditions=Poet(), checker=checker))
        assert report.pre_checks
        assert {(check.verdict, check.truth, check.unmatched) for check in report.pre_checks} == {(None, None, True)}
