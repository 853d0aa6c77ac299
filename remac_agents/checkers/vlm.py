"""The checker that is a model with eyes: it is shown pictures and a list of conditions, and judges each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pydantic import BaseModel, Field

from remac_agents import wording
from remac_agents.llm import BadAnswer, Picture
from remac_agents.model_role import ModelRole, reads
from remac_agents.roles import Report, Verdict, View
from remac_env.conditions import Condition
from remac_env.errors import OptionError

CAMERAS = ("side", "wrist")
"""What the paper's checks look at; all there are, where a kitchen has neither."""


class _Answer(BaseModel):
    verdicts: list[bool]
    reasons: list[str] = Field(default_factory=list)


class VlmChecker(ModelRole):
    """Shows the robots' pictures that the kitchen gives (obs="state+images"); without any, the model has what the
    grippers feel and how the last commands were reported. What it does not judge counts as true.

    Raises:
        OptionError: for a model that takes no images.
    """

    role = "checker"
    asks_once = "picture"

    def open(self) -> None:
        """Refuse a model without eyes."""
        if not self.client.endpoint.model.images:
            name = self.client.endpoint.name
            raise OptionError(f"checker {name!r} takes no images; valid: a model that does, or 'truth'")

    def check(self, conditions: Sequence[Condition], view: View) -> list[Verdict]:
        """One verdict a condition, in order; nothing is asked about no conditions."""
        if not conditions:
            return []
        shown = _pictures(view, conditions)
        fields = {
            "pictures": "; ".join(shown),
            "grippers": "; ".join(f"{robot} holds {wording.held(view, robot)}" for robot in view.scene.robots),
            "reports": "; ".join(f"{robot}: {_status(view.reports.get(robot))}" for robot in view.scene.robots),
            "conditions": wording.numbered(condition.sentence for condition in conditions),
        }

        def read(text: str) -> _Answer | BadAnswer:
            answer = reads(_Answer)(text)
            if isinstance(answer, BadAnswer) or len(answer.verdicts) == len(conditions):
                return answer
            return BadAnswer(f"{len(answer.verdicts)} verdicts for {len(conditions)} sentences")

        images = [Picture.of(picture) for picture in shown.values()]
        answer = self.ask("checker", fields, read, about=f"{len(conditions)} conditions", images=images)
        if isinstance(answer, BadAnswer):
            return [Verdict(condition, True, f"not judged: {answer.problem}") for condition in conditions]
        reasons = [wording.one_line(reason) for reason in answer.reasons] + [""] * len(conditions)
        judged = zip(conditions, answer.verdicts, reasons, strict=False)
        return [Verdict(condition, value, reason) for condition, value, reason in judged]


def _pictures(view: View, conditions: Sequence[Condition]) -> dict[str, Any]:
    """Name -> picture, of the robots that the conditions speak of, or of all."""
    named = {name for condition in conditions for name in condition.args}
    robots = [robot for robot in view.images if robot in named] or list(view.images)
    return {
        f"{robot}, {camera} camera": view.images[robot][camera]
        for robot in robots
        for camera in [name for name in CAMERAS if name in view.images[robot]] or view.images[robot]
    }


def _status(report: Report | None) -> str:
    if report is None:
        return "none yet"
    return f"{report.status} ({report.reason})" if report.reason else report.status
