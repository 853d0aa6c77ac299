"""Values in suites: of their types, names that there are, numbers in their ranges."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from remac_bench.errors import UsageError
from remac_env.errors import OptionError, RemacError, whole_number
from remac_env.option_rows import Row


def check_finite(file: str, where: str, data: Any) -> None:
    """TOML knows nan and inf; a suite does not.

    Raises:
        UsageError: with the place of one.
    """
    if isinstance(data, float) and not math.isfinite(data):
        raise UsageError(f"{file}: {where}: {data!r} is not valid; valid: a finite number")
    parts = data.items() if isinstance(data, Mapping) else enumerate(data) if isinstance(data, list) else ()
    for key, part in parts:
        check_finite(file, f"{where}[{key}]" if isinstance(key, int) else f"{where}.{key}".lstrip("."), part)


def number(file: str, where: str, value: Any, most: int, *, least: int = 0) -> Any:
    """The whole number in least..most, None where none is given.

    Raises:
        UsageError: for anything else.
    """
    if value is None:
        return None
    try:
        return whole_number(where, value, least, most)
    except OptionError as error:
        raise UsageError(f"{file}: {error}") from error


def option_value(file: str, where: str, row: Row, value: Any) -> Any:
    """The value of an option.

    Raises:
        UsageError: naming file, key and valid values.
    """
    try:
        return row.values.check(where, value)
    except RemacError as error:
        raise UsageError(f"{file}: {error}") from error


def check_keys(file: str, where: str, data: Mapping[str, Any], valid: Sequence[str]) -> None:
    """Refuse keys that there are not: UsageError."""
    for key in data:
        if key not in valid:
            raise UsageError(f"{file}: {where}{key}: no such key; valid: {', '.join(valid)}")


def check_names(file: str, where: str, given: Any, valid: Sequence[str]) -> tuple[str, ...]:
    """A list of names of those that there are, at least one: else UsageError."""
    listed = value_of(file, where, given, list)
    for name in listed:
        if name not in valid:
            raise UsageError(f"{file}: {where}: {name!r} does not exist; valid: {', '.join(valid)}")
    if not listed:
        raise UsageError(f"{file}: {where}: names nothing; valid: some of {', '.join(valid)}")
    return tuple(listed)


def table(file: str, where: str, data: Any, valid: Sequence[str]) -> dict[str, Any]:
    """A table with no other keys than the valid ones: else UsageError."""
    check_keys(file, f"{where}.", value_of(file, where, data, dict), valid)
    return dict(data)


def value_of(file: str, where: str, value: Any, kind: type) -> Any:
    """A value of this type: else UsageError."""
    if isinstance(value, bool) or not isinstance(value, kind):
        said = {str: "a text", int: "a whole number", list: "a list", dict: "a table"}[kind]
        raise UsageError(f"{file}: {where}: {value!r} is not valid; valid: {said}")
    return value
