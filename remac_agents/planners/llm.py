"""The planner that is a language model. Its answer is text, which methods read as they read any planner's."""

from __future__ import annotations

import json

from remac_agents.llm import BadAnswer
from remac_agents.plan import PlanError
from remac_agents.prompting import wording
from remac_agents.prompting.model_role import JSON, ModelRole, sent_back
from remac_agents.prompting.prompt import Prompt, load
from remac_agents.roles import PlanRequest

QUESTION = "act"
"""The question for one robot's next command (ReAct)."""

STAGES = {"decompose": "smart_llm_decompose", "allocate": "smart_llm_allocate"}
"""Question of SMART-LLM -> its prompt."""


class LlmPlanner(ModelRole):
    """Asks for the whole plan, for the next step (CAPE, ReAct), for a corrected plan (REFLECT), or as SMART-LLM."""

    role = "planner"

    def plan(self, request: PlanRequest) -> str | PlanError:
        """The model's answer, or why there is none. Answers of its own that were not plans are part of the dialogue."""
        prompt = load(_prompt(request))
        fields = {name: text for name, text in _fields(request, prompt).items() if name in prompt.fields}
        messages = prompt.messages(fields)
        for repair in request.repairs:
            messages = sent_back(messages, repair.answer, repair.problems)
        form = JSON if request.question in STAGES else None
        text = self.say(messages, about=f"{', '.join(request.robots)}: {prompt.name}", form=form)
        return PlanError(text.problem) if isinstance(text, BadAnswer) else text


def _prompt(request: PlanRequest) -> str:
    if request.question in STAGES:
        return STAGES[request.question]
    if request.question == QUESTION:
        return "react_step"
    if request.single_step:
        return "planner_step"
    return "planner_correct" if request.explanation else "planner"


def _fields(request: PlanRequest, prompt: Prompt) -> dict[str, str]:
    listed, scene = ", ".join(request.commands), request.scene if "scene" in prompt.fields else ""
    return {
        "scene": request.scene,
        # The kitchen's text lists commands and goal, others may not; each stands once.
        "commands": "" if listed in scene else listed,
        "goal": "" if request.goal in scene else request.goal,
        "robots": ", ".join(request.robots),
        "reflections": wording.bullets(request.reflections),
        "previous_plan": wording.rows(request.previous_plan),
        "previous_try": wording.previous_try(request.previous) or wording.rows(request.previous_plan),
        "ran": wording.rounds(request.ran),
        "refusal": request.refusal,
        "history": wording.attempts(request.history),
        "events": wording.numbered(request.events),
        "explanation": request.explanation,
        "skills": wording.rows(request.skills),
        "teammates": "\n".join(f"{robot}: {command}" for robot, command in request.teammates.items()),
        "subtasks": "\n".join(json.dumps(subtask) for subtask in request.subtasks),
    }
