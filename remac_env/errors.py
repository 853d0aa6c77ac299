"""Every exception that remac_env raises on purpose. Each message names what was given, where, and what is valid."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from remac_env.quoting import quoted
from remac_env.values import python_value

MOST_LISTED, NEAREST = 2_000, 12
"""Letters of a list of valid names that an error shows whole, and how many of a longer list it shows."""


class RemacError(Exception):
    """Base of all errors of this project."""


class UnknownNameError(RemacError, ValueError):
    """A name (task, style, layout, backend, role, ...) that is not among the valid ones."""


class UnknownKeywordError(UnknownNameError, TypeError):
    """A keyword that a function does not have."""


class OptionError(RemacError, ValueError):
    """An option whose value is outside its range or not offered."""


class KitchenFileError(RemacError, ValueError):
    """A malformed layout, style or object file."""

    def __init__(self, file: object, key: str, problem: str, valid: Iterable[object] | str = "") -> None:
        """Name the file, the key in it, what is wrong, and the valid values if there is a list of them."""
        choices = valid if isinstance(valid, str) else ", ".join(str(value) for value in valid)
        super().__init__(f"{file}: {key}: {problem}" + (f"; valid: {choices}" if choices else ""))
        self._given = (str(file), key, problem, choices)

    def __reduce__(self) -> tuple[object, ...]:
        # An exception's own way of being copied knows only the message.
        return KitchenFileError, self._given


class ActionError(RemacError, TypeError):
    """A malformed action: wrong type, not a whole number, or for the wrong agents. Nothing was changed."""


class LifecycleError(RemacError, RuntimeError):
    """A call at the wrong moment: before reset, after the end of the episode, or after close."""


class SamplingError(RemacError, RuntimeError):
    """No start could be drawn for this cell and seed: the kitchen lacks what the task needs."""


class RenderingError(RemacError, RuntimeError):
    """No picture can be made with the settings at hand; the message names the fix."""


class UncertifiedWarning(UserWarning):
    """A kitchen in physics whose fixtures were never proven with the body of its robots."""


class PhysicsError(RemacError, RuntimeError):
    """MuJoCo raised a warning or produced a value that is not finite."""


def check_choice(kind: str, given: object, valid: Iterable[object]) -> None:
    """Raise UnknownNameError unless `given` is one of `valid`."""
    given, choices = python_value(given), list(valid)
    if not any(type(given) is type(choice) and given == choice for choice in choices):
        raise UnknownNameError(f"unknown {kind} {quoted(given)}; valid: {_listed(quoted(given), choices)}")


def _listed(given: str, choices: list[object]) -> str:
    """All of them, or the nearest where they are too many to be read."""
    names = [str(choice) for choice in choices]
    if len(", ".join(names)) <= MOST_LISTED:
        return ", ".join(names)
    from difflib import get_close_matches

    near = get_close_matches(given, names, n=NEAREST, cutoff=0.0)
    return f"{', '.join(near)} and {len(names) - len(near)} more"


def whole_number(name: str, value: Any, least: int, most: int | None = None) -> int:
    """`value` as an int; booleans are no numbers.

    Raises:
        OptionError: if it is not a whole number in least..most, or from least.
    """
    number = python_value(value)
    whole = isinstance(number, int) and not isinstance(number, bool)
    if not whole or number < least or (most is not None and number > most):
        raise OptionError(f"{name} {quoted(number)} is not valid; valid: {_span(least, most)}")
    return number


def real_number(name: str, value: Any, least: float, most: float = math.inf) -> float:
    """`value` as an int or a float, as it was given; booleans are no numbers, nor are nan and inf.

    Raises:
        OptionError: if it is not a finite number in least..most.
    """
    number = python_value(value)
    numeric = isinstance(number, int | float) and not isinstance(number, bool)
    if not numeric or not least <= number <= most or not math.isfinite(number):
        span = f"a number from {least:g} to {most:g}" if most < math.inf else f"a number, {least:g} or more"
        raise OptionError(f"{name} {quoted(number)} is not valid; valid: {span}")
    return float(number) if isinstance(number, float) else number


def _span(least: int, most: int | None) -> str:
    if most is None:
        return f"a whole number, {least} or more"
    return ", ".join(map(str, range(least, most + 1))) if most - least < 5 else f"whole numbers {least}..{most}"
