"""The reflector that is a language model: why a pre-condition failed, how to avoid it, how to remedy it."""

from __future__ import annotations

from pydantic import BaseModel

from remac_agents.llm import BadAnswer
from remac_agents.prompting import wording
from remac_agents.prompting.model_role import ModelRole, reads
from remac_agents.roles import ReflectRequest


class _Answer(BaseModel):
    reason: str
    avoid: str
    remedy: str


class LlmReflector(ModelRole):
    """One lesson a failed pre-check, in the model's words; none without a usable answer."""

    role = "reflector"

    def reflect(self, request: ReflectRequest) -> list[str]:
        """At most one lesson."""
        fields = {
            "goal": request.goal,
            "robot": request.robot,
            "held": f"the {request.held}" if request.held else "nothing",
            "subtask": request.subtask.text,
            "failed": wording.sentences(request.failed),
            "reason": request.advice.reason,
            "next_steps": wording.commands(request.advice.next_steps),
        }
        answer = self.ask("reflector", fields, reads(_Answer), about=f"{request.robot}: {request.subtask.text}")
        if isinstance(answer, BadAnswer):
            return []
        parts = {"Why": answer.reason, "To avoid it": answer.avoid, "To remedy it": answer.remedy}
        told = [f"{name}: {wording.one_line(text).rstrip('.')}." for name, text in parts.items() if text.strip()]
        return [" ".join(told)] if told else []
