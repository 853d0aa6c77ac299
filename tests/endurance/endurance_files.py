"""Kitchen files with one thing wrong in them, derived from the files that are shipped."""

from __future__ import annotations

import copy
import datetime
import json
import math
from collections.abc import Iterator
from typing import Any

At = tuple[str | int, ...]
"""Where a value stands in a TOML tree: names of keys, and places in lists."""

DAY = datetime.date(2025, 3, 1)
HUGE = 10**400
"""A whole number that TOML can hold and a float cannot."""

STRANGE = "no-such-thing"
"""No key and no value of any kitchen file."""


def dumps(tree: dict[str, Any]) -> str:
    """A TOML document; every table but the outermost is written in one line."""
    return "\n".join(f"{json.dumps(key)} = {_written(value)}" for key, value in tree.items()) + "\n"


def _written(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)} = {_written(entry)}" for key, entry in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_written(entry) for entry in value) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value)
    return value.isoformat() if isinstance(value, datetime.date) else repr(value)


def places(tree: Any, at: At = ()) -> Iterator[tuple[At, Any]]:
    """Every key of a tree and every entry of its lists, with its value; outer ones before inner ones."""
    pairs = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, value in pairs:
        yield (*at, key), value
        yield from places(value, (*at, key))


def tables(tree: dict[str, Any]) -> Iterator[At]:
    """Where the tables of a tree stand; the outermost stands at ()."""
    yield ()
    yield from (path for path, value in places(tree) if isinstance(value, dict))


def replaced(tree: dict[str, Any], path: At, value: Any) -> dict[str, Any]:
    """A copy of the tree with another value at a place, which may be a new key."""
    changed = copy.deepcopy(tree)
    _parent(changed, path)[path[-1]] = value
    return changed


def without(tree: dict[str, Any], path: At) -> dict[str, Any]:
    """A copy of the tree that lacks a key."""
    changed = copy.deepcopy(tree)
    del _parent(changed, path)[path[-1]]
    return changed


def _parent(tree: Any, path: At) -> Any:
    for key in path[:-1]:
        tree = tree[key]
    return tree


def wrong_types(value: Any) -> list[Any]:
    """Values of other types than this one's, and numbers that are none."""
    if isinstance(value, bool):
        return ["yes", 1, [], DAY]
    if isinstance(value, str):
        return [3, True, ["a"], {}, DAY, math.nan]
    if isinstance(value, int | float):
        # A whole number may be as large as it likes here: what it may be is for the test of ranges.
        return ["1", True, [], {}, DAY, math.nan, math.inf, -math.inf, *([HUGE] if isinstance(value, float) else [])]
    if isinstance(value, list):
        return [3, True, {}, DAY, [{}], [[[]]], [STRANGE]]
    return [3, "text", [], [{}], DAY]


def dotted(path: At) -> str:
    """The place as errors name it: `fixtures.counter.slots[2].half`; an entry of plain values goes by its list."""
    text = ""
    for key in path:
        text += f"[{key}]" if isinstance(key, int) else f".{key}" if text else str(key)
    return text
