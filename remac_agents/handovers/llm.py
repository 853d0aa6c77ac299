"""The hand-over by a language model: it is shown the plan of one robot that worked, and writes rows for a team."""

from __future__ import annotations

from remac_agents.llm import BadAnswer
from remac_agents.plan import Commands, Plan, PlanError, read_plan
from remac_agents.prompting import wording
from remac_agents.prompting.model_role import ModelRole
from remac_agents.roles import HandoverRequest
from remac_agents.text.plan_words import without_thoughts

ALONE = "alone"
"""The answer that declines."""


class LlmHandover(ModelRole):
    """Asks once; an answer that is not a plan is sent back with all that is wrong in it."""

    role = "handover"

    def share(self, request: HandoverRequest) -> Plan | None:
        """The model's plan for the team, or None where it declines, lets nobody help or has no usable answer."""
        fields = {
            **wording.room(request.view),
            **wording.use(request.view),
            "goal": request.goal,
            "commands": ", ".join(request.commands),
            "plan": f"{request.lead}: {wording.commands(request.plan)}",
            "lead": request.lead,
            "helper": ", ".join(request.team[1:]),
            "reflections": wording.bullets(request.reflections),
        }
        about, prompt = ", ".join(request.team), "handover_team" if request.helpers else "handover"
        found = self.ask(prompt, fields, lambda text: _rows(text, request), about=about, form=None)
        return None if isinstance(found, BadAnswer) or not any(map(found.row, request.team[1:])) else found


def _rows(text: str, request: HandoverRequest) -> Plan | BadAnswer:
    told = without_thoughts(text)
    if told is not None and told.strip(" \t\n.*\"'`").lower() == ALONE:
        return Plan.of({})
    plan = read_plan(text, Commands(request.commands), request.team, request.lead)
    return BadAnswer(plan.told) if isinstance(plan, PlanError) else plan
