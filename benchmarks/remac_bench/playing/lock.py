"""One runner a folder: a lock that ends with its process, however that ends."""

from __future__ import annotations

import json
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from remac_bench.errors import LockedError, StorageError
from remac_env.locks import lock

FILE = "runner.lock"


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold the folder's lock.

    The operating system lets go of it when the process dies, so no stale lock has to be cleared away.
    The file names the holder.

    Raises:
        LockedError: if another process holds it; the message names process and host.
        StorageError: if the disk is full, or the lock cannot be taken for another reason. A file system that has no
            locks is no reason: that is logged.
    """
    path = folder / FILE
    handle = _acquire(path)
    try:
        _sign(handle, path)
        yield
    finally:
        # Removed while still held, so that nobody can lock a file that is about to go.
        path.unlink(missing_ok=True)
        os.close(handle)


def _sign(handle: int, path: Path) -> None:
    try:
        os.ftruncate(handle, 0)
        os.write(handle, json.dumps({"pid": os.getpid(), "host": socket.gethostname()}).encode())
    except OSError as error:
        raise StorageError(f"{path}: {error.strerror or error}; make room, and the same command resumes") from error


def _acquire(path: Path) -> int:
    while True:
        handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            lock(handle, path, wait=False)
        except BlockingIOError as error:
            holder = _holder(handle)
            os.close(handle)
            raise LockedError(
                f"{path.parent} is in use by another runner ({holder}); wait for it or stop it"
            ) from error
        except OSError as error:
            os.close(handle)
            raise StorageError(f"{path}: {error.strerror or error}; give another --out") from error
        if _still_there(handle, path):
            return handle
        os.close(handle)  # its holder removed it between our opening and locking it


def _still_there(handle: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(handle), path.stat())
    except FileNotFoundError:
        return False


def _holder(handle: int) -> str:
    try:
        holder = json.loads(os.pread(handle, 1000, 0))
        return f"process {int(holder['pid'])} on {holder['host']}"
    except (ValueError, KeyError, TypeError):
        return "its process is not known"
