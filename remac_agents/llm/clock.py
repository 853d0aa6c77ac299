"""Time, from outside, so that tests need not wait. Deadlines use the monotonic clock: wall clocks jump."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Clock:
    """Attributes: monotonic: seconds that never jump; wall: seconds since 1970, for dates only; sleep: wait."""

    monotonic: Callable[[], float] = time.monotonic
    wall: Callable[[], float] = time.time
    sleep: Callable[[float], None] = time.sleep
