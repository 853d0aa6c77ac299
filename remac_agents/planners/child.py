"""A command that runs for a while in processes of its own, and is gone afterwards with all that it started."""

from __future__ import annotations

import os
import select
import signal
import subprocess
import threading
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO

PAUSE = 0.02
"""s between two looks whether it has ended."""


LAST = 2_000
"""Bytes that are kept of what a command complains about: the last ones."""


class CommandError(Exception):
    """It came to nothing, and why."""


@dataclass(frozen=True)
class Printed:
    """What a command printed: its standard output, and the last line of its errors. `status`: how it exited."""

    text: str
    complaint: str
    status: int


def run_command(command: Sequence[str], *, folder: Path, seconds: float, most_bytes: int) -> Printed:
    """What a command prints. It runs in `folder`, and reads nothing.

    When it has ended, or its time is up, every process of its group is killed: planners start others, and leave some.

    Args:
        seconds: how long it may take, of real time.
        most_bytes: more than that is not read; it is then killed at once.

    Raises:
        CommandError: if it cannot be started, takes too long or prints too much. A status is no error: planners have
            codes of their own.
    """
    try:
        process = subprocess.Popen(  # in a session, and so a group, of its own
            list(command), cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            start_new_session=True,
        )  # fmt: skip
    except OSError as error:
        raise CommandError(f"{command[0]} does not start: {error.strerror or error}") from error
    reader, errors = _Reader(process.stdout, most_bytes), _Reader(process.stderr, LAST, last=True)
    try:
        reader.start()
        errors.start()
        ended = _wait(process, time.monotonic() + seconds, reader)
    finally:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
    for each in (reader, errors):
        each.end()
    if reader.too_much:
        raise CommandError(f"{command[0]} printed more than {most_bytes} bytes")
    if not ended:
        raise CommandError(f"{command[0]} had not ended after {seconds:g} s")
    complaint = next((line for line in reversed(errors.text.splitlines()) if line.strip()), "")
    return Printed(reader.text, complaint.strip(), process.returncode)


def _wait(process: subprocess.Popen[bytes], until: float, reader: _Reader) -> bool:
    """Whether it ends in time. It is left as it is: as long as nobody has waited for it, its group's number is its."""
    while time.monotonic() < until and not reader.too_much:
        if os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOWAIT | os.WNOHANG) is not None:
            return True
        time.sleep(PAUSE)
    return False


class _Reader(threading.Thread):
    """Reads along, so that a planner that prints much does not stand still. A pipe ends when all its writers have.

    Args:
        most: bytes that are kept.
        last: the last ones are kept, and the others dropped; else more than that is too much.
    """

    def __init__(self, pipe: IO[bytes] | None, most: int, *, last: bool = False) -> None:
        super().__init__(daemon=True)
        self._pipe, self._most, self._last, self._read = pipe, most, last, b""
        self.too_much = False
        self._until = float("inf")

    def run(self) -> None:
        """Until the pipe's end, or too much has come, or nothing comes any more of what was written before `end`."""
        if self._pipe is None:
            return
        with self._pipe as pipe:
            while time.monotonic() < self._until and not self.too_much:
                if not select.select([pipe], [], [], PAUSE)[0]:
                    if self._until < float("inf"):
                        return
                elif part := os.read(pipe.fileno(), 65536):
                    self._take(part)
                else:
                    return

    def end(self) -> None:
        """Take what is there and end: what got away from the group may hold the pipe open for ever."""
        self._until = time.monotonic() + 1.0
        self.join()

    def _take(self, part: bytes) -> None:
        self._read += part
        if self._last:
            self._read = self._read[-self._most :]
        else:
            self.too_much = len(self._read) > self._most

    @property
    def text(self) -> str:
        """What came."""
        return self._read.decode("utf-8", "replace")
