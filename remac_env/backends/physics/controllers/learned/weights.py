"""Learned skills as files: arrays of NumPy and a text of JSON that says what they are. No code is in them.

    about        a text of JSON: the fields of `About`
    sample       (k, n) of what the network is shown, and `answer` (k, chunk, m): what the network says to them
and the arrays of :class:`~remac_env.backends.physics.controllers.learned.network.Network`.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np

from remac_env.array_files import UNREADABLE, read_bytes, unpacked
from remac_env.backends.physics.controllers.learned.network import HAND, LARGEST, Network, Numbers, commanded
from remac_env.backends.physics.controllers.learned.seen import VERSION, Entry, entries, taught
from remac_env.errors import OptionError
from remac_env.files import prepare_file
from remac_env.quoting import quoted
from remac_env.robots import bodies
from remac_env.robots.bodies import STANDARD
from remac_env.rules.skills import SKILLS
from remac_env.seeding import digest

FORMAT = "remac-skill-2"
"""Raised whenever the same numbers would move a robot otherwise."""

SUFFIX = ".npz"
_MOST = 64  # observations of the sample at most
_SAME = 1e-2  # standard deviations by which what it says to the sample may differ from machine to machine


SEVERAL = "several"
"""What `About.skill` says of a network for several skills."""


GOOD = 0.9
"""Of trials in a case that have to succeed: where fewer do, the skill stays scripted."""


def observation(skill: str, body: str = STANDARD) -> str:
    """A name for what a policy of this skill sees, of robots with this body: version, names, units and ranges."""
    return digest([VERSION, [list(entry) for entry in _entries(skill, body)]])


def _entries(skill: str, body: str) -> tuple[Entry, ...]:
    """What is seen, apart from words. Several skills see what all skills that do not move the base see."""
    row = next(row for row in taught() if not row.moves) if skill == SEVERAL else SKILLS[skill]
    return entries(row, body)


def bag(words: Sequence[str], text: str) -> Numbers:
    """A command as numbers (n,): how often it has each of the words."""
    said = text.split()
    return np.array([said.count(word) for word in words], np.float32)


@dataclass(frozen=True, kw_only=True)
class About:
    """What a file says of its network.

    Attributes:
        skill: the skill by its name in the table; or SEVERAL, and `skills` are their names.
        targets: what its demonstrations were about, which is what it is played for; empty: anything.
        execute: how many commands of a chunk are carried out before the next observation.
        demonstrations, seeds, layouts, styles: what it was trained on; seeds as "first:last".
        data, code: digests of the demonstrations and of the code that trained it.
        measured: name of a set of trials -> {"trials": n, "successes": k}.
        format, observation, body: what it fits.
        words: of commands, whose `bag` the network is shown behind the observation; empty: none.
        cases: of skills that take or put: what was shown, the skill before what `case_of` says; empty: anything.
    """

    skill: str
    targets: tuple[str, ...]
    execute: int
    demonstrations: int = 0
    seeds: str = ""
    layouts: tuple[str, ...] = ()
    styles: tuple[str, ...] = ()
    data: str = ""
    code: str = ""
    measured: Mapping[str, Mapping[str, int]] = field(default_factory=dict)
    format: str = FORMAT
    observation: str = ""
    body: str = ""
    skills: tuple[str, ...] = ()
    words: tuple[str, ...] = ()
    cases: tuple[str, ...] = ()

    def plays(self, skill: str, target: str, case: str) -> bool:
        """Whether a subtask is one for it: a target that it was shown, or a case for which it is good enough."""
        return case in self.played(skill) if case and self.cases else not self.targets or target in self.targets

    def shown(self, skill: str) -> tuple[str, ...]:
        """The cases of a skill that it was shown."""
        start = f"{skill} "
        return tuple(told.removeprefix(start) for told in self.cases if told.startswith(start))

    def played(self, skill: str) -> tuple[str, ...]:
        """Those of them for which it is good enough; without trials, all of them."""
        return tuple(case for case in self.shown(skill) if self._good(f"{skill} {case}"))

    def _good(self, told: str) -> bool:
        found = [each for name, each in self.measured.items() if name.partition(": ")[0] == told]
        return sum(each["successes"] for each in found) >= GOOD * sum(each["trials"] for each in found)

    @property
    def known(self) -> tuple[str, ...]:
        """The skills that it has learnt."""
        return self.skills if self.skill == SEVERAL else (self.skill,)


@dataclass(frozen=True, kw_only=True, eq=False)
class Weights:
    """A skill that was learnt: its network and what is known of it. ``sha256``: of the file, "" before it is one."""

    about: About
    network: Network
    sample: Numbers
    sha256: str = ""


def save_weights(path: str | Path, weights: Weights, body: str = STANDARD) -> None:
    """Write a skill as a file of the format above; matrices as 16-bit numbers.

    Args:
        body: the name of the body that it was trained with.

    Raises:
        OptionError: if the path does not end in .npz or cannot be written.
    """
    if Path(path).suffix != SUFFIX:
        raise OptionError(f"weights {str(path)!r} is not valid; valid: a path that ends in {SUFFIX}")
    skill = weights.about.skill
    told = {"format": FORMAT, "observation": observation(skill, body), "body": bodies.get(body).fingerprint}
    about = asdict(weights.about) | told
    arrays = {
        name: array.astype(np.float16 if "weight" in name else np.float32)
        for name, array in weights.network.arrays.items()
    }
    rounded = Network.of({name: array.astype(np.float32) for name, array in arrays.items()})
    answer = np.array([rounded.commands(seen) for seen in weights.sample], np.float32)
    np.savez_compressed(
        prepare_file(path, "weights"), about=np.array(json.dumps(about)), sample=weights.sample, answer=answer,
        **arrays,  # type: ignore[arg-type]
    )  # fmt: skip


def read_weights(path: str | Path, body: str = STANDARD) -> Weights:
    """The skill of a file. Nothing in it is run: arrays of objects, which NumPy would unpickle, are refused.

    Args:
        body: the name of the body that it has to have been trained with.

    Raises:
        OptionError: if it cannot be read, is damaged, or was made for another observation, body or player.
    """
    try:
        data = read_bytes(path, LARGEST)
        arrays = unpacked(data, LARGEST)
        about = _about(json.loads(str(arrays.pop("about"))), body)
        numbers = {name: _numbers(name, array) for name, array in arrays.items()}
        sample, answer = numbers.pop("sample"), numbers.pop("answer")
        network = Network.of(numbers)
        _check_fit(about, network, sample, answer, body)
    except OptionError as error:
        raise OptionError(f"weights {str(path)!r} cannot be used: {error}") from error
    except UNREADABLE as error:
        raise OptionError(f"weights {str(path)!r} cannot be read: {type(error).__name__}: {error}") from error
    return Weights(about=about, network=network, sample=sample, sha256=hashlib.sha256(data).hexdigest())


def _numbers(name: str, array: Any) -> Numbers:
    """An array as it is calculated with; texts and whole numbers, which it might be cast from, are refused."""
    if not np.issubdtype(array.dtype, np.floating):
        raise OptionError(f"array {name!r} holds {array.dtype}; valid: numbers with a point")
    with np.errstate(all="ignore"):  # what is too large becomes infinite, which no network may hold
        return np.asarray(array, np.float32)


def _about(told: Any, body: str) -> About:
    if not isinstance(told, dict):
        raise OptionError("it does not say what it is")
    for name, fits, mend in (
        ("format", FORMAT, "train it anew"),
        ("body", bodies.get(body).fingerprint, f"train it with {body!r} (remac learn), or take scripted skills"),
    ):
        if told.get(name) != fits:
            raise OptionError(f"it was made for {name} {told.get(name)!r}, and this is {fits}; {mend}")
    skills = [skill.name for skill in taught()]
    if told.get("skill") not in [*skills, SEVERAL]:
        raise OptionError(f"skill {told.get('skill')!r} is not valid; valid: {', '.join(skills)}")
    if told.get("observation") != (fits := observation(told["skill"], body)):
        raise OptionError(f"it was made for observation {told.get('observation')!r}, and this is {fits}; train it anew")
    known = {each.name for each in fields(About)}
    if not _FIRST <= set(told) <= known:
        raise OptionError(f"it says {', '.join(sorted(told))}; valid: {', '.join(sorted(known))}")
    given: dict[str, Any] = {name: tuple(value) if isinstance(value, list) else value for name, value in told.items()}
    made = About(**given)
    for name, (is_one, valid) in _KINDS.items():
        if not is_one(getattr(made, name)):
            raise OptionError(f"{name} {quoted(getattr(made, name))} is not valid; valid: {valid}")
    if made.skill == SEVERAL and not (made.skills and set(made.skills) <= set(skills)):
        raise OptionError(f"skills {made.skills!r} are not valid; valid: {', '.join(skills)}")
    return made


def _is_count(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0


def _are_texts(value: object) -> bool:
    return isinstance(value, tuple) and all(isinstance(each, str) for each in value)


def _are_trials(value: object) -> bool:
    """Whether it says how often each of some sets of trials succeeded."""
    return isinstance(value, dict) and all(
        isinstance(each, dict) and set(each) == {"trials", "successes"} and all(map(_is_count, each.values()))
        and each["successes"] <= each["trials"]
        for each in value.values()
    )  # fmt: skip


_KINDS: dict[str, tuple[Callable[[Any], bool], str]] = {
    **dict.fromkeys(("targets", "layouts", "styles", "skills", "words", "cases"), (_are_texts, "a list of texts")),
    **dict.fromkeys(("seeds", "data", "code"), (lambda value: isinstance(value, str), "a text")),
    "demonstrations": (_is_count, "a number of them"),
    "measured": (_are_trials, "trials and successes of each set"),
}
"""What fields of `About` hold beside those that are compared with what they have to be."""


_FIRST = {each.name for each in fields(About)} - {"skills", "words", "cases"}
"""What files have said from the beginning."""


def _check_fit(about: About, network: Network, sample: Numbers, answer: Numbers, body: str) -> None:
    size, told = len(_entries(about.skill, body)) + len(about.words), commanded(bodies.get(body))
    if network.out_mean.shape[1] not in (told, told + HAND):
        given = f"its network gives {network.out_mean.shape[1]} numbers a command"
        raise OptionError(f"{given}; valid: {told}, or with the hand {told + HAND}")
    if len(network.mean) != size:
        raise OptionError(f"its network takes {len(network.mean)} numbers; valid: {size}")
    whole = isinstance(about.execute, int) and not isinstance(about.execute, bool)
    if not whole or not 1 <= about.execute <= network.chunk:
        raise OptionError(f"execute {quoted(about.execute)} is not valid; valid: 1..{network.chunk}")
    shapes = sample.shape[1:], answer.shape[1:]
    if shapes != ((size,), network.out_mean.shape) or not 1 <= len(sample) <= _MOST:
        raise OptionError("it has no sample of what its network says")
    found = np.array([network.commands(seen) for seen in sample])
    if found.shape != answer.shape or not np.allclose(found / network.out_std, answer / network.out_std, atol=_SAME):
        raise OptionError("its network does not say what it said when it was saved: the file is damaged")
