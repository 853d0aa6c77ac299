"""Sentences read back as conditions: whatever PREDICATES and SENTENCES can say of one kitchen, in many words."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from functools import lru_cache

from remac_env.rules.conditions import Condition, denied
from remac_env.rules.facts import Rules
from remac_env.rules.marks import WASHED
from remac_env.rules.paraphrases import plain_form, table, undenied
from remac_env.rules.predicates import SENTENCES
from remac_env.rules.scene import PublicScene, public_scene
from remac_env.rules.skills import SKILLS
from remac_env.words import normalise

ARGUMENTS: dict[str, tuple[str, ...]] = {
    "at": ("robot", "thing"),
    "aside": ("robot",),
    "station_free": ("robot", "thing"),
    "hand_empty": ("robot",),
    "holding": ("robot", "object"),
    "hand_full": ("robot",),
    "holds_shaker": ("robot",),
    "placed": ("thing",),
    "accessible": ("thing",),
    "unloaded": ("object",),
    "graspable": ("object",),
    "room": ("robot", "thing"),
    "no_vessel_needed": ("robot", "thing"),
    "inside": ("object", "thing"),
    "directly_on": ("object", "vessel"),
    "door_open": ("door",),
    "door_not_open": ("door",),
    "door_closed": ("door",),
    "door_not_closed": ("door",),
    "switched_on": ("switch",),
    "switched_off": ("switch",),
    "some_on": ("switch",),
    "all_off": ("switch",),
    "may_run": ("fixture",),
    "marked": ("object", "mark"),
}
"""Predicate -> what kinds of names it is about."""


def sentence_forms(*, leave_out: tuple[str, ...] = ()) -> tuple[str, ...]:
    """The sentence of every predicate but those left out, with the kinds of names in capitals, and each mark."""
    words = {"mark": _marks()}
    return tuple(
        SENTENCES[name].format(*row)
        for name, kinds in ARGUMENTS.items()
        for row in itertools.product(*(words.get(kind, (kind.upper(),)) for kind in kinds))
        if name not in leave_out
    )


def read_condition(text: str, scene: PublicScene | Rules, *, robot: str = "") -> Condition | None:
    """The condition that a sentence states about this kitchen; None for any other words.

    Case, spaces, quotes, a stop at the end, underscores and articles do not matter, nor do the other words that
    paraphrases.toml lists ("is inside", "is holding", "isn't open"). A sentence that denies one of these is a Denial,
    unless a predicate says just that. Letters that only look like those of a sentence do not count as them.

    Args:
        robot: who is meant by "the robot" and "its gripper", where the text names no robot.
    """
    if not text.isascii():
        return None
    scene = public_scene(scene) if isinstance(scene, Rules) else scene
    exact, loose = _by_sentence(scene)
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
    return next((name for name, shape in _shapes() if shape.fullmatch(sentence)), None)


_DENIAL = denied(Condition("hand_empty", ("",))).sentence.removesuffix(Condition("hand_empty", ("",)).sentence)


@lru_cache(maxsize=1)
def _shapes() -> tuple[tuple[str, re.Pattern[str]], ...]:
    """Sentences as patterns, the most words of their own first: "holds something" is no name of a thing."""
    rows = sorted(SENTENCES.items(), key=lambda row: -len(re.sub(r"\{\d\}", "", row[1])))
    return tuple((name, re.compile(re.sub(r"\\\{\d\\\}", "(.+?)", re.escape(form)))) for name, form in rows)


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
def _by_sentence(scene: PublicScene) -> tuple[dict[str, Condition], dict[str, Condition]]:
    """Conditions by their own words, and by the plain form of these and of others; what is ambiguous is left out."""
    said = [Condition(name, args) for name, kinds in ARGUMENTS.items() for args in _names(scene, kinds)]
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


def _names(scene: PublicScene, kinds: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    fixtures, objects = scene.fixtures, scene.objects
    valid = {
        "robot": scene.robots,
        "thing": (*fixtures, *objects),
        "object": tuple(objects),
        "vessel": tuple(name for name, facts in objects.items() if facts.vessel),
        "fixture": tuple(fixtures),
        "door": tuple(name for name, facts in fixtures.items() if facts.door),
        "switch": tuple(name for name, facts in fixtures.items() if facts.switch),
        "mark": _marks(),
    }
    return itertools.product(*(valid[kind] for kind in kinds))


@lru_cache(maxsize=1)
def _marks() -> tuple[str, ...]:
    """What water leaves, and every mark that a skill of the table does."""
    achieved = (c for skill in SKILLS.values() for c in skill.achieves("", "", ""))
    return tuple(dict.fromkeys((WASHED, *(c.args[1] for c in achieved if c.predicate == "marked"))))
