"""Conditions that a language model writes. What the skill table can say, in whatever words, becomes its conditions; the
rest stays words, which only a checker with a model can judge, and which the record marks as unmatched."""

from __future__ import annotations

from pydantic import BaseModel, Field

from remac_agents.llm import BadAnswer
from remac_agents.prompting import wording
from remac_agents.prompting.model_role import ModelRole, reads
from remac_agents.roles import FreeText, View
from remac_env.rules.claims import settled
from remac_env.rules.conditions import Condition
from remac_env.rules.sentences import read_condition, sentence_forms
from remac_env.rules.subtasks import Subtask

MOST = 20
"""Sentences of one answer."""


class _Answer(BaseModel):
    conditions: list[str] = Field(max_length=MOST)


class LlmConditions(ModelRole):
    """Asks once before and once after each subtask. Without a usable answer there is nothing to check."""

    role = "conditions"

    def before(self, subtask: Subtask, robot: str, view: View) -> list[Condition]:
        """What the model says must hold for `robot` to run `subtask` now."""
        return self._conditions("conditions_before", subtask, robot, view)

    def after(self, subtask: Subtask, robot: str, view: View) -> list[Condition]:
        """What the model says must hold once it has been run."""
        return self._conditions("conditions_after", subtask, robot, view)

    def _conditions(self, prompt: str, subtask: Subtask, robot: str, view: View) -> list[Condition]:
        fields = {
            **wording.room(view),
            "forms": wording.bullets(sentence_forms(leave_out=settled())),
            "robot": robot,
            "subtask": subtask.text,
            "held": wording.held(view, robot),
        }
        answer = self.ask(prompt, fields, reads(_Answer), about=f"{robot}: {subtask.text}")
        if isinstance(answer, BadAnswer):
            return []
        lines = (wording.one_line(text) for text in answer.conditions)
        found = [read_condition(line, view.scene, robot=robot) or FreeText.of(line) for line in lines if line]
        return [condition for condition in dict.fromkeys(found) if condition.predicate not in settled()]
