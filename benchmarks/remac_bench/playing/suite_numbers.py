"""Numbers in suites."""

from __future__ import annotations

import math
from collections.abc import Mapping
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
