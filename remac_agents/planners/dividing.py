"""What the literal planner answers to SMART-LLM's questions: a decomposition and an allocation by rules, no model's."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from remac_agents.planning.rewriting import tidy
from remac_agents.planning.teamwork import independent, parts_of
from remac_agents.roles import PlanRequest
from remac_env.rules.subtasks import STEP_ASIDE, Subtask


def decomposed(steps: Sequence[Subtask], request: PlanRequest) -> dict[str, Any]:
    """Groups of steps that have no object and no fixture in common; each frees its place in the end."""
    groups = independent(parts_of(steps, fine=True), request.facts)
    listed = []
    for number, group in enumerate(groups, 1):
        row = [*tidy([step for part in group for step in part], request.facts), *[STEP_ASIDE] * (len(groups) > 1)]
        skills = sorted({step.skill for step in row})
        listed.append({"id": str(number), "steps": [step.text for step in row], "skills": skills, "after": []})
    return {"subtasks": listed}


def allocated(request: PlanRequest) -> dict[str, list[str]]:
    """Each subtask to the robot that is free first and has its skills, else to as few as have them together."""
    busy = dict.fromkeys(sorted(request.robots, key=lambda robot: robot != request.lead), 0)
    team: dict[str, list[str]] = {}
    for task in request.subtasks:
        wanted = set(task["skills"])
        able = [robot for robot in busy if wanted <= set(request.skills[robot])]
        chosen = [min(able, key=lambda robot: busy[robot])] if able else _together(wanted, request)
        start = max(busy[robot] for robot in chosen)
        busy |= dict.fromkeys(chosen, start + len(task["steps"]))
        team[task["id"]] = chosen
    return team


def _together(wanted: set[str], request: PlanRequest) -> list[str]:
    """Robots that cover the skills, those who add most first; all of them where nobody does."""
    left, chosen = set(wanted), list[str]()
    while left and len(chosen) < len(request.robots):
        others = [robot for robot in request.robots if robot not in chosen]
        best = max(others, key=lambda robot: len(left & set(request.skills[robot])))
        chosen.append(best)
        left -= set(request.skills[best])
    return chosen or list(request.robots)
