"""Judges a plan by the skill table and the exact optimum. Pure functions: nothing is played, nothing is kept."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any

from remac_agents.plan import Plan, PlanError
from remac_bench.asked import Asked
from remac_bench.plans.faults import BY_REASON, PlanFault
from remac_env.oracle import solve
from remac_env.rules.claims import first_false
from remac_env.rules.facts import Rules
from remac_env.rules.outcomes import Outcome
from remac_env.rules.rounds import transition
from remac_env.rules.subtasks import DONE, WAIT, Subtask
from remac_env.state import WorldState
from remac_env.tasks.goals import Goal

_LONGEST_CUT = 4
"""Steps in a row that are tried to be left out together: put down and picked up again is the longest idle loop."""


@dataclass(frozen=True, kw_only=True)
class Judgement:
    """How good a plan is.

    Attributes:
        plan: robot -> commands; None where the reply was no plan.
        valid: every step works and the goal holds at the end.
        optimal: valid, and as short as the optimum; None for a valid plan where that is not known.
        rounds: of the plan; a closing `done` is not counted.
        optimum: rounds of the shortest plan, None where there is none, or it is not known.
        error: the first thing wrong, None for an optimal plan.
        usage: what asking for it took; None where no language model was asked.
    """

    plan: Mapping[str, tuple[str, ...]] | None
    valid: bool
    optimal: bool | None
    rounds: int | None
    optimum: int | None
    error: PlanFault | None
    usage: Asked | None = None

    def as_json(self) -> dict[str, Any]:
        """The same as values that json.dumps takes; `usage` only where there is one."""
        told = asdict(self)
        return told if self.usage is not None else {name: value for name, value in told.items() if name != "usage"}

    @classmethod
    def from_json(cls, told: Mapping[str, Any]) -> Judgement:
        """What `as_json` made, read again."""
        plan, error = told["plan"], told["error"]
        rows = None if plan is None else {robot: tuple(row) for robot, row in plan.items()}
        numbers = {name: told[name] for name in ("valid", "optimal", "rounds", "optimum")}
        usage = Asked.from_json(told.get("usage"))
        return cls(plan=rows, error=None if error is None else PlanFault(**error), usage=usage, **numbers)


@dataclass(frozen=True)
class _Course:
    """Where a plan leads: the first fault that stops it, the first idle step, and the round that reached the goal."""

    world: WorldState
    fault: PlanFault | None
    idle: PlanFault | None
    reached: int | None

    @property
    def works(self) -> bool:
        return self.fault is None and self.reached is not None


def judge(scene: Rules, world: WorldState, goal: Goal, plan: Plan | PlanError, optimum: int | None) -> Judgement:
    """Judge a plan from a start.

    Args:
        world: the start, in which the goal does not hold.
        plan: the plan, or why there is none.
        optimum: rounds of the shortest plan for the robots of the scene (`remac_env.oracle.certify`).
    """
    if isinstance(plan, PlanError):
        kind = "unknown_thing" if plan.entry is not None else "parse"
        unread = PlanFault(
            type=kind, sentence=plan.problem, robot=plan.robot, index=plan.index, subtask=plan.entry
        )
        return Judgement(plan=None, valid=False, optimal=False, rounds=None, optimum=optimum, error=unread)
    plan = _without_done(plan)
    course = _follow(scene, world, goal, plan)
    fault: PlanFault | None = course.fault
    if course.works:
        fault = _lengthy(scene, world, goal, plan, course, optimum)
    elif fault is None:
        fault = _unfinished(scene, goal, course.world)
    return Judgement(
        plan=plan.as_text(),
        valid=course.works,
        optimal=None if course.works and optimum is None else course.works and plan.length == optimum,
        rounds=plan.length,
        optimum=optimum,
        error=fault,
    )


def _without_done(plan: Plan) -> Plan:
    """A plan whose rows do not end in `done`: that ends an episode, and is no work."""
    rows = {}
    for robot in plan.robots:
        row = plan.row(robot)
        while row and row[-1] in (DONE, WAIT):
            row = row[:-1]
        rows[robot] = row
    return Plan.of(rows)


def _follow(scene: Rules, world: WorldState, goal: Goal, plan: Plan) -> _Course:
    """Run a plan until it fails, reaches the goal or ends."""
    idle: PlanFault | None = None
    for index in range(plan.length):
        joint = dict.fromkeys(scene.robots, WAIT) | plan.round(index)
        after, outcomes = transition(scene, world, joint)
        for robot, subtask in joint.items():
            fault = _fault(scene, world, plan, index, robot, subtask, outcomes[robot])
            if fault is not None and fault.type != "redundant":
                return _Course(world, fault, idle, None)
            idle = idle or fault
        world = after
        if goal.holds(scene, world):
            return _Course(world, None, idle, index + 1)
    return _Course(world, None, idle, None)


def _fault(
    scene: Rules, world: WorldState, plan: Plan, index: int, robot: str, subtask: Subtask, outcome: Outcome
) -> PlanFault | None:
    """What is wrong with one step."""
    advised = first_false(scene, world, robot, subtask, "advise")
    if outcome.success and advised is None:
        return None
    if not outcome.success:
        kind, sentence = BY_REASON.get(str(outcome.reason), "blocked"), outcome.detail
        if kind in ("door_closed", "blocked") and _seen_to_later(scene, world, plan, index, robot, subtask):
            kind = "wrong_order"
    else:
        kind, sentence = "advised_against", f"not true: {advised.condition.sentence}" if advised else ""
    return PlanFault(type=kind, sentence=sentence, robot=robot, index=index, subtask=subtask.text)


def _seen_to_later(
    scene: Rules, world: WorldState, plan: Plan, index: int, robot: str, subtask: Subtask
) -> bool:
    """Whether a later step moves the door, or turns the switch, that the step needs."""
    needed = first_false(scene, world, robot, subtask, "attempt")
    if needed is None:
        return False
    later = [
        (other, step)
        for other in plan.robots
        for step in plan.row(other)[index + (other == robot) :]
        if step.row.lasting
    ]
    return any(needed.condition.holds(scene, step.effect(scene, world, other)) for other, step in later)


def _unfinished(scene: Rules, goal: Goal, world: WorldState) -> PlanFault:
    """All steps worked, and the goal does not hold."""
    open_parts = [atom.text for atom in goal.atoms() if not atom.holds(scene, world)]
    kind = "goal_not_reached" if solve(scene, world, goal) is None else "missing_step"
    return PlanFault(type=kind, sentence=f"not true at the end: {' and '.join(open_parts)}")


def _lengthy(
    scene: Rules, world: WorldState, goal: Goal, plan: Plan, course: _Course, optimum: int | None
) -> PlanFault | None:
    """Why a plan that works is longer than the shortest."""
    if optimum is None or plan.length <= optimum:
        return None
    if course.idle is not None:
        return course.idle
    if course.reached is not None and course.reached < plan.length:
        robot = next(name for name in plan.robots if len(plan.row(name)) > course.reached)
        step = plan.row(robot)[course.reached]
        return PlanFault(
            type="redundant",
            sentence="the goal holds before this step",
            robot=robot,
            index=course.reached,
            subtask=step.text,
        )
    for robot, first, count, shorter in _cuts(plan):
        if _follow(scene, world, goal, shorter).works:
            cut = plan.row(robot)[first : first + count]
            return PlanFault(
                type="redundant",
                sentence=f"can be left out: {', '.join(step.text for step in cut)}",
                robot=robot,
                index=first,
                subtask=cut[0].text,
            )
    return PlanFault(type="detour", sentence=f"{plan.length} rounds, and {optimum} would do")


def _cuts(plan: Plan) -> Iterator[tuple[str, int, int, Plan]]:
    """The plan without a few steps in a row of one robot: whose, from where, how many, and what is left."""
    for count in range(1, _LONGEST_CUT + 1):
        for robot in plan.robots:
            row = plan.row(robot)
            for first in range(len(row) - count + 1):
                rows = {name: plan.row(name) for name in plan.robots}
                rows[robot] = row[:first] + row[first + count :]
                yield robot, first, count, Plan.of(rows)
