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
from remac_agents.running.method_run import Episode, Turns

T = TypeVar("T")


def smart_llm(episode: Episode) -> Turns:
    """Plan in stages for all robots, then carry the plan out open-loop."""
    episode.adopt(plan_in_stages(episode))
    yield from open_loop(episode)


def plan_in_stages(episode: Episode) -> Plan:
    """The plan; an empty one where a stage has no usable answer."""
    robots, skills = episode.briefing.robots, episode.briefing.skills
    told = {robot: tuple(sorted(can)) for robot, can in skills.items()}
    request = replace(episode.plan_request(robots), question="decompose", skills=told)
    tasks = _ask(episode, request, lambda reply: read_decomposition(reply, episode.commands, skills))
    if isinstance(tasks, PlanError):
        return Plan.of({})
    request = replace(request, question="allocate", subtasks=as_values(tasks))
    lead = episode.briefing.lead
    team = _ask(episode, request, lambda reply: read_allocation(reply, tasks, robots, skills, lead))
    return Plan.of({}) if isinstance(team, PlanError) else lay_out(tasks, team, robots, skills)


def _ask(episode: Episode, request: PlanRequest, read: Callable[[object], T | PlanError]) -> T | PlanError:
    came = ask(episode.roles.planner, request, read, most=episode.bounds.replies)
    episode.ledger.errors += [f"{request.question}: {error.told}" for error in came if isinstance(error, PlanError)]
    return came[-1] if came else PlanError("the planner may not be asked")
