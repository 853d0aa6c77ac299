"""Locks on files, on file systems that have them; where they are missing it is said once, and work goes on."""

from __future__ import annotations

import errno
import logging
import os
from typing import IO

try:
    import fcntl
except ImportError:  # this platform has no such locks
    fcntl = None  # type: ignore[assignment]

_LOG = logging.getLogger(__name__)

HELD = (errno.EWOULDBLOCK, errno.EAGAIN)
"""What the system answers where somebody else holds the lock."""

MISSING = (errno.ENOSYS, errno.ENOTSUP, errno.EOPNOTSUPP, errno.ENOLCK)
"""What it answers where the file system has no locks: some network file systems, or their lock server is down."""

_told: set[str] = set()


def lock(file: int | IO[bytes], path: str | os.PathLike[str], *, wait: bool) -> bool:
    """Take the lock of an open file; closing the file lets go of it. Returns False where there are no locks.

    Args:
        file: the file, or its descriptor.
        path: its name, for messages.
        wait: until another holder lets go.

    Raises:
        BlockingIOError: if another process holds it, without `wait`.
        OSError: if it cannot be taken for another reason, which the message names.
    """
    if fcntl is None:
        return False
    try:
        fcntl.flock(file, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except OSError as error:
        why = error.strerror or str(error)
        if error.errno in HELD:
            raise BlockingIOError(error.errno, "is in use by another process", os.fspath(path)) from error
        if error.errno not in MISSING:
            raise OSError(error.errno, f"cannot be locked: {why}", os.fspath(path)) from error
        folder = os.path.dirname(os.path.abspath(path))
        if folder not in _told:
            _told.add(folder)
            _LOG.warning("%s: its file system has no locks (%s): let one process at a time write there", folder, why)
        return False
    return True


def unlock(file: int | IO[bytes]) -> None:
    """Let go of a lock that `lock` has taken, while the file stays open."""
    if fcntl is not None:
        fcntl.flock(file, fcntl.LOCK_UN)
