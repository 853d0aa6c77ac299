"""What roles answer, read into values of our own: number, type and names are checked, whoever fills the role.

Whatever is not valid raises an AnswerError that names role, class, what was given and what is valid. What is returned
holds no object of the role's own: plain texts, numbers, subtasks and conditions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass
from typing import Any

import numpy as np

from remac_agents.plan import MAX_STEPS, Commands, first_of, is_unordered
from remac_agents.roles import (
    AdjustRequest,
    Advice,
    ExplainRequest,
    Explanation,
    FreeText,
    SeenStep,
    Summary,
    Verdict,
    View,
    last_tries,
)
from remac_agents.text.printable import is_printable, quoted, type_name
from remac_env.errors import RemacError
from remac_env.rules.conditions import Condition, Denial, denied
from remac_env.rules.predicates import PREDICATES
from remac_env.rules.scene import NAME_KINDS
from remac_env.rules.skills import SKILLS
from remac_env.rules.subtasks import DONE, WAIT, Subtask

LONGEST = 4_000
"""Characters of a text that a role may answer with: a lesson, a reason, an event."""

MOST_CONDITIONS = 100
"""Conditions of one answer."""

MOST_LESSONS = 50
"""Lessons of one answer."""

MOST_EVENTS = 1_000
"""Lines of one summary."""


class AnswerError(RemacError, ValueError):
    """A role's answer that is not valid: the agent's failure."""


@dataclass(frozen=True)
class Answers:
    """Reads the answers of one role. `role`: as in `Roles`; `filled_by`: who fills it."""

    role: str
    filled_by: object

    def verdicts(self, answer: object, conditions: Sequence[Condition]) -> list[Verdict]:
        """One verdict for each condition, in the order of the conditions; `value` None says: cannot tell."""
        valid = f"{len(conditions)} Verdicts, one for each condition that was given"
        given = self._ordered("check()", answer, len(conditions) + 1, valid)
        if len(given) != len(conditions):
            told = f"{len(given)}" if len(given) <= len(conditions) else f"more than {len(conditions)}"
            raise self._error("check()", f"{told} verdicts for {len(conditions)} conditions", valid)
        left: dict[Condition, list[tuple[Any, str]]] = {}
        for verdict in given:
            if not isinstance(verdict, Verdict):
                raise self._error("check()", quoted(verdict), valid)
            left.setdefault(self._asked(verdict.condition, conditions), []).append(self._verdict(verdict))
        read = []
        for condition in conditions:
            if not left.get(condition):
                raise self._error("check()", f"no verdict on {condition.sentence!r}", valid)
            value, reason = left[condition].pop(0)
            read.append(Verdict(condition, value, reason))
        return read

    def conditions(self, verb: str, answer: object, view: View) -> list[Condition]:
        """Conditions about this kitchen, each with names that are in it."""
        valid = f"a list of at most {MOST_CONDITIONS} remac_env.rules.conditions.Condition"
        given = self._ordered(verb, answer, MOST_CONDITIONS + 1, valid)
        if len(given) > MOST_CONDITIONS:
            raise self._error(verb, f"more than {MOST_CONDITIONS} conditions", valid)
        return [self._condition(verb, condition, view, valid) for condition in given]

    def advice(self, answer: object, request: AdjustRequest) -> Advice:
        """Advice whose steps are commands of this kitchen."""
        if not isinstance(answer, Advice):
            raise self._error("adjust()", quoted(answer), "a remac_agents.roles.Advice")
        commands = Commands(request.commands)
        known = {WAIT, DONE, *(step for row in request.plan.rows.values() for step in row)}
        steps = {
            name: self._steps(name, getattr(answer, name), commands, known) for name in ("next_steps", "remedy")
        }
        row = None if answer.row is None else self._steps("row", answer.row, commands, known)
        instead = None if answer.instead is None else self._steps("instead", [answer.instead], commands, known)[0]
        left_out = self._truth("adjust()", answer.left_out, "left_out: True or False")
        reason = self.text("adjust()", answer.reason, "reason")
        return Advice(reason, steps["next_steps"], row, steps["remedy"], instead, left_out)

    def texts(self, verb: str, answer: object, most: int = MOST_LESSONS) -> list[str]:
        """Texts of a length that fits a prompt."""
        given = self._ordered(verb, answer, most + 1, f"a list of at most {most} texts")
        if len(given) > most:
            raise self._error(verb, f"more than {most} texts", f"a list of at most {most} texts")
        return [self.text(verb, text, "each") for text in given]

    def summary(self, answer: object, steps: Sequence[SeenStep]) -> Summary:
        """Events in any number of lines up to a bound; subgoals none at all, or one for each step's last try."""
        if not isinstance(answer, Summary):
            raise self._error("summarise()", quoted(answer), "a remac_agents.running.hindsight.Summary")
        events = self.texts("summarise()", answer.events, MOST_EVENTS)
        subgoals = self.texts("summarise()", answer.subgoals, MOST_EVENTS)
        wanted = len(last_tries(steps))
        if len(subgoals) not in (0, wanted):
            raise self._error("summarise()", f"{len(subgoals)} subgoals", f"{wanted} subgoals, or none")
        return Summary(tuple(events), tuple(subgoals))

    def explanation(self, answer: object, request: ExplainRequest, view: View | None) -> Explanation:
        """A reason, and the step at fault among those that were asked about."""
        valid = f"a remac_agents.running.hindsight.Explanation; step: None or 0..{len(request.steps) - 1}"
        if not isinstance(answer, Explanation):
            raise self._error("explain()", quoted(answer), valid)
        step = answer.step
        if step is not None:
            whole = isinstance(step, int | np.integer) and not isinstance(step, bool)
            if not whole or not 0 <= step < len(request.steps):
                raise self._error("explain()", f"step {quoted(step)}", valid)
            step = int(step)
        false = () if view is None else tuple(self.conditions("explain()", answer.false, view))
        return Explanation(self.text("explain()", answer.reason, "reason"), step, false)

    def text(self, verb: str, text: object, what: str) -> str:
        """One text that can be written and is not too long."""
        valid = f"{what}: a text of at most {LONGEST} characters that UTF-8 can write"
        if not isinstance(text, str):
            raise self._error(verb, quoted(text), valid)
        if len(text) > LONGEST:
            raise self._error(verb, f"a text of {len(text)} characters", valid)
        if not is_printable(text):
            raise self._error(verb, quoted(text), valid)
        return str.__str__(text)

    # -- inside ----------------------------------------------------------------------------------------------

    def _error(self, verb: str, given: str, valid: str) -> AnswerError:
        return AnswerError(f"{self.role} {type_name(self.filled_by)}: {verb} gave {given}; valid: {valid}")

    def _ordered(self, verb: str, answer: object, most: int, valid: str) -> list[Any]:
        """The first `most` parts of an answer that has an order."""
        if is_unordered(answer):
            raise self._error(verb, f"a {type_name(answer)}, which has no order", valid)
        parts = None if isinstance(answer, str | bytes | Mapping) else first_of(answer, most)
        if parts is None:
            raise self._error(verb, quoted(answer), valid)
        return parts

    def _verdict(self, verdict: Verdict) -> tuple[Any, str]:
        value: object = verdict.value
        if value is not None:
            value = self._truth("check()", value, "value: True, False, or None for cannot tell")
        return value, self.text("check()", verdict.reason, "reason")

    def _asked(self, condition: object, conditions: Sequence[Condition]) -> Condition:
        for asked in conditions:
            if condition is asked or (isinstance(condition, Condition) and asked == condition):
                return asked
        sentence = ", ".join(repr(asked.sentence) for asked in conditions[:3])
        raise self._error("check()", f"a verdict on {quoted(condition)}", f"the conditions given: {sentence}")

    def _truth(self, verb: str, value: object, valid: str) -> bool:
        if not isinstance(value, bool | np.bool_):
            raise self._error(verb, quoted(value), valid)
        return bool(value)

    def _condition(self, verb: str, condition: object, view: View, valid: str) -> Condition:
        if not isinstance(condition, Condition):
            raise self._error(verb, quoted(condition), valid)
        predicate, args = condition.predicate, condition.args
        if isinstance(condition, Denial) and isinstance(args, tuple) and args:
            return denied(self._condition(verb, condition.condition, view, valid))
        if isinstance(condition, FreeText):
            texts = args if isinstance(args, tuple) and len(args) == 1 else (None,)
            return FreeText.of(self.text(verb, texts[0], "a sentence"))
        if not isinstance(predicate, str) or predicate not in PREDICATES:
            raise self._error(verb, f"predicate {quoted(predicate)}", f"one of {', '.join(PREDICATES)}")
        kinds = PREDICATES[predicate].about
        names = _names(view)
        fits = isinstance(args, tuple) and len(args) == len(kinds)
        if not fits or not all(_is_name(arg, names.get(kind)) for arg, kind in zip(args, kinds, strict=True)):
            told = f"{predicate} of {', '.join(kinds)}: names of this kitchen"
            raise self._error(verb, f"{predicate} of {quoted(args)}", told)
        return Condition(str.__str__(predicate), tuple(str.__str__(arg) for arg in args))

    def _steps(self, name: str, given: object, commands: Commands, known: Set[Subtask]) -> tuple[Subtask, ...]:
        valid = f"{name}: subtasks that are commands of this kitchen, at most {MAX_STEPS}"
        steps = self._ordered("adjust()", given, MAX_STEPS + 1, valid)
        if len(steps) > MAX_STEPS:
            raise self._error("adjust()", f"more than {MAX_STEPS} steps", valid)
        read = []
        for step in steps:
            text = _command(step)
            own = None if text is None else commands.parse(text) or next((s for s in known if s.text == text), None)
            if own is None:
                raise self._error("adjust()", quoted(step) if text is None else commands.unknown(text), valid)
            read.append(own)
        return tuple(read)


def _command(step: object) -> str | None:
    """The text of a subtask, or a text as it is; None for anything else."""
    if isinstance(step, str):
        return str.__str__(step)
    if not isinstance(step, Subtask) or not isinstance(step.skill, str) or not isinstance(step.target, str):
        return None
    return SKILLS[step.skill].form.format(str.__str__(step.target)) if step.skill in SKILLS else None


def _names(view: View) -> dict[str, frozenset[str]]:
    """Kind of argument -> the names that it may be."""
    names: dict[str, frozenset[str]] = {kind: frozenset(view.scene.names(kind)) for kind in NAME_KINDS}
    # A sentence about the door of a fixture without one is false, not malformed.
    return names | {"vessel": names["object"], "door": names["fixture"], "switch": names["fixture"]}


def _is_name(arg: object, valid: frozenset[str] | None) -> bool:
    """Whether an argument is a text, and one of the valid names where there is a list of them."""
    return isinstance(arg, str) and (valid is None or arg in valid)
