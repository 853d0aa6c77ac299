"""The hand-over by a language model: it is shown the plan of one robot that worked, and writes rows for two."""

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
        """The model's plan for both, or None where it declines, leaves the helper idle or has no usable answer."""
        fields = {
            **wording.room(request.view),
            **wording.use(request.view),
            "goal": request.goal,
            "commands": ", ".join(request.commands),
            "plan": f"{request.lead}: {wording.commands(request.plan)}",
            "lead": request.lead,
            "helper": request.helper,
            "reflections": wording.bullets(request.reflections),
        }
        about = f"{request.lead}, {request.helper}"
        found = self.ask("handover", fields, lambda text: _rows(text, request), about=about, form=None)
        return None if isinstance(found, BadAnswer) or not found.row(request.helper) else found


def _rows(text: str, request: HandoverRequest) -> Plan | BadAnswer:
    told = without_thoughts(text)
    if told is not None and told.strip(" \t\n.*\"'`").lower() == ALONE:
        return Plan.of({})
    plan = read_plan(text, Commands(request.commands), (request.lead, request.helper), request.lead)
    return BadAnswer(plan.told) if isinstance(plan, PlanError) else plan
