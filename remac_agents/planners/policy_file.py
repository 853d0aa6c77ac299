"""A trained policy as a file: the numbers of a small network in NumPy's .npz, and a text of JSON. No code is in it.

    about        a text of JSON: the keys of `_ABOUT`
    weight_0     (units, inputs), bias_0 (units,): the first layer; weight_1, bias_1 the next, and so on
It reads the facts of `remac_env.observation.Facts`, float32 (n,), and behind them a 1 in the place of its task among
`tasks`, else 0; the last layer gives a score for each token. Between layers stands the activation.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remac_env.array_files import UNREADABLE, read_bytes, unpacked
from remac_env.errors import OptionError
from remac_env.files import prepare_file
from remac_env.observation import Facts
from remac_env.options import MASKS, MAX_ROBOTS
from remac_env.vocabulary import Noun, Vocabulary

Numbers = NDArray[np.float32]
"""Weights (units, inputs), or a bias (units,)."""

Layer = tuple[Numbers, Numbers]
"""Weights and bias."""

FORMAT = "remac-policy-1"
"""What the file calls itself."""

MAX_BYTES = 100_000_000
"""Bytes of all arrays together, unpacked; a larger file is refused unread."""


def _relu(values: Numbers) -> Numbers:
    return np.maximum(values, 0.0)


ACTIVATIONS: Mapping[str, Callable[[Numbers], Numbers]] = {"tanh": np.tanh, "relu": _relu}
"""What stands between layers, by name."""

_ABOUT = ("format", "tasks", "robots", "masks", "activation", "vocabulary", "nouns")


@dataclass(frozen=True, kw_only=True)
class Policy:
    """A network that scores the tokens of a vocabulary.

    Attributes:
        tasks: the tasks that it learnt, in the order of its last inputs.
        layers: (weights (out, in), bias (out,)) of each layer.
        vocabulary: of the kitchens in which it learnt.
        robots: with how many robots it learnt.
        masks: "feasible" or "grammar": among which tokens it learnt to choose.
        activation: a key of ACTIVATIONS.

    Raises:
        OptionError: for parts that do not fit together.
    """

    tasks: tuple[str, ...]
    layers: tuple[Layer, ...]
    vocabulary: Vocabulary
    robots: int = 1
    masks: str = "feasible"
    activation: str = "tanh"

    def __post_init__(self) -> None:
        """Refuse anything that is not such a network."""
        if not self.tasks or len(set(self.tasks)) < len(self.tasks):
            raise OptionError(f"tasks {self.tasks!r} is not valid; valid: the names of one task or more")
        for name, valid in (("robots", range(1, MAX_ROBOTS + 1)), ("masks", MASKS), ("activation", ACTIVATIONS)):
            given = getattr(self, name)
            if isinstance(given, bool) or not isinstance(given, int | str) or given not in tuple(valid):
                raise OptionError(f"{name} {given!r} is not valid; valid: {', '.join(map(str, valid))}")
        size = Facts(self.vocabulary, self.robots).size + len(self.tasks)
        for number, (weights, bias) in enumerate(self.layers):
            if weights.ndim != 2 or bias.shape != weights.shape[:1] or weights.shape[1] != size:
                shapes = f"weights {weights.shape} and bias {bias.shape}"
                raise OptionError(f"layer {number} has {shapes}; valid: (units, {size}) and (units,)")
            if not (np.isfinite(weights).all() and np.isfinite(bias).all()):
                raise OptionError(f"layer {number} has numbers that are not finite")
            size = len(bias)
        if not self.layers or size != len(self.vocabulary):
            tokens = len(self.vocabulary)
            raise OptionError(f"the last layer gives {size} scores; valid: one for each of {tokens} tokens")

    def scores(self, facts: Numbers, task: str) -> Numbers:
        """A score for each token, shape (N,), for a robot that sees these facts, shape (n,)."""
        which = np.array([name == task for name in self.tasks], np.float32)
        values = np.concatenate([facts, which])
        for number, (weights, bias) in enumerate(self.layers):
            if number:
                values = ACTIVATIONS[self.activation](values)
            values = weights @ values + bias
        return values


def save_policy(path: str | Path, policy: Policy) -> None:
    """Write a policy as a file of the format above.

    Raises:
        OptionError: if the path does not end in .npz or cannot be written.
    """
    if Path(path).suffix != ".npz":
        raise OptionError(f"policy {str(path)!r} is not valid; valid: a path that ends in .npz")
    about = {
        "format": FORMAT,
        "tasks": policy.tasks,
        "robots": policy.robots,
        "masks": policy.masks,
        "activation": policy.activation,
        "vocabulary": policy.vocabulary.version,
        "nouns": [[noun.name, noun.kind, noun.uses] for noun in policy.vocabulary.entries],
    }
    arrays: dict[str, Any] = {"about": np.array(json.dumps(about))}
    for number, (weights, bias) in enumerate(policy.layers):
        arrays |= {f"weight_{number}": weights.astype(np.float32), f"bias_{number}": bias.astype(np.float32)}
    np.savez_compressed(prepare_file(path, "policy"), **arrays)


def read_policy(path: str | Path, *, sha256: str = "") -> Policy:
    """The policy of a file. Nothing in it is run: arrays of objects, which NumPy would unpickle, are refused.

    Args:
        path: of an .npz as `save_policy` writes it.
        sha256: the digest that the file must have; "": any.

    Raises:
        OptionError: if it cannot be read, has another digest, or is no such policy.
    """
    try:
        data = read_bytes(path, MAX_BYTES)
        found = hashlib.sha256(data).hexdigest()
        if sha256 and sha256 != found:
            raise OptionError(f"sha256 {sha256!r} is not that of this file; its own is {found}")
        arrays = unpacked(data, MAX_BYTES)
        return _policy(arrays, json.loads(str(arrays["about"])))
    except OptionError as error:
        raise OptionError(f"policy {str(path)!r}: {error}") from error
    except UNREADABLE as error:
        raise OptionError(f"policy {str(path)!r} cannot be read: {error}; valid: a file of {FORMAT}") from error


def _policy(arrays: Mapping[str, NDArray[Any]], about: Any) -> Policy:
    if not isinstance(about, dict) or about.get("format") != FORMAT or not set(_ABOUT) <= set(about):
        raise OptionError(f"it is no policy of this version; valid: a file of {FORMAT} with {', '.join(_ABOUT)}")
    layers: list[Layer] = []
    while f"weight_{len(layers)}" in arrays:
        weights, bias = arrays[f"weight_{len(layers)}"], arrays[f"bias_{len(layers)}"]
        layers.append((weights.astype(np.float32), bias.astype(np.float32)))
    nouns = [Noun(str(name), kind, tuple(map(str, uses))) for name, kind, uses in about["nouns"]]
    return Policy(
        tasks=tuple(map(str, about["tasks"])),
        layers=tuple(layers),
        vocabulary=Vocabulary(nouns, version=int(about["vocabulary"])),
        robots=about["robots"],
        masks=about["masks"],
        activation=about["activation"],
    )
