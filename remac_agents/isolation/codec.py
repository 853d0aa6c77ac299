"""Requests and answers as lines of JSON, for roles in other processes.

Plain values are themselves and sequences are arrays. A dataclass of ours is an object whose "$" names its class;
nothing but those classes is ever made from what comes in. Pictures are PNG files in base64, as over HTTP.
"""

from __future__ import annotations

import base64
import itertools
import json
import zlib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields, is_dataclass
from functools import lru_cache
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remac_agents.plan import is_unordered
from remac_agents.roles.request_json import png
from remac_agents.text.printable import quoted
from remac_env.frozen import FrozenMap

MOST_PARTS = 2_000
"""Parts of one sequence in an answer; no valid one has so many."""

DEEPEST = 40
"""Levels of an answer."""

WIDEST = 4096
"""Pixels of a side of a picture."""

_MODULES = (
    *(f"remac_agents.{name}" for name in ("plan", "roles")),
    *(f"remac_env.rules.{name}" for name in ("conditions", "facts", "outcomes", "scene", "subtasks")),
    *(f"remac_env.{name}" for name in ("state", "tasks.goals", "tasks.compound")),
)
"""Where the dataclasses are that may travel."""

Call = Callable[[str, list[Any]], Any]
"""Asks the other side: the name of a callback and its arguments."""


class Shown:
    """Stands for a value that is none of ours: it shows what the other side says that it is."""

    def __init__(self, text: str) -> None:
        self._text = text

    def __repr__(self) -> str:
        return self._text


def dumps(value: Any) -> bytes:
    """A line, its end included."""
    return json.dumps(encode(value)).encode() + b"\n"


def loads(line: bytes, call: Call | None = None) -> Any:
    """The value of a line; ValueError for one that is not a value.

    Args:
        call: what callbacks in it do.
    """
    try:
        return decode(json.loads(line), call)
    except (TypeError, KeyError, AttributeError, RecursionError) as error:
        raise ValueError(f"a line that is not a value: {type(error).__name__}") from error


def encode(value: Any, depth: int = 0) -> Any:
    """A value as json.dumps takes it."""
    if value is None or isinstance(value, bool | float):
        return value
    if isinstance(value, int):
        return int(value)
    if isinstance(value, str):
        return str.__str__(value)
    if isinstance(value, np.generic):
        return encode(value.item(), depth)
    if depth > DEEPEST:
        return {"$": "shown", "text": "values in values, too deep"}
    if isinstance(value, np.ndarray):
        picture = value.dtype == np.uint8 and value.ndim == 3 and value.shape[2] == 3
        return {"$": "png", "data": base64.b64encode(png(value)).decode()} if picture else _parts(value, depth)
    if is_dataclass(value) and not isinstance(value, type):
        return _instance(value, depth)
    if isinstance(value, FrozenMap):
        return {"$": "FrozenMap", "items": {str(key): encode(part, depth + 1) for key, part in value.items()}}
    if isinstance(value, Mapping):
        pairs = itertools.islice(value.items(), MOST_PARTS)
        return {"$": "map", "items": [[encode(key, depth + 1), encode(part, depth + 1)] for key, part in pairs]}
    if is_unordered(value):
        return {"$": "frozenset", "items": [encode(part, depth + 1) for part in sorted(value, key=str)]}
    if callable(value):
        return {"$": "callback"}
    return _parts(value, depth) if isinstance(value, Iterable) else {"$": "shown", "text": quoted(value)}


def decode(data: Any, call: Call | None = None) -> Any:
    """The value that `encode` was given; sequences as tuples."""
    if isinstance(data, list):
        return tuple(decode(part, call) for part in data)
    if not isinstance(data, dict):
        return data
    kind = data["$"]
    if kind == "map":
        return {decode(key): decode(part, call) for key, part in data["items"]}
    if kind == "FrozenMap":
        return FrozenMap({key: decode(part, call) for key, part in data["items"].items()})
    if kind == "frozenset":
        return frozenset(decode(part, call) for part in data["items"])
    if kind == "shown":
        return Shown(str(data["text"])[:200])
    if kind == "png":
        return _picture(base64.b64decode(data["data"]))
    found = {name: decode(part, call) for name, part in data.items() if name not in ("$", "calls")}
    for name in data.get("calls", ()):
        found[name] = _caller(name, call)
    return _made(classes()[kind], found)


@lru_cache(maxsize=1)
def classes() -> Mapping[str, type]:
    """Name -> class of everything that requests and answers are made of."""
    found = [each for name in _MODULES for each in vars(import_module(name)).values() if isinstance(each, type)]
    return {each.__name__: each for each in found if is_dataclass(each)}


def _instance(value: Any, depth: int) -> Any:
    """A dataclass of ours, or the one of ours that a class of someone's own is made from."""
    known = classes()
    kind = next((each for each in type(value).__mro__ if known.get(each.__name__) is each), None)
    if kind is None:
        return {"$": "shown", "text": quoted(value)}
    parts = {field.name: getattr(value, field.name) for field in fields(kind)}
    calls = [name for name, part in parts.items() if callable(part)]
    told = {name: encode(part, depth + 1) for name, part in parts.items() if name not in calls}
    return {"$": kind.__name__, **told, **({"calls": calls} if calls else {})}


def _made(kind: type, parts: Mapping[str, Any]) -> Any:
    """A dataclass from all of its fields, whatever its own way of being made asks for."""
    names = {field.name for field in fields(kind)}
    if names != parts.keys():
        raise KeyError(f"{kind.__name__} of {', '.join(parts)}")
    made: Any = object.__new__(kind)
    for name in names:
        object.__setattr__(made, name, parts[name])
    return made


def _parts(value: Iterable[Any], depth: int) -> list[Any]:
    return [encode(part, depth + 1) for part in itertools.islice(value, MOST_PARTS)]


def _caller(name: str, call: Call | None) -> Callable[..., Any]:
    if call is None:
        raise ValueError("a callback where there can be none")
    return lambda *arguments: call(name, list(arguments))


def _picture(data: bytes) -> NDArray[np.uint8]:
    """A picture that `png` wrote: one block of rows, none of them filtered."""
    width, height = int.from_bytes(data[16:20]), int.from_bytes(data[20:24])
    if width > WIDEST or height > WIDEST:
        raise ValueError(f"a picture of {width} x {height}")
    size = int.from_bytes(data[33:37])
    try:  # no more than it says of itself: a few bytes may stand for many gigabytes
        told = zlib.decompressobj().decompress(data[41 : 41 + size], height * (1 + 3 * width))
    except zlib.error as error:
        raise ValueError("a picture that is none") from error
    rows = np.frombuffer(told, np.uint8).reshape(height, 1 + 3 * width)
    return np.ascontiguousarray(rows[:, 1:]).reshape(height, width, 3)
