"""The checker that is a small network with eyes: it judges what the station and wrist pictures show, without any key.

What a gripper feels it is told, as every checker is. It cannot tell what it is not sure of, what has not been learnt,
what leaves nothing to see, and, unless it is given the rules, what is a matter of knowledge.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from remac_agents.checkers.felt import untold
from remac_agents.checkers.knowledge import FALSE_IF_UNSEEN, ruled
from remac_agents.roles import StopEpisode, Verdict, View
from remac_agents.vision.network import CAMERAS, SIZE, Numbers, likely
from remac_agents.vision.pictures import fitted
from remac_agents.vision.questions import Question, question_of, robot_of, turned
from remac_agents.vision.weights import SHIPPED, kept_weights
from remac_env.errors import OptionError
from remac_env.rules.conditions import Condition, Denial
from remac_env.rules.predicates import PREDICATES

NOT_SEEN = "no picture shows it"
NOT_SURE = "not sure"
BY_RULE = "by the rules, from what is seen"
UNSEEN = "the rules demand what is not surely seen"

Cells = Mapping[str, Numbers]


class VisionChecker:
    """Looks at the pictures of the robot that a condition is about, else of the one whose subtask is checked.

    Where these do not tell, it looks at those of the others.

    Args:
        weights: a file that `remac learn train-checker` wrote; by default what comes with the package.
        sure: the probability from which on it gives a verdict; by default what was found on kitchens kept for that,
            for each kind of question.
        rules: whether it is given the rules, by which it judges conditions of knowledge from what it sees.

    Raises:
        OptionError: for weights that cannot be used, a probability that is not within 0..1, or rules that are neither
            true nor false.
    """

    needs_truth = needs_rules = False
    needs_images = True
    picture_size = SIZE
    """Pixels of a side of the pictures that it makes use of."""

    cameras = CAMERAS
    """Those pictures."""

    def __init__(self, *, weights: str | Path | None = None, sure: float | None = None, rules: bool = False) -> None:
        if not isinstance(rules, bool):
            raise OptionError(f"rules {rules!r} is not valid; valid: true or false")
        if sure is not None and not (isinstance(sure, int | float) and 0.0 <= sure <= 1.0):
            raise OptionError(f"sure {sure!r} is not valid; valid: a probability, 0..1")
        found = kept_weights(SHIPPED if weights is None else weights)
        self._about, self._network, self._sure = found.about, found.network, sure
        self.sha256, self.needs_rules = found.sha256, rules

    def check(self, conditions: Sequence[Condition], view: View) -> list[Verdict]:
        """One verdict a condition, in order.

        Raises:
            StopEpisode: where there are no pictures to look at.
        """
        looked: dict[str, Cells] = {}
        return [self._verdict(condition, view, looked) for condition in conditions]

    def _verdict(self, condition: Condition, view: View, looked: dict[str, Cells]) -> Verdict:
        if isinstance(condition, Denial):
            verdict = self._verdict(condition.condition, view, looked)
            return replace(verdict, condition=condition, value=None if verdict.value is None else not verdict.value)
        told = untold(condition, view)
        if told.value is not None:
            return told
        if self.needs_rules and view.rules is not None and condition.kind == "known":
            value = ruled(condition, view.rules, view.holding, lambda asked: self._verdict(asked, view, looked).value)
            if value is None and condition.predicate in FALSE_IF_UNSEEN and view.holding.get(condition.args[0]):
                return Verdict(condition, False, UNSEEN)
            return Verdict(condition, value, NOT_SURE if value is None else BY_RULE)
        question = question_of(condition)
        if question is None:
            return Verdict(condition, None, NOT_SEEN)
        carried = _carried(condition, question, view)
        if carried is not None:
            return carried
        if unknown := self._network.words.unknown(question):
            return Verdict(condition, None, f"it never learnt what {unknown!r} is")
        answers = (self._said(question, robot, view, looked) for robot in _whose(condition, view))
        value, share = next((said for said in answers if said[0] is not None), (None, 0.0))
        value = value if value is None else value != turned(condition)
        return Verdict(condition, value, NOT_SURE if value is None else f"seen, {100 * share:.0f}% sure")

    def _said(
        self, question: Question, robot: str, view: View, looked: dict[str, Cells]
    ) -> tuple[bool | None, float]:
        """What a robot's pictures say, and how likely that is."""
        if robot not in looked:
            looked[robot] = self._network.look({camera: fitted(view.images[robot][camera]) for camera in CAMERAS})
        logits = self._network.answer(looked[robot], [question], view.holding.get(robot) or "")[0]
        true, false, _ = likely(logits, self._about.temperature).tolist()
        least = self._about.levels(question) if self._sure is None else (self._sure, self._sure)
        if true >= max(least[0], false):
            return True, true
        return (False, false) if false >= least[1] else (None, 0.0)


def _carried(condition: Condition, question: Question, view: View) -> Verdict | None:
    """What follows for an object from its being felt in a gripper: it is in no place, and on or in nothing."""
    row = PREDICATES.get(condition.predicate)
    if row is not None and row.false_if_held and question.names[0] in view.holding.values():
        return Verdict(condition, False, "felt in the gripper")
    return None


def _whose(condition: Condition, view: View) -> list[str]:
    """The robots whose pictures are looked at, in order.

    Raises:
        StopEpisode: where no robot has any.
    """
    seeing = [robot for robot, seen in view.images.items() if all(camera in seen for camera in CAMERAS)]
    if not seeing:
        raise StopEpisode(
            'checker: it looks at pictures that the kitchen does not give; valid: parallel_env(..., '
            f'obs="state+images", image_size={SIZE}, cameras="{",".join(CAMERAS)}")',
            infrastructure=True,
        )
    own = robot_of(condition)
    if own is not None:
        return [robot for robot in seeing if robot == own]
    return sorted(seeing, key=lambda robot: robot != view.robot)
