"""The comparison of the backends sees what it should, and finds nothing in an episode that goes well."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import pytest
import twin

import remac_env
from remac_env.rules.outcomes import Outcome, failure
from remac_env.state import Place


@pytest.fixture
def kitchen():
    env = remac_env.parallel_env("OpenCabinetPnP", robots=1)
    env.reset(seed=11)
    yield env
    env.close()


def driven(env) -> tuple:
    """The world before a drive to the cabinet, the joint subtask, and what came of it."""
    before, subtask = env.world, env.vocabulary.parse("navigate to cabinet")
    _, _, _, _, infos = env.step({"robot_0": env.vocabulary.encode(subtask.text)})
    told = infos["robot_0"]["outcome"]
    return before, {"robot_0": subtask}, {"robot_0": Outcome(**told | {"reason": told["reason"] or None})}


def test_a_round_as_foretold_agrees(kitchen) -> None:
    (line,) = twin.compare(kitchen, *driven(kitchen))
    assert (line.verdict, line.foretold, line.happened, line.differs) == ("agree", "success", "success", "")
    assert line.layout == kitchen.start.layout


@pytest.mark.parametrize(
    ("happened", "verdict"),
    [(failure("blocked", "planted"), "disagree"), (failure("slipped", "planted"), "slip")],
)
def test_a_planted_outcome_is_found(kitchen, happened: Outcome, verdict: str) -> None:
    before, joint, _ = driven(kitchen)
    (line,) = twin.compare(kitchen, before, joint, {"robot_0": happened})
    assert (line.verdict, line.happened) == (verdict, happened.reason)
    assert "planted" in line.differs


def test_a_world_that_differs_is_found(kitchen) -> None:
    before, joint, outcomes = driven(kitchen)
    ajar = before.with_fixture("cabinet", door="ajar")
    (line,) = twin.compare(kitchen, ajar, joint, outcomes)
    assert line.verdict == "disagree"
    assert "door='ajar'" in line.differs and "door='closed'" in line.differs


def test_what_both_backends_read_from_one_function_is_told_apart(kitchen) -> None:
    """A refusal is no proof of agreement; a drive, and a closed door that is tried, are."""
    (line,) = twin.compare(kitchen, *driven(kitchen))
    assert not line.by_rule
    before, subtask = kitchen.world, kitchen.vocabulary.parse("turn on stove")
    _, _, _, _, infos = kitchen.step({"robot_0": kitchen.vocabulary.encode("turn on stove")})
    told = infos["robot_0"]["outcome"]
    outcomes = {"robot_0": Outcome(**told | {"reason": told["reason"] or None})}
    (line,) = twin.compare(kitchen, before, {"robot_0": subtask}, outcomes)
    assert line.by_rule and line.foretold == "not_at_station" and line.verdict == "agree"


def test_a_thing_that_fell_out_of_a_hand_is_listed_apart(kitchen) -> None:
    before, joint, outcomes = driven(kitchen)
    obj = next(iter(before.objects))
    held = before.with_robot("robot_0", holding=obj).with_object(obj, place=Place("held", "robot_0"))
    fallen = kitchen.world.with_object(obj, place=Place("floor"))
    after = SimpleNamespace(worlds=kitchen.worlds, start=kitchen.start, world=fallen)
    (line,) = twin.compare(after, held, joint, outcomes)
    assert line.verdict == "slip"
    elsewhere = SimpleNamespace(worlds=kitchen.worlds, start=kitchen.start, world=kitchen.world)
    (line,) = twin.compare(elsewhere, held, joint, outcomes)
    assert line.verdict == "disagree" and obj in line.differs


@pytest.mark.long
def test_commands_are_spread_over_skills_and_reasons() -> None:
    lines = twin.play("OpenMicrowavePnP", 1, 78, 16)
    assert [line for line in lines if line.verdict != "agree"] == []
    strata = {(line.skill, line.foretold) for line in lines}
    assert len(strata) >= 8
    assert {"success"} < {reason for _, reason in strata}


def test_the_same_seed_plays_the_same() -> None:
    lines, again = (twin.play("OpenMicrowavePnP", 1, 78, 3) for _ in range(2))
    assert [replace(line) for line in again] == lines
