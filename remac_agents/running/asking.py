"""How a planner is asked: what it is told, and what becomes of an answer that is not a plan."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

from remac_agents.memory import Run
from remac_agents.plan import Commands, Plan, PlanError, read_plan
from remac_agents.roles import Planner, PlanRequest, PreviousTry, Ran, Repair
from remac_agents.running.bookkeeper import Bookkeeper
from remac_agents.running.briefing import Briefing
from remac_agents.running.moments import ran_so_far

T = TypeVar("T")


def ask_planner(
    planner: Planner, request: PlanRequest, commands: Commands, *, most: int
) -> tuple[Plan | PlanError, ...]:
    """What came of each time that the planner was asked, `most` times at most: errors, and then perhaps a plan.

    An answer that is not a plan is sent back, with all that is wrong with it; the answers before it stay in sight.
    """
    return ask(planner, request, lambda reply: read_plan(reply, commands, request.robots, request.lead), most=most)


def ask(
    planner: Planner, request: PlanRequest, read: Callable[[object], T | PlanError], *, most: int
) -> tuple[T | PlanError, ...]:
    """The same for answers that `read` reads."""
    came: list[T | PlanError] = []
    while len(came) < most:
        reply = planner.plan(request)
        found = read(reply)
        came.append(found)
        if not isinstance(found, PlanError):
            break
        repairs = (*request.repairs, Repair(_as_text(reply), found.problems))
        request = replace(request, failure=found.told, repairs=repairs)
    return tuple(came)


def plan_request(
    briefing: Briefing,
    book: Bookkeeper,
    robots: tuple[str, ...],
    *,
    planner: Planner,
    lessons: tuple[str, ...],
    previous: PreviousTry | None,
) -> PlanRequest:
    """What the planner is told at this moment of an episode."""
    view, seen = book.view, book.seen_by(planner)
    return PlanRequest(
        goal=briefing.goal,
        scene=view.text or briefing.text,
        facts=view.scene,
        robots=robots,
        lead=briefing.lead,
        commands=briefing.commands,
        reflections=lessons,
        previous_plan=None if previous is None else previous.plan,
        previous=previous,
        executed=book.ledger.executed(),
        ran=ran_so_far(book.moments),
        holding=view.holding,
        slow=view.slow,
        images=view.images,
        verbs=briefing.verbs,
        episode={"task": briefing.task},
        rules=seen.rules,
        world=seen.world,
        goal_test=briefing.goal_test if seen.world is not None else None,
    )


def previous_try(run: Run) -> PreviousTry:
    """A run of the memory as the next iteration's planner hears of it."""
    plan = {robot: tuple(row) for robot, row in run.initial_plan.items()}
    ran = (Ran.read(line) for line in run.action_list)
    return PreviousTry(plan, run.success, tuple(each for each in ran if each is not None))


def _as_text(reply: object) -> str:
    """An answer as its author wrote it, or would have written it; "" where that cannot be said."""
    if isinstance(reply, str):
        return reply
    value = reply.as_text() if isinstance(reply, Plan) else reply
    if isinstance(value, PlanError):
        return ""
    try:
        return json.dumps(value)
    except (TypeError, ValueError, RecursionError):
        return ""
