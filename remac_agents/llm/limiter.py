"""How many requests may be under way: a limit that shrinks when the endpoint asks for it, and grows slowly."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager

from remac_agents.llm.clock import Clock
from remac_env.errors import OptionError

SHRINK = 0.8
SHRINK_PAUSE_S = 15.0
"""After a 429 the limit shrinks by this factor, once in so many seconds: a burst of 429s is one message."""

STRIKES = 8
STRIKE_PAUSE_S = 60.0
"""After so many failures of the endpoint in a row it is left alone for so long, rather than burning episodes."""


class Limiter:
    """Shared by all clients of one endpoint, in threads of one process."""

    def __init__(self, *, start: int = 4, most: int = 16, clock: Clock | None = None) -> None:
        """Args: start, most: requests at the same time, at first and at most.

        Raises:
            OptionError: unless 1 <= start <= most.
        """
        if not 1 <= start <= most:
            raise OptionError(f"start {start!r}, most {most!r} is not valid; valid: 1 <= start <= most")
        self._clock = clock or Clock()
        self._condition = threading.Condition()
        self._limit = float(start)
        self._most = most
        self._running = 0
        self._strikes = 0
        self._held_until = float("-inf")
        self._next_shrink = float("-inf")
        self._history: list[int] = [start]

    @property
    def limit(self) -> int:
        """Requests that may be under way now."""
        return int(self._limit)

    @property
    def history(self) -> tuple[int, ...]:
        """The limits so far, each change once, for the record."""
        return tuple(self._history)

    @contextmanager
    def place(self, deadline: float) -> Iterator[bool]:
        """A place for one request, waited for until `deadline` (monotonic seconds); False: there was none."""
        got = self._enter(deadline)
        try:
            yield got
        finally:
            if got:
                with self._condition:
                    self._running -= 1
                    self._condition.notify_all()

    def _enter(self, deadline: float) -> bool:
        while True:
            with self._condition:
                now = self._clock.monotonic()
                pause = self._held_until - now
                if now >= deadline or now + pause >= deadline:
                    return False
                if pause <= 0:
                    if self._running < int(self._limit):
                        self._running += 1
                        return True
                    self._condition.wait(min(deadline - now, 1.0))
                    continue
            self._clock.sleep(pause)

    def succeeded(self) -> None:
        """An answer came: as many answers as the limit make it one larger."""
        with self._condition:
            self._strikes = 0
            self._set(min(float(self._most), self._limit + 1.0 / self._limit))
            self._condition.notify_all()

    def rate_limited(self, pause: float) -> None:
        """The endpoint wants fewer requests, and none for `pause` seconds."""
        with self._condition:
            now = self._clock.monotonic()
            self._held_until = max(self._held_until, now + pause)
            if now >= self._next_shrink:
                self._next_shrink = now + SHRINK_PAUSE_S
                self._set(max(1.0, min(self._limit * SHRINK, int(self._limit) - 1.0)))

    def failed(self) -> None:
        """The endpoint failed. The limit stays; after many failures in a row it is left alone for a while."""
        with self._condition:
            self._strikes += 1
            if self._strikes >= STRIKES:
                self._strikes = 0
                self._held_until = max(self._held_until, self._clock.monotonic() + STRIKE_PAUSE_S)

    def _set(self, limit: float) -> None:
        self._limit = limit
        if int(limit) != self._history[-1]:
            self._history.append(int(limit))
