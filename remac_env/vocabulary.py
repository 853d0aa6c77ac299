"""Tokens: one whole number a subtask, fixed and versioned, derived from the nouns and the skill table."""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from remac_env.errors import KitchenFileError, OptionError, UnknownNameError
from remac_env.quoting import quoted
from remac_env.rules.facts import Rules
from remac_env.rules.scene import PublicScene, public_scene
from remac_env.rules.skill_row import TargetKind
from remac_env.rules.skills import SKILLS
from remac_env.rules.subtasks import Subtask
from remac_env.values import python_fields, python_value
from remac_env.words import normalise


def _bare() -> tuple[str, ...]:
    """The skills without a target."""
    return tuple(name for name, skill in SKILLS.items() if skill.target == "none")


def _shared() -> tuple[str, ...]:
    """The skills that every noun has without listing them: each can be gone to."""
    return tuple(name for name, skill in SKILLS.items() if skill.target == "thing" and skill.moves)


def _uses() -> tuple[str, ...]:
    """The skills that a noun lists among its uses."""
    return tuple(name for name in SKILLS if name not in (*_bare(), *_shared()))


@dataclass(frozen=True, slots=True)
class Noun:
    """A `name` that commands may say, of a `kind`: fixture or object.

    `uses` are skills beside those that every noun has (`navigate to`).
    """

    name: str
    kind: Literal["fixture", "object"]
    uses: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Take values of NumPy as Python's."""
        python_fields(self)


class Vocabulary:
    """The subtasks of all kitchens by token; token 0 is `wait`, token 1 is `done`.

    Args:
        nouns: in the order of their tokens. One that comes again has further uses: their tokens come there, so that
            those before do not move.
        words: tokens after all others that are no subtasks and no command of a planner, such as `continue`.

    Attributes:
        entries, nouns: the nouns as given, and each once with all its uses.
        version: raised whenever a token comes to mean something else.
        words: as given.
    """

    def __init__(self, nouns: Iterable[Noun], *, version: int, words: Iterable[str] = ()) -> None:
        self.entries = tuple(nouns)
        found: dict[str, Noun] = {}
        for noun in self.entries:
            if not noun.name or normalise(noun.name) != noun.name or "," in noun.name:
                raise OptionError(f"noun {noun.name!r} is not valid; valid: lower case words, spaces between them")
            old = found.get(noun.name, noun)
            if old.kind != noun.kind:
                raise OptionError(f"noun {noun.name!r} is a {old.kind} and a {noun.kind}; valid: one of both")
            found[noun.name] = Noun(noun.name, noun.kind, tuple(dict.fromkeys((*old.uses, *noun.uses))))
        self.nouns = tuple(found.values())
        self.version = version
        self._subtasks = tuple(dict.fromkeys(_subtasks(self.entries)))
        self._tokens = {subtask.text: token for token, subtask in enumerate(self._subtasks)}
        self.words = tuple(words)
        self._word_tokens = {word: len(self._subtasks) + place for place, word in enumerate(self.words)}
        self._targets = tuple((s.text, s.target, SKILLS[s.skill].target) for s in self._subtasks)

    def __repr__(self) -> str:
        words = f" and {len(self.words)} words" if self.words else ""
        return f"<Vocabulary of {len(self._subtasks)} subtasks{words}, version {self.version}>"

    def __len__(self) -> int:
        return len(self._subtasks) + len(self.words)

    def with_words(self, words: Iterable[str]) -> Vocabulary:
        """A copy with these words as its last tokens."""
        return Vocabulary(self.entries, version=self.version, words=words)

    def extended(self, nouns: Iterable[Noun]) -> Vocabulary:
        """A copy with nouns of a task from outside appended; the tokens at hand do not move.

        Raises:
            OptionError: if a noun is known already with another kind or other uses, or has uses that there are not.
        """
        known = {noun.name: noun for noun in self.nouns}
        for noun in nouns:
            if (old := known.setdefault(noun.name, noun)) != noun:
                raise OptionError(f"noun {noun.name!r} is taken by {old}; give {noun} another name")
            if strange := set(noun.uses) - set(_uses()):
                valid = ", ".join(_uses())
                raise OptionError(f"noun {noun.name!r} has unknown uses {sorted(strange)}; valid: {valid}")
        fresh = list(known.values())[len(self.nouns) :]
        return Vocabulary((*self.entries, *fresh), version=self.version)

    def encode(self, text: str) -> int:
        """The token of a command.

        Raises:
            UnknownNameError: if no command reads so; the message offers the nearest ones.
        """
        token = None
        if isinstance(text, str):
            # Most are written as they are here, and to find the plain form of one takes most of the time.
            token = self._tokens.get(text)
            token = self._tokens.get(normalise(text), self._word_tokens.get(text)) if token is None else token
        if token is None:
            raise UnknownNameError(f"unknown subtask {quoted(text)}; {self._nearest(text)}")
        return token

    def decode(self, token: int) -> str:
        """The command or word of a token."""
        word = self.word(token)
        return self.subtask(token).text if word is None else word

    def word(self, token: int) -> str | None:
        """The word of a token that is no subtask; None for any other."""
        token = python_value(token)
        return next((word for word, number in self._word_tokens.items() if number == token), None)

    def subtask(self, token: int) -> Subtask:
        """The subtask of a token.

        Raises:
            UnknownNameError: if the token is outside 0..len-1.
        """
        token = python_value(token)
        whole = isinstance(token, int) and not isinstance(token, bool)
        if not whole or not 0 <= token < len(self._subtasks):
            raise UnknownNameError(f"unknown token {quoted(token)}; valid: 0..{len(self._subtasks) - 1}")
        return self._subtasks[token]

    def parse(self, text: str) -> Subtask | None:
        """The subtask that a text names exactly (case, spaces and a final stop do not matter), or None."""
        token = self._tokens.get(normalise(text))
        return None if token is None else self._subtasks[token]

    def mask(self, scene: Rules) -> NDArray[np.int8]:
        """1 for every token whose noun exists in this kitchen; shape (len,). Grammar, not feasibility."""
        mask = np.zeros(len(self), np.int8)
        mask[list(self.legal(scene).values())] = 1
        return mask

    def legal(self, scene: Rules) -> dict[str, int]:
        """Text -> token of every legal command of this kitchen, in token order."""
        names = _names(public_scene(scene))
        return {
            text: token for token, (text, target, kind) in enumerate(self._targets) if target in names[kind]
        }

    def commands(self, scene: Rules) -> tuple[str, ...]:
        """Every legal command of this kitchen as text, in token order."""
        return tuple(self.legal(scene))

    def _nearest(self, text: str) -> str:
        near = difflib.get_close_matches(normalise(str(text)), self._tokens, n=3, cutoff=0.4)
        return "did you mean " + ", ".join(repr(n) for n in near) + "?" if near else "see env.vocabulary"


def _names(scene: PublicScene) -> dict[TargetKind, frozenset[str]]:
    """Kind of target -> what can be one here: a kitchen may lack doors."""
    kinds = {skill.target for skill in SKILLS.values()}
    return {kind: frozenset(("",) if kind == "none" else scene.names(kind)) for kind in kinds}


def _subtasks(nouns: Iterable[Noun]) -> Iterable[Subtask]:
    yield from (Subtask(name) for name in _bare())
    for noun in nouns:
        yield from (Subtask(skill, noun.name) for skill in (*_shared(), *_uses()) if skill in (*_shared(), *noun.uses))


def make_noun(entry: Mapping[str, object], *, file: str) -> Noun:
    """A noun from its table in a TOML file; KitchenFileError, which names it, for a kind or use that there is not."""
    name, kind = str(entry.get("name", "")), entry.get("kind")
    uses = entry.get("uses", [])
    if kind not in ("fixture", "object"):
        raise KitchenFileError(file, f"noun {name!r}, kind", f"got {kind!r}", ("fixture", "object"))
    if not isinstance(uses, list) or any(use not in _uses() for use in uses):
        raise KitchenFileError(file, f"noun {name!r}, uses", f"got {uses!r}", _uses())
    return Noun(name, kind, tuple(uses))  # type: ignore[arg-type]


@lru_cache(maxsize=1)
def built_in() -> Vocabulary:
    """The vocabulary of the built-in tasks."""
    data = tomllib.loads(resources.files("remac_env").joinpath("nouns.toml").read_text("utf-8"))
    nouns = [make_noun(entry, file="nouns.toml") for entry in data["noun"]]
    return Vocabulary(nouns, version=int(data["version"]))
