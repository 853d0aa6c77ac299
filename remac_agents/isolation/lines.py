"""Lines over a socket, with a bound on how long one may be and how long one is waited for."""

from __future__ import annotations

import select
import socket
from collections.abc import Callable

LONGEST = 64_000_000
"""Bytes of a line: a request with pictures has a few million."""

LONGEST_ANSWER = 4_000_000
"""The same of an answer, which holds none."""


class Ended(Exception):
    """The other side is gone, or sends what is not a line."""


class Lines:
    """One end of a socket; `longest`: bytes of a line that comes in."""

    def __init__(self, end: socket.socket, longest: int = LONGEST) -> None:
        self.socket, self._rest, self._longest = end, bytearray(), longest

    def send(self, line: bytes) -> None:
        """Send a line; Ended where nobody listens."""
        try:
            self.socket.sendall(line)
        except OSError as error:
            raise Ended from error

    def receive(self, left: Callable[[], float | None] = lambda: None) -> bytes:
        """The next line.

        Args:
            left: seconds that it may still take; None: as long as it takes.

        Raises:
            Ended: when the other side is gone, or a line is too long.
            TimeoutError: when the time is up.
        """
        while True:
            line, end, rest = self._rest.partition(b"\n")
            if end:
                self._rest = rest
                return bytes(line)
            if len(self._rest) > self._longest:
                raise Ended
            seconds = left()
            if seconds is not None and not select.select([self.socket], [], [], max(0.0, seconds))[0]:
                raise TimeoutError
            try:
                part = self.socket.recv(1 << 20)
            except OSError as error:
                raise Ended from error
            if not part:
                raise Ended
            self._rest += part
