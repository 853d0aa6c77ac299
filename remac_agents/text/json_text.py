"""JSON out of a model's text: read strictly, then once more leniently, by rules that are written down here.

Strict: the whole text is one JSON value. Lenient, and noted as `repaired`: the first balanced `{...}` or `[...]` of the
text is one - so fences and prose around it do no harm. Nothing is mended inside: trailing commas, single quotes, notes,
NaN and missing brackets are errors, and so are names given twice (which of the two was meant?), numbers of more than
MAX_DIGITS digits and values nested deeper than MAX_DEPTH. Nothing is ever run.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import Any

MAX_CHARACTERS = 1 << 20
MAX_DEPTH = 32
MAX_DIGITS = 18


NEAR = 30
"""Characters that are shown of the place at which JSON goes wrong."""

_PLAIN = {
    "Expecting value": "a value is expected",
    "Expecting ',' delimiter": "a comma or a closing bracket is expected",
    "Expecting ':' delimiter": "a colon is expected",
    "Expecting property name": "a name in double quotes is expected",
    "Illegal trailing comma": "a comma stands before a closing bracket",
    "Extra data": "something follows after the end of the JSON",
    "Unterminated string": "a text begins whose closing double quote is missing",
    "Invalid control character": "a text holds a line break or another control character",
    "Invalid \\": "a backslash is followed by something that JSON does not know",
}
"""How Python's JSON parser begins to say it -> in plain words."""


@dataclass(frozen=True)
class Answer:
    """A JSON `value`. `repaired`: it was taken out of other text."""

    value: Any
    repaired: bool = False


@dataclass(frozen=True)
class BadAnswer:
    """Why a text holds no JSON: the `problem`, in words that can be sent back to the model."""

    problem: str


class _Refused(ValueError):
    """JSON that is legal, or nearly, and not accepted."""


def read_json(text: str) -> Answer | BadAnswer:
    """The JSON value that a text is, or else holds first."""
    if len(text) > MAX_CHARACTERS:
        return BadAnswer(f"the text has {len(text)} characters; valid: at most {MAX_CHARACTERS}")
    stripped = text.strip().removeprefix("\ufeff")
    strict = _read(stripped, repaired=False)
    if isinstance(strict, Answer):
        return strict
    found = _first_balanced(stripped)
    if found is None or found == stripped:
        return strict
    return _read(found, repaired=True)


def _read(text: str, *, repaired: bool) -> Answer | BadAnswer:
    if _depth(text) > MAX_DEPTH:
        return BadAnswer(f"the JSON is nested deeper than {MAX_DEPTH}")
    try:
        value = json.loads(
            text, object_pairs_hook=_once, parse_int=_whole, parse_float=_number, parse_constant=_refuse_constant
        )
    except json.JSONDecodeError as error:
        return BadAnswer(_said(error))
    except (ValueError, RecursionError) as error:
        return BadAnswer(f"the JSON cannot be used: {error}")
    return Answer(value, repaired)


def _said(error: json.JSONDecodeError) -> str:
    """What is wrong and where, in words that need no parser's manual."""
    if not error.doc or not any(bracket in error.doc for bracket in "{["):
        return "there is no JSON in the answer"
    if error.pos >= len(error.doc):
        return "the JSON breaks off before its last closing bracket"
    what = next((words for begin, words in _PLAIN.items() if error.msg.startswith(begin)), error.msg)
    near = " ".join(error.doc[error.pos : error.pos + NEAR].split())
    return f"the answer is not valid JSON: in line {error.lineno}, at {near!r}, {what}"


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in pairs:
        if name in found:
            raise _Refused(f"the name {name[:80]!r} is given twice")
        found[name] = value
    return found


def _whole(digits: str) -> int:
    if len(digits) > MAX_DIGITS:
        raise _Refused(f"a number has {len(digits)} digits; valid: at most {MAX_DIGITS}")
    return int(digits)


def _number(digits: str) -> float:
    value = float(digits)
    if not math.isfinite(value):
        raise _Refused("a number is too large")
    return value


def _refuse_constant(name: str) -> float:
    raise _Refused(f"{name} is no JSON")


def _depth(text: str) -> int:
    """How deep brackets are nested, those in strings left out."""
    depth = deepest = 0
    for char in _outside_strings(text):
        depth += {"[": 1, "{": 1, "]": -1, "}": -1}.get(char[1], 0)
        deepest = max(deepest, depth)
    return deepest


def _first_balanced(text: str) -> str | None:
    """The first bracket of the text with all up to its closing one; None if it is never closed."""
    starts = [index for index in (text.find("{"), text.find("[")) if index >= 0]
    if not starts:
        return None
    start = min(starts)
    depth = 0
    for index, char in _outside_strings(text[start:]):
        depth += {"[": 1, "{": 1, "]": -1, "}": -1}.get(char, 0)
        if depth == 0:
            return text[start : start + index + 1]
    return None


def _outside_strings(text: str) -> list[tuple[int, str]]:
    """The brackets outside double-quoted strings, with their places."""
    found: list[tuple[int, str]] = []
    quoted = escaped = False
    for index, char in enumerate(text):
        if escaped:
            escaped = False
        elif quoted and char == "\\":
            escaped = True
        elif char == '"':
            quoted = not quoted
        elif not quoted and char in "[]{}":
            found.append((index, char))
    return found
