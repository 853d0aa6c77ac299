"""The summariser that is a language model: it retells the log of an episode, and says why it failed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import BaseModel

from remac_agents.llm import BadAnswer
from remac_agents.prompting import wording
from remac_agents.prompting.model_role import ModelRole, reads
from remac_agents.roles import ExplainRequest, Explanation, SeenStep, Summary
from remac_agents.summarisers.rule import RuleSummariser


class _Retold(BaseModel):
    events: list[str]
    subgoals: list[str]


class _Cause(BaseModel):
    reason: str
    step: int | None = None


class LlmSummariser(ModelRole):
    """The rules' log is what the model retells, and what stands where it does not retell it."""

    role = "summariser"

    def summarise(self, goal: str, steps: Sequence[SeenStep]) -> Summary:
        """One line an event, and one a subgoal."""
        log = RuleSummariser().summarise(goal, steps)
        if not steps:
            return log

        def miscounted(value: Mapping[str, Any]) -> list[str]:
            wanted = {"events": len(log.events), "subgoals": len(log.subgoals)}
            given = {name: len(value[name]) for name in wanted if isinstance(value.get(name), list)}
            return [f"{n} {name}; valid: {wanted[name]}" for name, n in given.items() if n != wanted[name]]

        lines = {"events": wording.numbered(log.events), "subgoals": wording.numbered(log.subgoals)}
        answer = self.ask("summary", {"goal": goal, **lines}, reads(_Retold, miscounted), about=f"{len(steps)} steps")
        if isinstance(answer, BadAnswer):
            return log
        return Summary(tuple(map(wording.one_line, answer.events)), tuple(map(wording.one_line, answer.subgoals)))

    def explain(self, request: ExplainRequest) -> Explanation:
        """The cause as the model sees it; what was false before the step at fault, the checker says."""
        reached = {
            True: "did what it was to do",
            False: "did not do what it was to do",
            None: "whether it did what it was to do, nobody can tell",
        }
        steps = zip(request.summary.subgoals, request.reached, strict=False)
        fields = {
            "goal": request.goal,
            "plan": wording.rows(request.plan),
            "events": wording.numbered(request.summary.events),
            "steps": wording.numbered(f"{_stopped(subgoal)} Seen: {reached[met]}." for subgoal, met in steps),
        }

        def read(text: str) -> _Cause | BadAnswer:
            answer = reads(_Cause)(text)
            if isinstance(answer, BadAnswer) or answer.step is None or 1 <= answer.step <= len(request.steps):
                return answer
            return BadAnswer(f"step {answer.step} is not there; valid: 1..{len(request.steps)}, or null")

        answer = self.ask("explanation", fields, read, about="why it failed")
        if isinstance(answer, BadAnswer):
            return Explanation("nobody could say why")
        reason = wording.one_line(answer.reason) or "nobody could say why"
        if answer.step is None:
            return Explanation(reason)
        index = answer.step - 1
        return Explanation(reason, index, request.false_before(index))


def _stopped(text: str) -> str:
    return text if text.endswith((".", "!", "?")) else f"{text}."
