"""Options behind a name, as one text: `name,option=value,option=value`. Roles and models are read by the same rule.

The list of options begins at the first comma that is followed by `option=`, and so does each option; any other comma
belongs to the name or value it stands in, as in `my,folder/p.py:plan`. A comma that would begin an option and is not
meant to is written `\\,`. Nothing else is special: a backslash before anything but a comma is a backslash.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from typing import Any

from remac_env.errors import OptionError
from remac_env.values import python_value

FORM = "name,option=value,option=value; a comma in a name or value is written \\,"

MOST_SPENT = 1e12
"""The largest bound on what models may take, of whatever unit; None: no bound."""

_BEGIN = re.compile(r"(?<!\\),(?=\s*[\w.-]+\s*=)")
_COMMA = re.compile(r"(?<!\\),")
_WORD = re.compile(r"\s*[A-Za-z_][\w-]*\s*|\s*")


def split_options(text: str, *, commas: bool = True) -> tuple[str, dict[str, str]]:
    """The name, and option -> its value as text.

    Args:
        text: what a user wrote.
        commas: whether a name may hold commas that are not escaped, as paths may.

    Raises:
        OptionError: for an option without a value, or one that is given twice.
    """
    name, *parts = _BEGIN.split(text)
    pieces = _COMMA.split(name)
    if len(pieces) > 1 and (not commas or _WORD.fullmatch(pieces[-1])):
        raise OptionError(f"{text!r}: {pieces[-1].strip()!r} is not valid; valid: {FORM}")
    options: dict[str, str] = {}
    for part in parts:
        option, _, value = part.partition("=")
        if option.strip() in options:
            raise OptionError(f"{text!r}: {option.strip()!r} is given twice; valid: once")
        options[option.strip()] = plain(value)
    return plain(name), options


def plain(text: str) -> str:
    """A name or value without its escapes."""
    return text.replace("\\,", ",").strip()


def join_options(name: str, options: Mapping[str, str]) -> str:
    """The text that `split_options` reads as this; options in alphabetical order, so that it is one for all orders."""
    told = [(option, re.sub(r",(?=\s*[\w.-]+\s*=)", r"\\,", value)) for option, value in sorted(options.items())]
    return ",".join([name.replace(",", "\\,"), *(f"{option}={value}" for option, value in told)])


def read_value(text: str) -> Any:
    """A JSON value where the text is one, else the text."""
    try:
        return json.loads(text)
    except (json.JSONDecodeError, RecursionError):
        return text


def check_number(option: str, value: object, least: float, most: float, *, whole: bool = False, more: str = "") -> None:
    """Refuse anything that is not a number from `least` to `most`: texts, truth values, NaN and infinities too.

    Args:
        more: what else is valid, for the message.

    Raises:
        OptionError: naming the option, the value and the range.
    """
    value = python_value(value)
    kind = int if whole else (int, float)
    fits = isinstance(value, kind) and not isinstance(value, bool)
    if not fits or not math.isfinite(value) or not least <= value <= most:  # type: ignore[arg-type, operator]
        said = "a whole number" if whole else "a number"
        raise OptionError(f"{option} {value!r} is not valid; valid: {said} from {least:g} to {most:g}{more}")
