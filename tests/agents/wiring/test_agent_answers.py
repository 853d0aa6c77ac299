"""Answers of roles: number, type and names are checked, for every role; what is refused is named with what is valid."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from agent_kitchens import play, suite_kitchen

import remac_agents
from remac_agents.adjusters.rule import RuleAdjuster
from remac_agents.plan import PlanError
from remac_agents.roles import Advice, Explanation, FreeText, Summary, Verdict
from remac_agents.wiring.answers import LONGEST, AnswerError
from remac_agents.wiring.catalogue import make_role
from remac_env.rules.conditions import Condition
from remac_env.rules.subtasks import Subtask

HALF = "half a pair: \ud83d"


def one(kitchen: str = "DefrostInBowl", method: str = "CC", **roles: Any) -> remac_agents.EpisodeReport:
    return play(suite_kitchen(kitchen, robots=1), remac_agents.make(method, **roles))


class Checks:
    """A checker that changes the true verdicts before it gives them."""

    needs_truth = True

    def __init__(self, change: Callable[[list[Verdict]], Any]) -> None:
        self.change, self.truth = change, make_role("checker", "truth")

    def check(self, conditions: Any, view: Any) -> Any:
        return self.change(self.truth.check(conditions, view))


OTHER = Condition("hand_empty", ("robot_9",))


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda verdicts: [], "0 verdicts for 1 conditions"),
        (lambda verdicts: verdicts[:-1], "0 verdicts for 1 conditions"),
        (lambda verdicts: [*verdicts, *verdicts], "more than"),
        (lambda verdicts: (v for v in [*verdicts, *verdicts]), "more than"),
        (lambda verdicts: None, "None"),
        (lambda verdicts: 7, "7"),
        (lambda verdicts: "true", "'true'"),
        (lambda verdicts: {v.condition: v.value for v in verdicts}, "Condition"),
        (lambda verdicts: set(verdicts), "a set, which has no order"),
        (lambda verdicts: dict.fromkeys(verdicts).keys(), "a dict_keys, which has no order"),
        (lambda verdicts: iter(set(verdicts)), "a set_iterator, which has no order"),
        (lambda verdicts: [v.value for v in verdicts], "True"),
        (lambda verdicts: [replace(v, value="false") for v in verdicts], "'false'"),
        (lambda verdicts: [replace(v, value=1) for v in verdicts], "gave 1;"),
        (lambda verdicts: [replace(v, condition=OTHER) for v in verdicts], "robot_9"),
        (lambda verdicts: [replace(v, reason=HALF) for v in verdicts], "ud83d"),
        (lambda verdicts: [replace(v, reason="x" * (LONGEST + 1)) for v in verdicts], f"{LONGEST + 1} characters"),
        (lambda verdicts: [replace(v, reason=None) for v in verdicts], "None"),
    ],
)
def test_verdicts_that_are_none(change: Any, told: str) -> None:
    with pytest.raises(AnswerError, match="checker Checks: check") as error:
        one(checker=Checks(change))
    assert told in str(error.value) and "; valid: " in str(error.value)


@pytest.mark.parametrize(
    "change",
    [
        lambda verdicts: verdicts[::-1],
        lambda verdicts: (verdict for verdict in verdicts),
        lambda verdicts: tuple(verdicts),
        lambda verdicts: np.array(verdicts, dtype=object),
        lambda verdicts: [replace(v, value=np.bool_(v.value)) for v in verdicts],
    ],
)
def test_verdicts_in_another_form_are_the_same(change: Any) -> None:
    assert one(checker=Checks(change)) == replace(one(), truth_readers=("checker",), isolated=False)


def test_a_checker_may_say_that_it_cannot_tell() -> None:
    asked = (Condition("hand_empty", ("robot_0",)), Condition("hand_full", ("robot_0",)))
    from remac_agents.wiring.answers import Answers

    read = Answers("checker", object()).verdicts([Verdict(c, None) for c in asked], asked)  # type: ignore[arg-type]
    assert [verdict.value for verdict in read] == [None, None]


class Says:
    """A conditions role that says the same before every subtask."""

    def __init__(self, answer: Any) -> None:
        self.answer, self.rule = answer, make_role("conditions", "rule")

    def before(self, subtask: Subtask, robot: str, view: Any) -> Any:
        return self.answer(self.rule.before(subtask, robot, view))

    def after(self, subtask: Subtask, robot: str, view: Any) -> Any:
        return self.rule.after(subtask, robot, view)


class Spy(Condition):
    """A condition that looks at the world when it is judged."""

    seen: list[Any] = []

    def holds(self, scene: Any, world: Any) -> bool:
        """Steals."""
        Spy.seen.append(world)
        return True


@pytest.mark.parametrize(
    ("answer", "told"),
    [
        (lambda c: set(c), "which has no order"),
        (lambda c: None, "None"),
        (lambda c: [condition.sentence for condition in c], "'"),
        (lambda c: [Condition("flies", ("robot_0",))], "predicate 'flies'"),
        (lambda c: [Condition("at", ("robot_0",))], "at of ('robot_0',)"),
        (lambda c: [Condition("at", ("robot_0", "moon"))], "moon"),
        (lambda c: [Condition("at", ["robot_0", "sink"])], "['robot_0', 'sink']"),  # type: ignore[arg-type]
        (lambda c: [FreeText.of(HALF)], "ud83d"),
        (lambda c: [Condition("hand_empty", ("robot_0",))] * 1000, "more than 100"),
    ],
)
def test_conditions_that_are_none(answer: Any, told: str) -> None:
    with pytest.raises(AnswerError, match="conditions Says: before") as error:
        one(conditions=Says(answer))
    assert told in str(error.value)


def test_a_condition_of_ones_own_is_judged_by_its_words_and_sees_no_world() -> None:
    report = one(conditions=Says(lambda c: [Spy(each.predicate, each.args) for each in c]))
    assert not Spy.seen and report.success
    assert report.pre_checks == one().pre_checks


class Advises:
    """An adjuster that changes the rules' advice."""

    needs_rules = True

    def __init__(self, change: Any) -> None:
        self.change, self.rule = change, RuleAdjuster()

    def adjust(self, request: Any) -> Any:
        return self.change(self.rule.adjust(request))


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda a: None, "gave None"),
        (lambda a: ["navigate to sink"], "['navigate to sink']"),
        (lambda a: replace(a, next_steps=(Subtask("pick up", "moon"),)), "'pick up moon' is not a command"),
        (lambda a: replace(a, next_steps=(Subtask("fly"),)), "fly"),
        (lambda a: replace(a, next_steps={Subtask("navigate to", "sink")}), "no order"),
        (lambda a: replace(a, next_steps=(Subtask("navigate to", "sink"),) * 300), "more than 200"),
        (lambda a: replace(a, row=("dance",)), "'dance' is not a command"),
        (lambda a: replace(a, row=7), "gave 7"),
        (lambda a: replace(a, remedy=(3,)), "gave 3"),
        (lambda a: replace(a, instead=Subtask("pick up", "moon")), "moon"),
        (lambda a: replace(a, reason=HALF), "ud83d"),
        (lambda a: replace(a, left_out="no"), "'no'"),
    ],
)
def test_advice_that_is_none(change: Any, told: str) -> None:
    with pytest.raises(AnswerError, match="adjuster Advises: adjust") as error:
        one(adjuster=Advises(change))
    assert told in str(error.value)


def test_advice_may_name_commands_by_their_text() -> None:
    def texts(advice: Advice) -> Advice:
        return replace(advice, next_steps=tuple(step.text for step in advice.next_steps))  # type: ignore[arg-type]

    assert one(adjuster=Advises(texts)) == replace(one(), isolated=False)


@pytest.mark.parametrize(
    ("answer", "told"),
    [
        ("a lesson that is not in a list", "'a lesson that is not in a list'"),
        ({"one", "two"}, "no order"),
        ([7], "gave 7"),
        ([HALF], "ud83d"),
        (["x" * 100_000], "100000 characters"),
        (["x"] * 1000, "more than 50"),
        (None, "None"),
    ],
)
@pytest.mark.parametrize("verb", ["reflect", "review"])
def test_lessons_that_are_none(verb: str, answer: Any, told: str) -> None:
    reflector = make_role("reflector", "rule")
    role = type("Teaches", (), {name: lambda self, *a, n=name, **k: (
        answer if n == verb else getattr(reflector, n)(*a, **k)) for name in ("reflect", "review")})()
    with pytest.raises(AnswerError, match=f"reflector Teaches: {verb}") as error:
        one(method="RE", reflector=role)
    assert told in str(error.value)


class Retells:
    """A summariser that says what it is told to say."""

    def __init__(self, summary: Any, explanation: Any) -> None:
        self.summary, self.explanation = summary, explanation

    def summarise(self, goal: str, steps: Any) -> Any:
        return self.summary

    def explain(self, request: Any) -> Any:
        return self.explanation


FINE = Summary(("something happened",), ())


@pytest.mark.parametrize(
    ("summary", "explanation", "told"),
    [
        (("a", "b"), None, "Summary"),
        (Summary("abc", ()), None, "'abc'"),  # type: ignore[arg-type]
        (Summary((HALF,), ()), None, "ud83d"),
        (Summary((), ("one line",)), None, "1 subgoals"),
        (FINE, "because", "'because'"),
        (FINE, Explanation("it", 99), "step 99"),
        (FINE, Explanation("it", True), "step True"),
        (FINE, Explanation(HALF), "ud83d"),
        (FINE, Explanation("it", 0, ("the door is shut",)), "the door is shut"),  # type: ignore[arg-type]
    ],
)
def test_summaries_and_causes_that_are_none(summary: Any, explanation: Any, told: str) -> None:
    with pytest.raises(AnswerError, match="summariser Retells: ") as error:
        one(method="REFLECT", summariser=Retells(summary, explanation))
    assert told in str(error.value)


@pytest.mark.parametrize(
    "answer",
    [
        {"navigate to sink", "navigate aside"},
        frozenset(["navigate to sink"]),
        {"navigate to sink": 1}.keys(),
        {1: "navigate to sink"}.values(),
        iter({"navigate to sink"}),
        {"robot_0": {"navigate to sink"}},
        {"robot_0": {"navigate to sink": 1}.keys()},
    ],
)
@pytest.mark.parametrize("method", ["BASE", "CAPE", "REFLECT"])
def test_plans_without_an_order_are_refused(method: str, answer: Any) -> None:
    report = one(method=method, planner=lambda request: answer)
    assert not report.success and report.executed == ()
    assert all("no order" in error and "valid: a list" in error for error in report.errors)


@pytest.mark.parametrize("method", ["BASE", "CAPE"])
def test_plans_with_an_order_are_taken(method: str) -> None:
    steps = ["navigate to sink", "turn on faucet", "navigate aside"]

    def parts(request: Any) -> list[str]:
        return steps[sum(attempt.ran for attempt in request.history) :]

    forms: list[Any] = [list, tuple, iter, np.array, lambda rows: (step for step in rows), dict.fromkeys]
    reports = [one(method=method, planner=lambda r, form=form: form(parts(r))) for form in forms[:-1]]
    assert all(report == reports[0] for report in reports)
    assert [step.subtask for step in reports[0].executed] == steps
    assert one(method=method, planner=lambda r: forms[-1](parts(r))).executed == ()


def test_words_of_an_error_are_made_printable() -> None:
    class Odd:
        def __str__(self) -> str:
            raise TypeError("no words")

    report = one(method="BASE", planner=lambda request: PlanError(Odd()))  # type: ignore[arg-type]
    assert set(report.errors) == {"<unprintable Odd>"}
    assert one(method="BASE", planner=lambda request: PlanError(HALF)).errors[0] == "half a pair: \\ud83d"


class Turncoat:
    """Says that it needs no truth, and changes its mind."""

    asked = 0
    worlds: list[Any] = []

    @property
    def needs_truth(self) -> bool:
        """False, the first time."""
        Turncoat.asked += 1
        return Turncoat.asked > 1

    def plan(self, request: Any) -> Any:
        """Looks for the world."""
        Turncoat.worlds.append(request.world)
        return []


def test_what_a_role_needs_is_read_once() -> None:
    report = one(method="BASE", planner=Turncoat(), checker="none")
    assert Turncoat.asked == 1 and Turncoat.worlds == [None] and report.truth_readers == ()
