"""The oracle: exact lengths, an admissible bound, no command forgotten, plans that can be carried out."""

from __future__ import annotations

from collections import deque
from dataclasses import replace
from typing import Any

import pytest
from small_kitchens import cheapest, draw

import remac_env
from remac_env.oracle import LITTER_ROUNDS, certify, relevant_commands, search, search_plan, solvable, solve
from remac_env.oracle.bounds import make_bound
from remac_env.rules.facts import ObjectFacts, Rules
from remac_env.rules.rounds import transition
from remac_env.rules.subtasks import WAIT, Subtask
from remac_env.state import FLOOR, FrozenMap, ObjectState, Place, WorldState, occupant
from remac_env.tasks.goals import All, DoorIs, Goal, Inside, Marked, Released

TASKS = ("OpenCabinetPnP", "OpenMicrowavePnP", "DefrostInBowl", "HeatOnStove")


def problem(task: str, seed: int, *, robots: int, starts: str) -> tuple[Any, Rules, WorldState, Goal]:
    env = remac_env.parallel_env(task, robots=robots, backend="symbolic", starts=starts)
    env.reset(seed=seed)
    return env, env.start.scene, env.world, env.goal


def all_commands(env: Any, scene: Rules) -> list[Subtask]:
    texts = env.vocabulary.commands(scene)
    return [env.vocabulary.parse(text) for text in texts if text not in ("wait", "done")]


@pytest.mark.few(6)
@pytest.mark.parametrize(
    ("task", "robots", "length"),
    [*zip(TASKS, (1,) * 4, (6, 6, 9, 9), strict=True), *zip(TASKS, (2,) * 4, (4, 4, 6, 6), strict=True)],
)
def test_shortest_plans_from_paper_starts(task: str, robots: int, length: int) -> None:
    for seed in range(3):
        _, scene, world, goal = problem(task, seed, robots=robots, starts="paper")
        plan = solve(scene, world, goal)
        assert plan is not None and plan.length == length, seed


def breadth_first(scene: Rules, world: WorldState, goal: Goal, commands: list[Subtask]) -> int | None:
    """Written anew for one robot, without anything of the oracle's: every command, rounds run by the table."""
    (robot,) = scene.robots
    queue, seen = deque([(world, 0)]), {world}
    while queue:
        state, depth = queue.popleft()
        if goal.holds(scene, state):
            return depth
        for subtask in commands:
            after, outcomes = transition(scene, state, {robot: subtask})
            if outcomes[robot].success and after not in seen:
                seen.add(after)
                queue.append((after, depth + 1))
    return None


@pytest.mark.few(1)
@pytest.mark.parametrize("task", TASKS[:2])
def test_breadth_first_search_over_all_commands_finds_nothing_shorter(task: str) -> None:
    for seed in range(4):
        env, scene, world, goal = problem(task, seed, robots=1, starts="mixed")
        plan = solve(scene, world, goal)
        commands = [c for c in all_commands(env, scene) if c.skill != "season"]
        assert plan is not None and plan.length == breadth_first(scene, world, goal, commands), seed


@pytest.mark.parametrize("task", TASKS)
def test_the_relevant_commands_are_enough(task: str) -> None:
    _check_relevant(task, range(3), max_states=6_000)


@pytest.mark.long
@pytest.mark.parametrize("task", TASKS)
def test_the_relevant_commands_are_enough_over_many_seeds(task: str) -> None:
    _check_relevant(task, range(60), max_states=30_000)


def _check_relevant(task: str, seeds: range, *, max_states: int) -> None:
    """With every command of the kitchen the plan is not shorter, as far as the search gets."""
    finished = 0
    for seed in seeds:
        env, scene, world, goal = problem(task, seed, robots=1, starts="mixed")
        plan = solve(scene, world, goal)
        assert plan is not None
        full = search_plan(
            scene,
            world,
            lambda state, scene=scene, goal=goal: goal.holds(scene, state),
            commands=all_commands(env, scene),
            bound=make_bound(scene, goal),
            max_rounds=plan.length,
            max_states=max_states,
        )
        assert full is None or full.length == plan.length, seed
        finished += full is not None
    assert finished, "no search with all commands was finished, so nothing was compared"


@pytest.mark.few(3)
@pytest.mark.parametrize("robots", [1, 2])
@pytest.mark.parametrize("task", TASKS)
def test_the_bound_never_cuts_off_a_shorter_plan(task: str, robots: int) -> None:
    """Breadth-first (bound 0) over the same commands is as long; and the bound is never above the truth."""
    for seed in range(4 if robots == 1 else 1):
        _, scene, world, goal = problem(task, seed, robots=robots, starts="mixed")
        plan = solve(scene, world, goal)
        assert plan is not None
        plain = search_plan(
            scene,
            world,
            lambda state, scene=scene, goal=goal: goal.holds(scene, state),
            commands=relevant_commands(scene, world, goal),
            max_rounds=plan.length,
            max_states=2_500,
        )
        assert plain is None or plain.length == plan.length, seed
        at_least = make_bound(scene, goal)
        state, bounds = world, [at_least(world)]
        for joint in plan.rounds:
            state, outcomes = transition(scene, state, dict(joint))
            assert all(outcome.success for outcome in outcomes.values())
            bounds.append(at_least(state))
        assert goal.holds(scene, state) and bounds[-1] == 0
        assert all(bound <= plan.length - number for number, bound in enumerate(bounds)), bounds


@pytest.mark.few(3)
@pytest.mark.parametrize("task", sorted(TASKS, key=lambda task: task == "DefrostInBowl"))  # which takes as long as all
def test_two_robots_never_need_more_rounds_than_one(task: str) -> None:
    lengths = []
    for robots in (1, 2):
        _, scene, world, goal = problem(task, 1, robots=robots, starts="mixed")
        plan = solve(scene, world, goal)
        assert plan is not None
        lengths.append(plan.length)
    assert lengths[1] <= lengths[0]


def test_what_is_lost_has_no_plan() -> None:
    _, scene, world, goal = problem("HeatOnStove", 0, robots=1, starts="paper")
    assert solve(scene, world.with_object("pan", place=FLOOR), goal) is None
    assert solve(scene, world, goal, max_rounds=8) is None
    nowhere = All(Inside("vegetable", "fridge"))
    assert solve(scene, world, nowhere, max_rounds=5) is None


def test_a_goal_that_holds_needs_no_round() -> None:
    _, scene, world, _ = problem("HeatOnStove", 0, robots=1, starts="paper")
    plan = solve(scene, world, All(Inside("pan", "counter")))
    assert plan is not None and plan.length == 0 and plan.as_text() == {}


def test_plans_as_text_leave_out_waiting_at_the_end() -> None:
    _, scene, world, goal = problem("OpenCabinetPnP", 0, robots=2, starts="paper")
    plan = solve(scene, world, goal)
    assert plan is not None
    texts = plan.as_text()
    assert set(texts) == {"robot_0", "robot_1"}
    assert all(not commands or commands[-1] != WAIT.text for commands in texts.values())
    assert max(len(commands) for commands in texts.values()) == plan.length


MOST = 7
"""Rounds up to which drawn problems are searched without any bound."""


def _check_drawn(seeds: range, *, states: int, most_robots: int = 2) -> int:
    """Optima against uniform-cost search over all commands; how many were compared."""
    compared = 0
    for seed in seeds:
        problem = draw(seed)
        if len(problem.scene.robots) > most_robots or problem.goal.holds(problem.scene, problem.world):
            continue
        truth = cheapest(problem, most=MOST, states=states)
        if truth == "gave up":
            continue
        found = certify(problem.scene, problem.world, problem.goal, max_rounds=MOST)
        assert not found.unknown and found.optimum == truth, (seed, truth, found)
        compared += 1
    return compared


def test_drawn_problems_have_the_optimum_of_a_search_over_all_commands() -> None:
    assert _check_drawn(range(60), states=250, most_robots=1) >= 10
    assert _check_drawn(range(16), states=25) >= 2


def test_what_is_in_a_vessel_in_hand_goes_with_it() -> None:
    """The salt is in the pan that a robot holds: both are put into the microwave at once."""
    drawn = draw(1028)
    found = certify(drawn.scene, drawn.world, drawn.goal, max_rounds=MOST)
    assert found.optimum == 4 and found.proof == "search"


@pytest.mark.few(1)
@pytest.mark.parametrize(("number", "cost"), [(1177, 4), (2020, 5), (2594, 5), (2614, 5), (2873, 7), (3050, 4)])
def test_what_is_in_a_hand_may_be_put_down_on_a_stove_that_the_goal_does_not_name(number: int, cost: int) -> None:
    drawn = draw(number)
    found = certify(drawn.scene, drawn.world, drawn.goal, max_rounds=MOST)
    assert found.optimum == cost and found.proof == "search"


def test_without_the_stove_as_a_place_to_put_down_the_plan_is_longer() -> None:
    """What the goal is about is not enough for a shortest plan, and `shortest` does not take it for one."""
    drawn = draw(1177)
    narrow = search_plan(
        drawn.scene,
        drawn.world,
        lambda state: drawn.goal.holds(drawn.scene, state),
        commands=relevant_commands(drawn.scene, drawn.world, drawn.goal, exact=False),
        bound=make_bound(drawn.scene, drawn.goal),
        max_rounds=MOST,
    )
    assert narrow is not None and narrow.cost == 6


@pytest.mark.long
def test_with_two_robots_no_command_left_out_makes_a_plan_shorter() -> None:
    compared = 0
    for number in range(4080, 4160):
        drawn = draw(number)
        if len(drawn.scene.robots) == 2 and not drawn.goal.holds(drawn.scene, drawn.world):
            found = certify(drawn.scene, drawn.world, drawn.goal, max_rounds=MOST)
            below = search(
                drawn.scene,
                drawn.world,
                lambda state, drawn=drawn: drawn.goal.holds(drawn.scene, state),  # type: ignore[misc]
                commands=drawn.commands,
                bound=make_bound(drawn.scene, drawn.goal),
                max_rounds=(found.optimum or MOST + 1) - 1,
                max_states=3000,
            )
            assert below.plan is None, (number, below.plan)
            compared += not below.gave_up
    assert compared >= 30


@pytest.mark.long
def test_two_hundred_drawn_problems_have_the_optimum_of_a_search_over_all_commands() -> None:
    assert _check_drawn(range(1000, 1300), states=1500) >= 200


def test_a_bound_that_promises_too_much_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    from remac_env.oracle import bounds, certificate

    right = bounds._Needs.at_least
    monkeypatch.setattr(certificate, "_kept", certificate._certificate)
    monkeypatch.setattr(bounds._Needs, "at_least", lambda self, world: 2 * right(self, world))
    with pytest.raises(AssertionError):
        _check_drawn(range(60), states=250, most_robots=1)


def test_rinsing_in_the_sink_needs_no_way_out_of_it() -> None:
    """The goal's container is the basin itself: nothing is left to do once water has run."""
    _, scene, world, _ = problem("WashPnPHeat", 0, robots=2, starts="paper")
    goal = All(Marked("vegetable", "washed"), Inside("vegetable", "sink"), Released("vegetable"))
    found = certify(scene, world, goal)
    assert found.optimum == 4 and found.lower == 4 and found.proof == "search"


def test_letting_a_thing_fall_is_no_way_to_save_rounds() -> None:
    """A robot with a lemon in its hand could close the door by dropping it: two rounds less, and four for litter."""
    _, scene, world, _ = problem("OpenCabinetPnP", 0, robots=1, starts="paper")
    (robot,) = scene.robots
    at_door = world.with_robot(robot, station=scene.fixtures["cabinet"].station, holding="plate")
    at_door = at_door.with_object("plate", place=Place("held", robot)).with_fixture("cabinet", door="open")
    goal = All(DoorIs("cabinet", "closed"))
    found = certify(scene, at_door, goal)
    assert found.optimum == 2 and found.plan is not None
    assert found.plan.as_text()[robot] == ["place to cabinet", "close cabinet door"]
    scene, full = _without_room(scene, at_door)
    dropped = certify(scene, full, goal)
    assert dropped.plan is not None and dropped.plan.length == 2 and dropped.optimum == 2 + LITTER_ROUNDS


def _without_room(scene: Rules, world: WorldState) -> tuple[Rules, WorldState]:
    """The same with every slot taken by a brick."""
    slots = [slot for slot in scene.slots if occupant(world, slot) is None]
    bricks = {f"brick_{at}": slot for at, slot in enumerate(slots)}
    facts = FrozenMap({**scene.objects, **{name: ObjectFacts(name, "brick") for name in bricks}})
    places = {name: ObjectState(Place("slot", slot)) for name, slot in bricks.items()}
    objects = FrozenMap({**world.objects, **places})
    return replace(scene, objects=facts), WorldState(world.robots, objects, world.fixtures)


def test_a_search_that_gives_up_says_so_and_gives_bounds() -> None:
    _, scene, world, goal = problem("WashPnPHeat", 3, robots=1, starts="mixed")
    exact, cut = certify(scene, world, goal), certify(scene, world, goal, max_states=30)
    assert exact.proof == "search" and exact.optimum is not None
    assert cut.unknown and cut.optimum is None and cut.lower is not None and cut.lower <= exact.optimum
    some = certify(scene, world, goal, max_states=300)
    assert some.lower is not None and some.upper is not None and some.lower <= exact.optimum <= some.upper


def test_what_cannot_be_is_told_from_what_takes_too_long() -> None:
    _, scene, world, goal = problem("HeatOnStove", 0, robots=1, starts="paper")
    assert certify(scene, world.with_object("pan", place=FLOOR), goal).proof == "exhausted"
    assert certify(scene, world, goal, max_rounds=8).proof == "rounds"
    assert solvable(scene, world, goal) is True
    assert solvable(scene, world.with_object("pan", place=FLOOR), goal) is False
    assert solvable(scene, world, goal, max_states=2) is None
