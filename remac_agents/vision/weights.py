"""Weights of a checker that sees, as a file: arrays of NumPy and a text of JSON that says what they are. No code.

    about            a text of JSON: the fields of `About`
    sample_station, sample_wrist   (k, SIZE, SIZE, 3) pictures, and `sample_answer` (k, n, 3): what the network says
                     about them to `About.sample`
and the arrays of `remac_agents.vision.network.Network`, 16-bit numbers.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from remac_agents.vision.network import ANSWERS, CAMERAS, LARGEST, SIZE, Network, Numbers, Picture, Words
from remac_agents.vision.questions import RARE, Question, kinds_of, predicates
from remac_env.array_files import UNREADABLE, read_bytes, unpacked
from remac_env.errors import OptionError
from remac_env.files import prepare_file

FORMAT = "remac-checker-3"
"""Raised whenever the same numbers would answer otherwise, or pictures are drawn otherwise."""

SUFFIX = ".npz"
SHIPPED = Path(__file__).with_name("shipped") / f"vision{SUFFIX}"
"""The weights that come with the package."""

_SAME = 2e-2  # by which logits of the sample may differ from machine to machine
_UNPACKED = 2 * LARGEST  # bytes of all arrays, pictures of the sample among them


@dataclass(frozen=True, kw_only=True)
class About:
    """What a file says of its network.

    Attributes:
        predicates, words: what it can be asked, in the order of its embeddings.
        temperature: by which logits are divided.
        common: the words that were met in many kitchens.
        least: kind of question (`questions.kinds_of`) -> the probability from which on "true", and "false", is said.
            Each predicate has them, alone and with what was rarely met.
        sample: the questions that were put to the sample, each [predicate, name, ...].
        views: pictures that it learnt from, pairs of them. seeds: part ("train", "calibrate", "test") -> the episodes'
            seeds as text. layouts, styles, tasks: part -> names.
        data, code: digests of the pictures, and of the code that recorded them and trained.
        measured: predicate -> figures on the part "test".
    """

    predicates: tuple[str, ...]
    words: tuple[str, ...]
    common: tuple[str, ...] = ()
    temperature: float = 1.0
    least: Mapping[str, Sequence[float]] = field(default_factory=dict)
    sample: tuple[Sequence[str], ...] = ()
    views: int = 0
    seeds: Mapping[str, str] = field(default_factory=dict)
    layouts: Mapping[str, Sequence[str]] = field(default_factory=dict)
    styles: Mapping[str, Sequence[str]] = field(default_factory=dict)
    tasks: Mapping[str, Sequence[str]] = field(default_factory=dict)
    data: str = ""
    code: str = ""
    measured: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    format: str = FORMAT

    def levels(self, question: Question) -> Sequence[float]:
        """The probabilities from which on a question is answered with "true", and with "false"."""
        return next(self.least[kind] for kind in kinds_of(question, self.common) if kind in self.least)


@dataclass(frozen=True, kw_only=True, eq=False)
class Weights:
    """A network that was trained and what is known of it. `sample`: pairs of pictures, as CAMERAS. `sha256`: of the
    file, "" before it is one."""

    about: About
    network: Network
    sample: tuple[tuple[Picture, Picture], ...]
    sha256: str = ""


def save_weights(path: str | Path, weights: Weights) -> None:
    """Write weights as a file of the format above.

    Raises:
        OptionError: if the path does not end in .npz or cannot be written, or the file would be too large.
    """
    if Path(path).suffix != SUFFIX:
        raise OptionError(f"weights {str(path)!r} is not valid; valid: a path that ends in {SUFFIX}")
    halves = {name: array.astype(np.float16) for name, array in weights.network.arrays.items()}
    rounded = Network(weights.network.words, {name: array.astype(np.float32) for name, array in halves.items()})
    target = prepare_file(path, "weights")
    np.savez_compressed(
        target, about=np.array(json.dumps(asdict(weights.about) | {"format": FORMAT})),
        sample_station=np.array([station for station, _ in weights.sample]),
        sample_wrist=np.array([wrist for _, wrist in weights.sample]),
        sample_answer=_answers(rounded, weights.about, weights.sample),
        **halves,  # type: ignore[arg-type]
    )  # fmt: skip
    if target.stat().st_size > LARGEST:
        raise OptionError(f"weights {str(path)!r} have {target.stat().st_size} bytes; valid: at most {LARGEST}")


def read_weights(path: str | Path) -> Weights:
    """The weights of a file. Nothing in it is run: arrays of objects, which NumPy would unpickle, are refused.

    Raises:
        OptionError: if it cannot be read, is damaged, or was made for other questions or another player.
    """
    try:
        data = read_bytes(path, LARGEST)
        arrays = unpacked(data, _UNPACKED)
        about = _about(json.loads(str(arrays.pop("about"))))
        station, wrist, answer = (arrays.pop(f"sample_{name}") for name in (*CAMERAS, "answer"))
        network = Network(
            Words(about.predicates, about.words), {name: array.astype(np.float32) for name, array in arrays.items()}
        )
        sample = _sample(station, wrist)
        _check_fit(about, network, sample, answer)
    except OptionError as error:
        raise OptionError(f"weights {str(path)!r} cannot be used: {error}") from error
    except UNREADABLE as error:
        raise OptionError(f"weights {str(path)!r} cannot be read: {type(error).__name__}: {error}") from error
    return Weights(about=about, network=network, sample=sample, sha256=hashlib.sha256(data).hexdigest())


def kept_weights(path: str | Path) -> Weights:
    """The same; a file is read once in a process, and again when it has changed. Errors as in `read_weights`."""
    try:
        changed = Path(path).stat().st_mtime_ns
    except OSError as error:
        raise OptionError(f"weights {str(path)!r} cannot be read: {error}") from error
    return _kept(str(path), changed)


@lru_cache(maxsize=4)
def _kept(path: str, changed: int) -> Weights:
    return read_weights(path)


def _about(told: Any) -> About:
    if not isinstance(told, dict):
        raise OptionError("it does not say what it is")
    if told.get("format") != FORMAT:
        raise OptionError(f"it was made for format {told.get('format')!r}, and this is {FORMAT}; train it anew")
    known = {each.name for each in fields(About)}
    if set(told) != known:
        raise OptionError(f"it says {', '.join(sorted(told))}; valid: {', '.join(sorted(known))}")
    given: dict[str, Any] = {name: tuple(value) if isinstance(value, list) else value for name, value in told.items()}
    about = About(**given)
    if strange := [name for name in about.predicates if name not in predicates()]:
        told = ", ".join(map(repr, strange))
        raise OptionError(f"it answers {told}; valid: {', '.join(predicates())}; train it anew")
    if not all(isinstance(word, str) for word in (*about.predicates, *about.words, *about.common)):
        raise OptionError("its predicates and words are not all texts")
    _check_numbers(about)
    return about


def _check_numbers(about: About) -> None:
    warm = isinstance(about.temperature, int | float) and 0.0 < about.temperature < 100.0
    needed = {kind for name in about.predicates for kind in (name, f"{name} {RARE}")}
    pairs = [about.least.get(kind) for kind in needed | set(about.least)]
    likely = all(
        isinstance(pair, list | tuple) and len(pair) == 2 and all(_is_share(share) for share in pair) for pair in pairs
    )
    if not warm or not likely:
        raise OptionError("its temperature or its least probabilities are not valid; valid: above 0, and 0..1 for each")


def _is_share(value: object) -> bool:
    """Whether it is a probability; above 1 stands for "never"."""
    return isinstance(value, int | float) and not isinstance(value, bool) and 0.0 <= value <= 2.0


def _sample(station: Any, wrist: Any) -> tuple[tuple[Picture, Picture], ...]:
    shape = (len(station), SIZE, SIZE, 3)
    pictures = station.shape == wrist.shape == shape and station.dtype == wrist.dtype == np.uint8
    if not len(station) or not pictures:
        raise OptionError("it has no sample of what its network says")
    return tuple(zip(station, wrist, strict=True))


def _answers(network: Network, about: About, sample: Sequence[tuple[Picture, Picture]]) -> Numbers:
    questions = [Question(predicate, tuple(names)) for predicate, *names in about.sample]
    found = [network.answer(network.look(dict(zip(CAMERAS, pair, strict=True))), questions, "") for pair in sample]
    return np.array(found, np.float32)


def _check_fit(
    about: About, network: Network, sample: Sequence[tuple[Picture, Picture]], answer: Numbers
) -> None:
    if not about.sample or any(network.words.unknown(Question(p, tuple(names))) for p, *names in about.sample):
        raise OptionError("it has no sample of what its network says")
    found = _answers(network, about, sample)
    if found.shape[-1] != len(ANSWERS) or found.shape != answer.shape or not np.allclose(found, answer, atol=_SAME):
        raise OptionError("its network does not say what it said when it was saved: the file is damaged")
