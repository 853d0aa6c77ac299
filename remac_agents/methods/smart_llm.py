"""SMART-LLM: decompose, form coalitions, allocate, execute. No feedback, no checks, no second plan.

A reimplementation after Kannan et al., "SMART-LLM: Smart Multi-Agent Robot Task Planning using Large Language Models"
(2023, arXiv 2309.10062). Where the original has its model write a program and executes it, the rows are laid out
here by `coalitions.lay_out`: no code of a model is run.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

from remac_agents.methods.base import open_loop
from remac_agents.plan import Plan, PlanError
from remac_agents.planning.coalitions import as_values, lay_out, read_allocation, read_decomposition
from remac_agents.roles import PlanRequest
from remac_agents.running.asking import ask
from remac_agents.running.method_run import MethodRun, Turns

T = TypeVar("T")


def smart_llm(run: MethodRun) -> Turns:
    """Plan in stages for all robots, then carry the plan out open-loop."""
    run.adopt(plan_in_stages(run))
    yield from open_loop(run)


def plan_in_stages(run: MethodRun) -> Plan:
    """The plan; an empty one where a stage has no usable answer."""
    robots, skills = run.briefing.robots, run.briefing.skills
    told = {robot: tuple(sorted(can)) for robot, can in skills.items()}
    request = replace(run.plan_request(robots), question="decompose", skills=told)
    tasks = _ask(run, request, lambda reply: read_decomposition(reply, run.commands, skills))
    if isinstance(tasks, PlanError):
        return Plan.of({})
    request = replace(request, question="allocate", subtasks=as_values(tasks))
    lead = run.briefing.lead
    team = _ask(run, request, lambda reply: read_allocation(reply, tasks, robots, skills, lead))
    return Plan.of({}) if isinstance(team, PlanError) else lay_out(tasks, team, robots, skills)


def _ask(run: MethodRun, request: PlanRequest, read: Callable[[object], T | PlanError]) -> T | PlanError:
    came = ask(run.roles.planner, request, read, most=run.bounds.replies)
    run.book.ledger.errors += [f"{request.question}: {error.told}" for error in came if isinstance(error, PlanError)]
    return came[-1] if came else PlanError("the planner may not be asked")
