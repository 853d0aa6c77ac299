"""Errors of the benchmark. Those that a user can mend by another command line are UsageErrors."""

from __future__ import annotations

from remac_env.errors import RemacError


class UsageError(RemacError, ValueError):
    """A command that cannot be run as it was given; the message says what is valid."""


class RecordFileError(RemacError, ValueError):
    """A records file that cannot be read; the message names file and line."""


class LockedError(RemacError, RuntimeError):
    """Another runner is at work in this folder."""


class StorageError(RemacError, OSError):
    """The records cannot be written: a full disk, a bound on the size of files, a folder that is gone."""


class JobTimeoutError(RemacError, TimeoutError):
    """A job whose time is up: a failure of the agent, whose role or plug-in did not come to an end."""

    def __init__(self, seconds: float) -> None:
        super().__init__(f"timeout: the job was not through after {seconds:g} s (--job-seconds)")
        self.seconds = seconds

    def __reduce__(self) -> tuple[object, ...]:
        # An exception's own way of being copied knows only the message.
        return JobTimeoutError, (self.seconds,)
