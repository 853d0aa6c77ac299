"""How long to wait before another try: as long as the endpoint asked for, or else longer from try to try."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from email.utils import parsedate_to_datetime

FIRST_WAIT_S = 0.5
LONGEST_WAIT_S = 60.0

_RESET = ("x-ratelimit-reset-requests", "x-ratelimit-reset-tokens", "x-ratelimit-reset")
_SPAN = re.compile(r"(\d+(?:\.\d+)?)(ms|s|m|h)")
_UNITS = {"ms": 0.001, "s": 1.0, "m": 60.0, "h": 3600.0}


def wait_before(tries: int, asked: float | None, jitter: Callable[[], float]) -> float:
    """Seconds to wait after `tries` failed tries.

    What the endpoint asked for is obeyed up to LONGEST_WAIT_S. Else the wait is drawn evenly from 0 to a bound that
    doubles with each try, so that clients which failed together do not come back together.
    """
    if asked is not None:
        return min(asked, LONGEST_WAIT_S)
    bound = min(LONGEST_WAIT_S, FIRST_WAIT_S * 2.0 ** min(tries - 1, 16))
    return bound * min(1.0, max(0.0, jitter()))


def asked_wait(headers: Mapping[str, str], wall: float) -> float | None:
    """Seconds that response headers ask to wait, at least 0; None if they do not, or not in a form that is known.

    Args:
        headers: with names in lower case, or a mapping that does not mind.
        wall: seconds since 1970 now, to which a date is compared.
    """
    milliseconds = _seconds(headers.get("retry-after-ms", ""))
    if milliseconds is not None:
        return max(0.0, milliseconds / 1000.0)
    given = headers.get("retry-after", "").strip()
    if given:
        seconds = _seconds(given)
        if seconds is None:
            seconds = _until(given, wall)
        return None if seconds is None else max(0.0, seconds)
    spans = [span for name in _RESET if (span := _span(headers.get(name, ""))) is not None]
    return max(spans, default=None)


def _seconds(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def _until(text: str, wall: float) -> float | None:
    try:
        return parsedate_to_datetime(text).timestamp() - wall
    except (ValueError, TypeError, OverflowError, IndexError):
        return None


def _span(text: str) -> float | None:
    """Spans such as "1s", "6m0s" and "120ms"."""
    text = text.strip()
    parts = _SPAN.findall(text)
    if not parts or "".join(number + unit for number, unit in parts) != text:
        return None
    return float(sum(float(number) * _UNITS[unit] for number, unit in parts))
