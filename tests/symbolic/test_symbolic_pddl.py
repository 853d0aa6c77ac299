"""Episodes as PDDL: facts are declared, plans of ours are plans of the domain, and plans are read and played back."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import pytest

import remac_env
from remac_env.errors import OptionError, UnknownNameError
from remac_env.oracle import solve
from remac_env.pddl import play_plan, read_plan, unsaid, write_domain, write_problem
from remac_env.pddl.actions import Action, actions
from remac_env.pddl.plans import Step
from remac_env.pddl.writing import _neat, _now, _static, _wanted
from remac_env.rules.rounds import transition
from remac_env.rules.subtasks import WAIT, Subtask

TASKS = remac_env.tasks()


def kitchen(task: str, robots: int = 1, **options: Any) -> Any:
    env = remac_env.parallel_env(task, robots=robots, backend="symbolic", clock="events", **options)
    env.reset(seed=1)
    return env


def facts_of(env: Any, world: Any) -> set[str]:
    return {*_static(env.start.scene), *_neat(env.goal), *_now(env.start.scene, world)}


def ways(action: Action, facts: set[str], given: dict[str, str]) -> list[dict[str, str]]:
    """Every way to fill in an action's variables so that its precondition is among the facts."""
    found = [given]
    for need in action.before:
        name, *arguments = need.split()
        grown = []
        for binding in found:
            free = {f"?{a[1:]}": rf"(?P<{a[1:]}>\S+)" for a in arguments if a[0] == "?" and a[1:] not in binding}
            pattern = [free.get(a) or re.escape(binding.get(a[1:], a)) for a in arguments]
            shape = re.compile(" ".join([re.escape(name), *pattern]))
            grown += [binding | match.groupdict() for fact in facts if (match := shape.fullmatch(fact))]
        found = grown
    return found


def effect(action: Action, binding: dict[str, str], facts: set[str]) -> set[str]:
    def filled(names: tuple[str, ...]) -> set[str]:
        return {" ".join(binding[part[1:]] if part[0] == "?" else part for part in name.split()) for name in names}

    gone = filled((*action.gone, *action.at_once))
    return (facts - gone) | filled(action.after)


def apart_from_neatness(facts: set[str]) -> set[str]:
    """What a vessel is right for is said of the goal's vessels alone."""
    return {fact for fact in facts if not fact.startswith("neatly")}


@pytest.mark.parametrize("task", TASKS)
def test_the_shortest_plan_is_a_plan_of_the_domain(task: str) -> None:
    """Whatever succeeds by the skill table succeeds by the domain, and comes to the same facts."""
    env = kitchen(task)
    rules, world = env.start.scene, env.world
    plan = solve(rules, world, env.goal)
    assert plan is not None
    known, facts = actions(rules), facts_of(env, world)
    for joint in plan.rounds:
        ((robot, subtask),) = joint.items()
        if subtask == WAIT:
            continue
        world, outcomes = transition(rules, world, joint)
        assert outcomes[robot].success
        target = facts_of(env, world)
        fitting = [action for action in known if action.skill == subtask.skill]
        results = [effect(action, way, facts) for action in fitting for way in ways(action, facts, {"r": robot})]
        for action in known:  # what happens by itself
            if not action.skill:
                after = [effect(action, way, each) for each in results for way in ways(action, each, {})]
                results = after or results
        near = [each for each in results if apart_from_neatness(each) == apart_from_neatness(target)]
        assert near, f"{subtask.text}: no action comes to the same facts"
        facts = max(near, key=len)
    assert {fact for atom in env.goal.atoms() for fact in _wanted(rules, atom)} <= facts


@pytest.mark.parametrize("level", ["strips", "durative"])
@pytest.mark.parametrize("robots", [1, 2])
def test_every_fact_is_declared_and_brackets_close(level: str, robots: int) -> None:
    env = kitchen("WashPnPHeat", robots)
    rules = env.start.scene
    domain, problem = write_domain(rules, level=level), write_problem(rules, env.world, env.goal, level=level)
    declared = set(re.findall(r"^    \((\S+)", domain.partition("(:predicates")[2].partition("\n  )")[0], re.M))
    for text in (domain, problem):
        assert text.count("(") == text.count(")") and "=" not in re.sub(r"\(= \?duration", "", text)
    words = {"and", "not", "at", "over", "all", "start", "end"}
    used = set(re.findall(r"\((\w[\w-]*) [?\w]", domain.partition("(:predicates")[2])) - words
    assert {name for name in used if not name.startswith(":")} - declared <= {"total-time"}
    facts = problem.partition("(:init")[2].partition("\n  )")[0]
    assert set(re.findall(r"\((\w[\w-]*)", facts)) <= declared, "strict planners refuse what is not declared"
    assert (":durative-actions" in domain) == (level == "durative")


def test_a_plan_is_read_and_played_back() -> None:
    env = kitchen("OpenCabinetPnP", 1, layout="one_wall_large")
    text = """; Cost: 44.0
0.000: (drive-by-aside-to-by-cabinet robot_0) [6.000]
6.001: (open-cabinet robot_0 by-cabinet) [9.000]
15.002: (drive-by-cabinet-to-by-counter_right robot_0) [6.000]
21.003: (pick-up robot_0 by-counter_right vegetable slot-counter_3 counter) [8.000]
29.004: (drive-by-counter_right-to-by-cabinet robot_0) [6.000]
35.005: (place-neatly robot_0 by-cabinet vegetable plate slot-cabinet_0 cabinet n0 n1) [9.000]
"""
    plan = read_plan(text, env.start.scene)
    assert plan[3] == Step(21.003, "robot_0", "pick up", "vegetable", 8.0) and plan[1].target == "cabinet"
    played = play_plan(env, plan, seed=1)
    assert (played.success, played.seconds, played.failed) == (True, 44.0, ())
    classical = re.sub(r"^[\d.]+: |\s*\[[\d.]+\]", "", text, flags=re.M)
    assert play_plan(env, read_plan(classical, env.start.scene), seed=1).success
    worse = [step for step in plan if step.skill != "open door"]
    told = play_plan(env, worse, seed=1)
    assert not told.success and any("door_closed" in each for each in told.failed)


RINSING = """0.000: (drive-by-aside-to-by-sink robot_0) [6.000]
6.001: (turn-on-faucet robot_0 by-sink) [7.000]
13.002: (drive-by-sink-to-by-microwave robot_0) [6.000]
19.003: (open-microwave robot_0 by-microwave) [9.000]
28.004: (drive-by-microwave-to-by-counter_right robot_0) [6.000]
34.005: (pick-up robot_0 by-counter_right fish slot-counter_4 counter) [8.000]
42.006: (drive-by-counter_right-to-by-microwave robot_0) [6.000]
48.007: (place robot_0 by-microwave fish slot-microwave_0 microwave) [9.000]
57.008: (drive-by-microwave-to-by-counter_island_left robot_0) [6.000]
63.009: (pick-up robot_0 by-counter_island_left vegetable slot-island_2 counter) [8.000]
71.010: (drive-by-counter_island_left-to-by-sink robot_0) [6.000]
77.011: (place robot_0 by-sink vegetable slot-sink_0 sink) [9.000]
86.012: (faucet-washed vegetable slot-sink_0) [20.000]
99.012: (turn-off-faucet robot_0 by-sink) [7.000]
"""
"""A plan of Kairos' for RinseAndStow: the water is turned off once the vegetable has been under it for long enough."""


def test_what_takes_its_time_is_waited_for_when_a_plan_is_played() -> None:
    env = remac_env.parallel_env("RinseAndStow", robots=1, backend="symbolic", clock="events", layout="one_wall_large")
    env.reset(seed=0)
    plan = read_plan(RINSING, env.start.scene)
    (rinsing,) = plan[-1].awaits
    assert (rinsing.process.name, rinsing.name) == ("rinsing", "vegetable") and rinsing.seconds == pytest.approx(13.0)
    assert plan[-2].awaits == ()
    played = play_plan(env, plan, seed=0)
    assert (played.success, played.seconds, played.failed) == (True, 108.0, ())  # a wait of 5 s may be too long by 2
    assert not play_plan(env, [replace(step, awaits=()) for step in plan], seed=0).success


def test_steps_of_a_classical_plan_follow_each_other() -> None:
    scene = kitchen("OpenCabinetPnP", layout="one_wall_large").start.scene
    plan = read_plan("(drive-by-aside-to-by-cabinet robot_0)\n(open-cabinet robot_0 by-cabinet)", scene)
    assert [(step.at, step.seconds) for step in plan] == [(0.0, 6.0), (6.0, 9.0)]


ELSEWHERE = """0.000: (drive-by-aside-to-by-sink robot_0) [6.000]
6.001: (turn-on-faucet robot_0 by-sink) [7.000]
13.002: (pick-up-from-vessel robot_0 by-sink eggplant bowl slot-sink_0 sink n0 n1) [8.000]
21.003: (drive-by-sink-to-by-microwave robot_0) [6.000]
27.004: (drive-by-microwave-to-by-counter_island_right robot_0) [6.000]
33.005: (place robot_0 by-counter_island_right eggplant slot-island_3 counter) [9.000]
42.006: (drive-by-counter_island_right-to-by-microwave robot_0) [6.000]
48.007: (pick-up robot_0 by-microwave meat slot-microwave_0 microwave) [8.000]
56.008: (drive-by-microwave-to-by-sink robot_0) [6.000]
62.009: (place-into-vessel robot_0 by-sink meat bowl slot-sink_0 sink n0 n1) [9.000]
"""
"""A plan of Kairos' for DefrostInBowl: no command leads to the right of the island, as nothing stands there."""


def test_a_drive_where_no_command_leads_is_the_drive_to_the_fixture_there() -> None:
    env = remac_env.parallel_env(
        "DefrostInBowl", robots=1, backend="symbolic", clock="events", starts="mixed", layout="one_wall_large"
    )
    env.reset(seed=51)
    rules, plan = env.start.scene, read_plan(ELSEWHERE, env.start.scene)
    drive = plan[4]
    assert drive.command(rules, env.world) is None and drive.in_its_stead(rules) == Subtask("navigate to", "counter")
    assert all(step.in_its_stead(rules) is None for step in plan if step.skill != "navigate to")
    played = play_plan(env, plan, seed=51)
    assert (played.success, played.seconds, played.failed) == (True, 71.0, ())
    nowhere = Step(0.0, "robot_0", "navigate to", "moon", 6.0)
    ended = play_plan(env, [nowhere], seed=51)
    assert (ended.success, ended.seconds, ended.failed) == (False, 0.0, ("navigate to moon: no command does that",))


@pytest.mark.parametrize("line", ["(fly robot_0)", "open the door", "(open-cabinet robot_0)", "1: 2: (done)"])
def test_what_is_no_plan_is_refused(line: str) -> None:
    with pytest.raises(OptionError, match="plan, line 1: .*an action of the domain"):
        read_plan(line, kitchen("OpenCabinetPnP").start.scene)


def test_what_cannot_be_said_is_refused() -> None:
    env = kitchen("OpenCabinetPnP")
    with pytest.raises(UnknownNameError, match="strips, durative"):
        write_domain(env.start.scene, level="adl")
    scene = kitchen("HeatAndShelve").start.scene
    with pytest.raises(OptionError, match="burning"):
        write_domain(scene, level="durative")
    assert unsaid(scene) == ["burning"]
    assert "; Not said: burning. A plan may let it happen.\n" in write_domain(scene, level="durative", relaxed=True)
    slow = write_domain(kitchen("RinseAndStow").start.scene, level="durative")
    assert "(:durative-action faucet-washed" in slow and "(= ?duration 20)" in slow
