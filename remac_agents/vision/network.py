"""A network that answers questions about two pictures, played with NumPy: nothing here needs torch.

Each picture becomes cells with features by convolutions of its own, and by two more, with all pictures together, some
features of the whole. A question - embeddings of its predicate, of the words of its names and of what the robot feels
in its hand - asks each cell how much it matters, several times over, and lets through of the whole what matters to it.
What is found so, and the question, say how likely it is that the answer is true, false, or not to be seen.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remac_agents.vision.questions import MOST_NAMES, Question, words_of
from remac_env.errors import OptionError

Numbers = NDArray[np.float32]
Picture = NDArray[np.uint8]

SIZE = 96
"""Pixels of a side of the pictures; larger ones are averaged down to it."""

CAMERAS = ("station", "wrist")
"""Pictures of a robot that are looked at: its place, and what its hand sees."""

STRIDES = (2, 2, 2, 1, 2, 2)
"""Of the convolutions, each of 3 by 3 with one pixel of zeros around."""

CELLS = 4
"""Convolutions after which a picture is asked cell by cell; the others lead to the features of the whole."""

HEADS = 4
"""How often a question asks the cells of a picture."""

WHOLE = "whole"

LARGEST = 2_000_000
"""Bytes of a file of weights, and of 16-bit numbers in one."""

ANSWERS = ("true", "false", "hidden")


@dataclass(frozen=True)
class Words:
    """What questions can be about: the predicates and the words of names, in the order of their embeddings."""

    predicates: tuple[str, ...]
    words: tuple[str, ...]

    def unknown(self, question: Question) -> str:
        """The first part of a question that was never learnt, "" where there is none."""
        if question.predicate not in self.predicates:
            return question.predicate
        return next((name for name in question.names if not set(words_of(name)) <= set(self.words)), "")

    def bags(self, questions: Sequence[Question], held: str) -> Numbers:
        """How often each part stands in each question, (n, predicates + (MOST_NAMES + 1) * words).

        Of unknown words of what is held nothing is told.
        """
        width, start = len(self.words), len(self.predicates)
        numbers = {word: number for number, word in enumerate(self.words)}
        found = np.zeros((len(questions), start + (MOST_NAMES + 1) * width), np.float32)
        for row, question in zip(found, questions, strict=True):
            row[self.predicates.index(question.predicate)] = 1.0
            for place, name in enumerate(question.names):
                for word in words_of(name):
                    row[start + place * width + numbers[word]] += 1.0
        for word in words_of(held):
            if word in numbers:
                found[:, start + MOST_NAMES * width + numbers[word]] += 1.0
        return found


@dataclass(frozen=True, eq=False)
class Network:
    """The arrays by name, see `shapes`.

    Raises:
        OptionError: for arrays that do not fit together, or numbers that are not finite.
    """

    words: Words
    arrays: Mapping[str, Numbers]

    def __post_init__(self) -> None:
        """Refuse what is no such network."""
        for name, array in self.arrays.items():
            if not np.issubdtype(array.dtype, np.floating) or not np.isfinite(array).all():
                raise OptionError(f"array {name!r} of the network is not made of finite numbers")
        wanted = shapes(self.words, *_sizes(self.arrays))
        found = {name: array.shape for name, array in self.arrays.items()}
        if found != wanted:
            wrong = sorted(name for name in {*found, *wanted} if found.get(name) != wanted.get(name))
            told = "; ".join(f"{name} {found.get(name, 'missing')}, not {wanted.get(name, 'there')}" for name in wrong)
            raise OptionError(f"the arrays of the network do not fit together: {told}")

    def look(self, pictures: Mapping[str, Picture]) -> dict[str, Numbers]:
        """The cells (n, features) of each camera's picture, uint8 (SIZE, SIZE, 3); under WHOLE features of all."""
        found, last = {}, []
        for camera in CAMERAS:
            found[camera], far = self._cells(camera, pictures[camera])
            last.append(far.ravel())
        whole = self.arrays["whole"] @ np.concatenate(last) + self.arrays["whole_bias"]
        return found | {WHOLE: np.maximum(whole, 0.0)}

    def answer(self, cells: Mapping[str, Numbers], questions: Sequence[Question], held: str) -> Numbers:
        """The logits (n, 3), as ANSWERS, of questions about pictures that were looked at; none may be unknown."""
        arrays, bags = self.arrays, self.words.bags(questions, held)
        asked = np.maximum(bags @ arrays["embedding"] + arrays["embedding_bias"], 0.0)
        found = [asked]
        for camera in CAMERAS:
            seen = cells[camera]
            wanted = (asked @ arrays[f"{camera}_asks"].T).reshape(len(asked), HEADS, -1)
            share = wanted @ seen.T / np.float32(np.sqrt(seen.shape[1]))
            share = np.exp(share - share.max(axis=-1, keepdims=True))
            share /= share.sum(axis=-1, keepdims=True)
            found.append((share @ seen).reshape(len(asked), -1))
        found.append(cells[WHOLE] * (asked @ arrays["gate"].T))
        hidden = np.maximum(np.concatenate(found, axis=1) @ arrays["hidden"].T + arrays["hidden_bias"], 0.0)
        return np.asarray(hidden @ arrays["last"].T + arrays["last_bias"], np.float32)

    def _cells(self, camera: str, picture: Picture) -> tuple[Numbers, Numbers]:
        """The cells of a picture, (n, features), and what the last convolution makes of it, (features, h, w)."""
        values = picture.astype(np.float32).transpose(2, 0, 1) / 255.0 - 0.5
        near = values
        for number, stride in enumerate(STRIDES):
            weights = self.arrays[f"{camera}_weight_{number}"]
            values = np.maximum(convolved(values, weights, stride) + self.arrays[f"{camera}_bias_{number}"], 0.0)
            side = int(np.sqrt(len(values)))
            values = values.T.reshape(-1, side, side)
            near = values if number < CELLS else near
        return near.reshape(len(near), -1).T + self.arrays[f"{camera}_places"], values


def likely(logits: NDArray[Any], temperature: float) -> NDArray[Any]:
    """How likely true, false and hidden are, (..., 3), from logits of this shape."""
    powers = np.exp((logits - logits.max(axis=-1, keepdims=True)) / temperature)
    return np.asarray(powers / powers.sum(axis=-1, keepdims=True))


def convolved(values: Numbers, weights: Numbers, stride: int) -> Numbers:
    """A convolution of (channels, h, w) with weights (out, channels * 9): (places, out), row by row."""
    padded = np.pad(values, ((0, 0), (1, 1), (1, 1)))
    windows = np.lib.stride_tricks.sliding_window_view(padded, (3, 3), axis=(1, 2))[:, ::stride, ::stride]
    channels, rows, columns = windows.shape[:3]
    columned = windows.transpose(1, 2, 0, 3, 4).reshape(rows * columns, channels * 9)
    return np.asarray(columned @ weights.T, np.float32)


def shapes(words: Words, channels: Sequence[int], asked: int, hidden: int, whole: int) -> dict[str, tuple[int, ...]]:
    """The shape of each array of a network.

    Args:
        channels: of the convolutions' results. asked: width of an embedded question. hidden: units of the last layer
            but one. whole: features of the whole.
    """
    parts = len(words.predicates) + (MOST_NAMES + 1) * len(words.words)
    found: dict[str, tuple[int, ...]] = {"embedding": (parts, asked), "embedding_bias": (asked,)}
    cells, last = ((SIZE // int(np.prod(strides))) ** 2 for strides in (STRIDES[:CELLS], STRIDES))
    near = channels[CELLS - 1]
    for camera in CAMERAS:
        size = 3
        for number, out in enumerate(channels):
            found |= {f"{camera}_weight_{number}": (out, size * 9), f"{camera}_bias_{number}": (out,)}
            size = out
        found |= {f"{camera}_places": (cells, near), f"{camera}_asks": (HEADS * near, asked)}
    found |= {"whole": (whole, len(CAMERAS) * last * channels[-1]), "whole_bias": (whole,), "gate": (whole, asked)}
    wide = asked + len(CAMERAS) * HEADS * near + whole
    found |= {"hidden": (hidden, wide), "hidden_bias": (hidden,)}
    return found | {"last": (len(ANSWERS), hidden), "last_bias": (len(ANSWERS),)}


def _sizes(arrays: Mapping[str, Numbers]) -> tuple[list[int], int, int, int]:
    """Channels, width of a question, units of the last layer but one and of the whole, as the arrays have them."""
    channels = [array.shape[0] for number in range(len(STRIDES))
                if (array := arrays.get(f"{CAMERAS[0]}_bias_{number}")) is not None and array.ndim == 1]  # fmt: skip
    if len(channels) != len(STRIDES):
        raise OptionError(f"the network has {len(channels)} convolutions; valid: {len(STRIDES)}")
    found = [arrays.get(name) for name in ("embedding_bias", "hidden_bias", "whole_bias")]
    widths = [len(array) if array is not None and array.ndim == 1 else 0 for array in found]
    return channels, widths[0], widths[1], widths[2]
