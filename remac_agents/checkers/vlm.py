"""The checker that is a model with eyes. What a robot feels in its gripper nobody is asked about; what can be seen is
judged by pictures; what is right or possible is asked as a question of knowledge, and what has happened to objects is
judged by the commands that were run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import BaseModel, Field, field_validator

from remac_agents.checkers.felt import untold
from remac_agents.llm import BadAnswer, Picture
from remac_agents.prompting import wording
from remac_agents.prompting.model_role import ModelRole, reads
from remac_agents.prompting.prompt import load
from remac_agents.roles import StopEpisode, Verdict, View
from remac_env.errors import OptionError
from remac_env.rules.conditions import Condition

CAMERAS = ("side", "wrist")
"""What the paper's checks look at; all there are, where a kitchen has neither."""

UNSURE = ("cannot tell", "can't tell", "unknown", "unclear", "unsure", "not sure", "null", "none")
"""Words that models write where they should write null."""

Seen = Mapping[tuple[str, str], Any]
"""(robot, camera) -> picture, in the order in which they are shown."""


class _Answer(BaseModel):
    verdicts: list[bool | None]
    reasons: list[str | None] = Field(default_factory=list)

    @field_validator("verdicts", mode="before")
    @classmethod
    def _read_words(cls, given: Any) -> Any:
        return [_read_word(value) for value in given] if isinstance(given, list) else given


def _read_word(value: Any) -> Any:
    word = value.strip(" .").lower() if isinstance(value, str) else None
    return None if word in UNSURE else {"true": True, "false": False}.get(word or "", value)


class VlmChecker(ModelRole):
    """One question a kind of condition, and none about what is felt (`Condition.kind`).

    What cannot be told from the pictures of the robots at work is asked once more with those that were not shown, and
    what knowledge alone does not settle with all of them. What then is still open, or has no usable answer, is None.

    Raises:
        OptionError: for a model that takes no images.
    """

    role = "checker"
    needs_images = True

    def open(self) -> None:
        """Refuse a model without eyes."""
        if not self.client.endpoint.model.images:
            raise OptionError(
                f"checker {self.client.endpoint.name!r} takes no images, so that it cannot look; valid: a model that "
                "does (remac doctor lists them; images=true after a name says that a server's model takes them), "
                "'truth' (reads the WorldState, and is said to in every table), 'noisy', or 'none'"
            )

    def check(self, conditions: Sequence[Condition], view: View) -> list[Verdict]:
        """One verdict a condition, in order.

        Raises:
            StopEpisode: where nobody can answer, and where there are no pictures to look at.
        """
        found = {condition: untold(condition, view) for condition in conditions}
        left = [condition for condition, verdict in found.items() if verdict.value is None]
        known = [condition for condition in left if condition.kind == "known"]
        seen = [condition for condition in left if condition.kind not in ("known", "ran")]
        found |= self._ask("checker_known", known, view, {})
        found |= self._ask("checker_ran", [condition for condition in left if condition.kind == "ran"], view, {})
        if seen or any(found[condition].value is None for condition in known):
            _check_pictures(view)
        first, rest = _pictures(view, conditions)
        for prompt, asked, shown in (
            ("checker_seen", seen, first),
            ("checker_seen", seen, rest),
            ("checker_known", known, {**first, **rest}),
        ):
            again = [condition for condition in asked if found[condition].value is None]
            found |= self._ask(prompt, again, view, shown) if shown else {}
        return [found[condition] for condition in conditions]

    def _ask(
        self, prompt: str, conditions: Sequence[Condition], view: View, shown: Seen
    ) -> dict[Condition, Verdict]:
        """The answers to one question; nothing is asked about no conditions."""
        if not conditions:
            return {}
        robots = _concerned(view, conditions)
        every = {
            **wording.names(view),
            **wording.sight(view, shown),
            "grippers": "; ".join(f"{robot} holds {wording.held(view, robot)}" for robot in robots),
            "reports": "; ".join(f"{robot}: {wording.report(view.reports.get(robot))}" for robot in robots),
            "ran": wording.rounds(view.ran) or "none yet",
            "conditions": wording.numbered(condition.sentence for condition in conditions),
        }
        fields = {name: text for name, text in every.items() if name in load(prompt).fields}

        def miscounted(value: Mapping[str, Any]) -> list[str]:
            verdicts = value.get("verdicts")
            count = len(verdicts) if isinstance(verdicts, list) else len(conditions)
            return [] if count == len(conditions) else [f"{count} verdicts for {len(conditions)} sentences"]

        images = [Picture.of(picture) for picture in shown.values()]
        answer = self.ask(
            prompt, fields, reads(_Answer, miscounted), about=f"{len(conditions)} conditions", images=images
        )
        if isinstance(answer, BadAnswer):
            return {condition: Verdict(condition, None, f"not judged: {answer.problem}") for condition in conditions}
        reasons = [wording.one_line(reason or "") for reason in answer.reasons] + [""] * len(conditions)
        judged = zip(conditions, answer.verdicts, reasons, strict=False)
        return {condition: Verdict(condition, value, reason) for condition, value, reason in judged}


def _check_pictures(view: View) -> None:
    if not any(view.images.values()):
        raise StopEpisode(
            'checker: it looks at pictures, and the kitchen gives none; valid: parallel_env(..., '
            'obs="state+images", image_size=512)',
            infrastructure=True,
        )


def _concerned(view: View, conditions: Sequence[Condition]) -> list[str]:
    """The robots that conditions speak of; else the one whose subtask is checked; where it is nobody's, all."""
    named = {name for condition in conditions for name in condition.args}
    words = " ".join(condition.sentence for condition in conditions)
    spoken_of = [robot for robot in view.scene.robots if robot in named or robot in words]
    return spoken_of or [robot for robot in view.scene.robots if robot == view.robot] or list(view.scene.robots)


def _pictures(view: View, conditions: Sequence[Condition]) -> tuple[Seen, Seen]:
    """What is shown first - the side and wrist of the robots that the conditions are about - and the rest."""
    robots = [robot for robot in _concerned(view, conditions) if robot in view.images] or list(view.images)
    every = {(robot, camera): view.images[robot][camera] for robot in view.images for camera in view.images[robot]}
    first = {
        (robot, camera): every[robot, camera]
        for robot in robots
        for camera in [name for name in CAMERAS if name in view.images[robot]] or view.images[robot]
    }
    return first, {spot: picture for spot, picture in every.items() if spot not in first}
