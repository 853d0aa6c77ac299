"""A network that turns an observation into the next commands, played with NumPy: nothing here needs torch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from remac_env.errors import OptionError
from remac_env.robots.body import Body

Numbers = NDArray[np.float32]

LARGEST = 20_000_000
"""Bytes of all arrays together."""

DEEPEST = 16
"""Layers at most: each takes its time whenever a robot looks, however small it is."""

_EPSILON = 1e-5  # of the normalisation, as in torch


def commanded(body: Body) -> int:
    """Numbers of a command: changes of a body's joints from where they are, m or rad, and the fingers' travel, m."""
    return len(body.joints) + 1


HAND = 9
"""Numbers behind these for where the hand is to be: its way from where it is, m, and two axes; see :mod:`.hand`."""


@dataclass(frozen=True, eq=False)
class Network:
    """Layers of weights (out, in), bias, gain and shift (out,), each normalised and rectified; the last one plain.

    ``mean`` and ``std`` (n,) of observations, ``out_mean`` and ``out_std`` (chunk, m) of commands, where m is
    ``commanded(body)``, or HAND more.

    Raises:
        OptionError: for parts that do not fit together, or numbers that are not finite.
    """

    mean: Numbers
    std: Numbers
    layers: tuple[tuple[Numbers, Numbers, Numbers, Numbers], ...]
    last: tuple[Numbers, Numbers]
    out_mean: Numbers
    out_std: Numbers

    def __post_init__(self) -> None:
        """Refuse what is no such network."""
        arrays = self.arrays
        for name, array in arrays.items():
            if not np.issubdtype(array.dtype, np.floating) or not np.isfinite(array).all():
                raise OptionError(f"array {name!r} of the network is not made of finite numbers")
        if len(self.layers) > DEEPEST:
            raise OptionError(f"the network has {len(self.layers)} layers; valid: at most {DEEPEST}")
        size = self.mean.shape[0] if self.mean.ndim == 1 else -1
        fits = self.std.shape == self.mean.shape and bool((self.std > 0.0).all() and (self.out_std > 0.0).all())
        for weights, *others in self.layers:
            fits &= weights.ndim == 2 and weights.shape[1] == size
            fits &= all(other.shape == weights.shape[:1] for other in others)
            size = len(weights)
        weights, bias = self.last
        fits &= weights.ndim == 2 and weights.shape[1] == size and bias.shape == weights.shape[:1]
        fits &= self.out_mean.shape == self.out_std.shape and self.out_mean.ndim == 2
        fits &= self.out_mean.size == len(bias)
        if not fits or self.chunk < 1:
            shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
            raise OptionError(f"the arrays of the network do not fit together: {shapes}")

    @property
    def chunk(self) -> int:
        """How many commands it gives at once."""
        return len(self.out_mean)

    @property
    def arrays(self) -> dict[str, Numbers]:
        """All arrays by name."""
        found = {"mean": self.mean, "std": self.std, "out_mean": self.out_mean, "out_std": self.out_std}
        for number, layer in enumerate(self.layers):
            found |= {f"{name}_{number}": part for name, part in zip(_PARTS, layer, strict=True)}
        return found | dict(zip(("last_weight", "last_bias"), self.last, strict=True))

    @staticmethod
    def of(arrays: dict[str, Numbers]) -> Network:
        """The network of these arrays; OptionError where they are none."""
        depth = sum(name.startswith("weight_") for name in arrays)
        try:
            layers = tuple(tuple(arrays[f"{part}_{number}"] for part in _PARTS) for number in range(depth))
            made = Network(
                arrays["mean"], arrays["std"], layers,  # type: ignore[arg-type]
                (arrays["last_weight"], arrays["last_bias"]), arrays["out_mean"], arrays["out_std"],
            )  # fmt: skip
        except KeyError as error:
            raise OptionError(f"the network lacks the array {error}") from error
        if strange := set(arrays) - set(made.arrays):
            raise OptionError(f"the network has arrays that mean nothing: {', '.join(sorted(strange))}")
        return made

    def commands(self, observation: Numbers) -> Numbers:
        """The next commands, shaped as ``out_mean``, for what is seen now, (n,); not finite where that overflows."""
        with np.errstate(all="ignore"):
            return self._commands(observation)

    def _commands(self, observation: Numbers) -> Numbers:
        values = (observation - self.mean) / self.std
        for weights, bias, gain, shift in self.layers:
            values = weights @ values + bias
            values = (values - values.mean()) / np.sqrt(values.var() + _EPSILON) * gain + shift
            values = np.maximum(values, 0.0)
        weights, bias = self.last
        found = (weights @ values + bias).reshape(self.out_mean.shape)
        return np.asarray(found * self.out_std + self.out_mean, np.float32)


_PARTS = ("weight", "bias", "gain", "shift")
