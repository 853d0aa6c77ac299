"""Language models in the roles, played by the tests' own endpoint: every method succeeds, fails and ends as told."""

from __future__ import annotations

import pytest
from agent_kitchens import play
from scripted_model import RIGHT, agent_of, scripted

import remac_agents

METHODS = remac_agents.methods()


@pytest.mark.parametrize("method", METHODS)
def test_a_model_that_answers_well_succeeds(method: str) -> None:
    with scripted() as model:
        if method.startswith(("BASE", "human")):
            model.plan_before = RIGHT
        agent = agent_of(model, method)
        reports = [play(model.env, agent) for _ in range(3 if agent.method.iterates else 1)]
        for report in reports:
            assert report.success, report.errors
            assert report.errors == ()
            assert report.infrastructure is None
            assert report.truth_readers == ()
        played_again = method.endswith("BEST")
        assert all(report.exchanges for report in reports[: 1 if played_again else 3])
        if method in ("RE", "REMAC"):
            assert reports[0].adjusted and not reports[1].adjusted
            assert reports[1].initial_plan_length == 6
            assert reports[0].reflections[0].startswith("Why: a full hand opens no door. To avoid it: open it first.")
        if method == "REMAC":
            assert len(reports[2].initial_plan) == 2
            assert reports[2].initial_plan_length == 4


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("word", ["", "no idea", '{"x": 1}', "Plan: [open the pod bay doors]", "[]", "{}"])
def test_a_model_that_answers_badly_is_a_failure_of_the_agent_and_ends(method: str, word: str) -> None:
    with scripted() as model:
        model.answers = dict.fromkeys(remac_agents.prompting.prompt.names(), word or " ")
        report = play(model.env, agent_of(model, method))
        assert not report.success
        assert report.infrastructure is None
        assert report.errors or word in ("[]", "{}")


ONE = [step.strip() for step in RIGHT.split(",")]


@pytest.mark.parametrize(
    ("answers", "rows"),
    [
        ([f"robot_0: [{', '.join(ONE[2:])}]\nrobot_1: [{', '.join(ONE[:2])}, navigate aside]"], 2),
        (["alone"], 1),
        (["<think>robot_1 could help</think>\n**Alone.**"], 1),
        ([f"robot_0: [{', '.join(ONE)}]"], 1),
        (["robot_7: [wait]", "robot_0: [fly]", "no idea"], 1),
        (["robot_7: [wait]", "alone"], 1),
    ],
)
def test_a_model_shares_a_plan_or_declines(answers: list[str], rows: int) -> None:
    with scripted() as model:
        told = list(answers)
        model.answers = {"handover": lambda user: told.pop(0)}
        handover = {"name": "custom:scripted", "base_url": model.server.url}
        agent = remac_agents.make("REMAC", handover=handover)
        reports = [play(model.env, agent) for _ in range(3)]
        assert all(report.success for report in reports) and not told
        assert len(reports[2].initial_plan) == rows
        heard = [user for name, user in model.heard if name == "handover"]
        assert f"robot_0: [{RIGHT}]" in heard[0] and "Before" in heard[0]
        assert reports[2].exchanges[0].role == "handover"
        assert ("handover: " in " ".join(reports[2].errors)) == (len(answers) == 3)
