"""Numbers in suites."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from remac_bench.errors import UsageError
from remac_env.errors import OptionError, real_number, whole_number


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


def number(file: str, where: str, value: Any, most: float, *, least: int = 0, whole: bool = True) -> Any:
    """The number in least..most, None where none is given.

    Raises:
        UsageError: for anything else.
    """
    if value is None:
        return None
    try:
        return whole_number(where, value, least, int(most)) if whole else real_number(where, value, least, most)
    except OptionError as error:
        raise UsageError(f"{file}: {error}") from error
