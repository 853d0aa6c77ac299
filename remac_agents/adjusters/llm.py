"""The adjuster that is a language model: one question for the analysis, one for the new plan, as in the paper."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel, Field

from remac_agents.llm import BadAnswer
from remac_agents.plan import Commands, Plan, PlanError, read_plan
from remac_agents.prompting import wording
from remac_agents.prompting.model_role import ModelRole, reads, texts_in
from remac_agents.roles import AdjustRequest, Advice
from remac_env.rules.subtasks import Subtask

MOST = 20
"""Commands that one analysis may recommend."""


class _Answer(BaseModel):
    reason: str
    next_steps: list[str] = Field(max_length=MOST)


class LlmAdjuster(ModelRole):
    """Without a usable analysis the subtask is tried as it is; without a usable plan the recommended commands come
    first, and then the old plan."""

    role = "adjuster"
    asks_once = False

    def adjust(self, request: AdjustRequest) -> Advice:
        """Reason and recommended steps, and the robot's new row."""
        commands = Commands(request.commands)
        about = f"{request.robot}: {request.subtask.text}"
        old = request.plan.row(request.robot)
        analysis = self.ask("analysis", _analysis(request), _reader(commands), about=f"{about}: analysis")
        if isinstance(analysis, BadAnswer):
            return Advice(f"no analysis: {analysis.problem}", row=old)
        reason, steps = analysis
        row = self.ask(
            "adjustment",
            _adjustment(request, reason, steps),
            lambda text: _row(text, commands, request.robot),
            about=f"{about}: adjustment",
            form=None,
        )
        if isinstance(row, BadAnswer):
            return Advice(reason, steps, (*steps, *old), steps)
        left_out = not steps and len(row) < len(old) and row == old[1:]
        return Advice(reason, steps, row, steps, left_out=left_out)


def _analysis(request: AdjustRequest) -> dict[str, str]:
    return {
        **wording.room(request.view),
        **wording.use(request.view),
        "commands": ", ".join(request.commands),
        "previous_try": wording.previous_try(request.previous),
        "ran": wording.rounds(request.ran),
        "plan": wording.rows(request.plan.as_text()),
        "robot": request.robot,
        "held": wording.held(request.view, request.robot),
        "subtask": request.subtask.text,
        "failed": wording.sentences(request.failed),
    }


def _adjustment(request: AdjustRequest, reason: str, steps: tuple[Subtask, ...]) -> dict[str, str]:
    return {
        **wording.use(request.view),
        "commands": ", ".join(request.commands),
        "goal": request.view.goal,
        "previous_try": wording.previous_try(request.previous),
        "ran": wording.rounds(request.ran),
        "robot": request.robot,
        "held": wording.held(request.view, request.robot),
        "row": wording.commands(request.plan.row(request.robot)),
        "subtask": request.subtask.text,
        "failed": wording.sentences(request.failed),
        "reason": reason,
        "next_steps": wording.commands(steps),
    }


def _reader(commands: Commands):  # type: ignore[no-untyped-def]
    def unknown(value: Mapping[str, Any]) -> list[str]:
        steps = dict.fromkeys(texts_in(value, "next_steps")[:MOST])
        return [commands.unknown(text) for text in steps if commands.parse(text) is None]

    def read(text: str) -> tuple[str, tuple[Subtask, ...]] | BadAnswer:
        answer = reads(_Answer, unknown)(text)
        if isinstance(answer, BadAnswer):
            return answer
        return wording.one_line(answer.reason), tuple(commands[step] for step in answer.next_steps)

    return read


def _row(text: str, commands: Commands, robot: str) -> tuple[Subtask, ...] | BadAnswer:
    plan: Plan | PlanError = read_plan(text, commands, (robot,), robot)
    return BadAnswer(plan.told) if isinstance(plan, PlanError) else plan.row(robot)
