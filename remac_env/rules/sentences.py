"""Sentences read back as conditions: whatever the predicates can say of one kitchen, in many words."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from functools import lru_cache

from remac_env.rules.conditions import Condition, denied
from remac_env.rules.paraphrases import plain_form, table, undenied
from remac_env.rules.predicates import PREDICATES, ArgumentKind
from remac_env.rules.scene import PublicScene
from remac_env.rules.skills import marks
from remac_env.words import normalise


def sentence_forms(*, leave_out: tuple[str, ...] = ()) -> tuple[str, ...]:
    """The sentence of every predicate but those left out, with the kinds of names in capitals, and each mark."""
    words = {"mark": marks()}
    return tuple(
        row.sentence.format(*names)
        for row in PREDICATES.values()
        for names in itertools.product(*(words.get(kind, (kind.upper(),)) for kind in row.about))
        if row.name not in leave_out
    )


def read_condition(text: str, scene: PublicScene, *, robot: str = "") -> Condition | None:
    """The condition that a sentence states about this kitchen; None for any other words.

    Case, spaces, quotes, a stop at the end, underscores and articles do not matter, nor do the other words that
    paraphrases.toml lists ("is inside", "is holding", "isn't open"). A sentence that denies one of these is a Denial,
    unless a predicate says just that. Letters that only look like those of a sentence do not count as them.

    Args:
        robot: who is meant by "the robot" and "its gripper", where the text names no robot.
    """
    if not text.isascii():
        return None
    exact, loose = _by_sentence(scene, _forms(), marks())
    plain, denial = _plain(text), _plain(_DENIAL) + " "
    if (known := exact.get(plain.removeprefix(denial))) is not None:
        return denied(known) if plain.startswith(denial) else known
    text = _with_name(text, scene, robot)
    if (same := loose.get(plain_form(text))) is not None:
        return same
    opposite = loose.get(undenied(text) or "")
    return None if opposite is None else denied(opposite)


def predicate_of(sentence: str) -> str | None:
    """The predicate whose sentence this is, whatever kitchen it speaks of; None for other words.

    Of a denial "not " and the predicate.
    """
    if sentence.startswith(_DENIAL):
        denied_one = predicate_of(sentence.removeprefix(_DENIAL))
        return f"not {denied_one}" if denied_one else None
    return next((name for name, shape in _shapes(_forms()) if shape.fullmatch(sentence)), None)


_DENIAL = denied(Condition("hand_empty", ("",))).sentence.removesuffix(Condition("hand_empty", ("",)).sentence)


Forms = tuple[tuple[str, tuple[ArgumentKind, ...], str], ...]


def _forms() -> Forms:
    """Name, arguments and sentence of every row: what the tables below are made from, once for each set of rows."""
    return tuple((row.name, row.about, row.sentence) for row in PREDICATES.values())


@lru_cache(maxsize=4)
def _shapes(forms: Forms) -> tuple[tuple[str, re.Pattern[str]], ...]:
    """Sentences as patterns, the most words of their own first: "holds something" is no name of an object."""
    rows = sorted(forms, key=lambda row: -len(re.sub(r"\{\d\}", "", row[2])))
    return tuple((name, re.compile(re.sub(r"\\\{\d\\\}", "(.+?)", re.escape(form)))) for name, _, form in rows)


def _plain(text: str) -> str:
    return " ".join(word for word in normalise(text).split() if word != "the")


def _with_name(text: str, scene: PublicScene, robot: str) -> str:
    """The text with the robot's name where it speaks of "the robot" or of a gripper without saying whose."""
    if not robot or any(normalise(name) in normalise(text) for name in scene.robots):
        return text
    text = re.sub(r"\bthe robot\b", robot, text, flags=re.I)
    if robot in text:
        return text
    return re.sub(r"\b(its|the) (gripper|hand)\b", f"the gripper of {robot}", text, flags=re.I)


@lru_cache(maxsize=64)
def _by_sentence(
    scene: PublicScene, forms: Forms, done: tuple[str, ...]
) -> tuple[dict[str, Condition], dict[str, Condition]]:
    """Conditions by their own words, and by the plain form of these and of others; what is ambiguous is left out."""
    said = [Condition(name, args) for name, kinds, _ in forms for args in _names(scene, kinds, done)]
    exact = {_plain(condition.sentence): condition for condition in said}
    loose: dict[str, Condition] = {plain_form(condition.sentence): condition for condition in said}
    unclear: set[str] = set()
    for condition in said:
        for form in table().also.get(condition.predicate, ()):
            other = plain_form(form.format(*condition.args))
            if loose.setdefault(other, condition) != condition:
                unclear.add(other)
    own = {plain_form(condition.sentence) for condition in said}
    return exact, {form: condition for form, condition in loose.items() if form in own or form not in unclear}


def _names(scene: PublicScene, kinds: tuple[ArgumentKind, ...], done: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    return itertools.product(*(done if kind == "mark" else scene.names(kind) for kind in kinds))
