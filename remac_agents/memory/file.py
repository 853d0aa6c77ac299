"""JSON lines that are appended to, that several processes may share, and that a kill at any byte does not spoil."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

from remac_env.files import ends_torn, read_bytes, unmarked
from remac_env.locks import lock


class MemoryFile:
    """Objects, one a line. A line that is torn or no object is passed over, and stays in the file."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._seen: tuple[int, int, int] | None = None
        self._entries: tuple[dict[str, Any], ...] = ()

    def entries(self) -> tuple[dict[str, Any], ...]:
        """What the file holds now, oldest first; nothing where there is none. It is read anew when it has changed."""
        try:
            found = self._path.stat()
            now = (found.st_ino, found.st_size, found.st_mtime_ns)
            if now != self._seen:
                lines = read_bytes(self._path).split(b"\n")
                self._entries = tuple(entry for line in lines if (entry := _parse(line)) is not None)
                self._seen = now
        except FileNotFoundError:
            self._entries, self._seen = (), None
        return self._entries

    def append(self, entry: Mapping[str, Any]) -> None:
        """Add a line, and see it on the disk before returning."""
        self._path.parent.mkdir(parents=True, exist_ok=True)
        line = json.dumps(entry, ensure_ascii=False)
        with self._locked() as file:
            # A line that was torn when a process died must not swallow this one.
            start = "\n" if ends_torn(file) else ""
            file.write(f"{start}{line}\n".encode(errors="replace"))
            file.flush()
            os.fsync(file.fileno())

    def rewrite(self, stays: Callable[[Mapping[str, Any]], bool]) -> int:
        """Replace the file by one with the entries that stay, asked newest first; returns how many went."""
        with self._locked() as file:
            file.seek(0)
            lines = [line for line in file.read().split(b"\n") if line.strip()]
            kept = [line for line in reversed(lines) if (entry := _parse(line)) is not None and stays(entry)]
            fresh = self._path.with_name(f"{self._path.name}.{os.getpid()}.new")
            with fresh.open("wb") as out:
                out.write(b"".join(line + b"\n" for line in reversed(kept)))
                out.flush()
                os.fsync(out.fileno())
            os.replace(fresh, self._path)
        return len(lines) - len(kept)

    @contextmanager
    def _locked(self) -> Iterator[BinaryIO]:
        """The file, opened to be read and appended to, and nobody else's until it is closed."""
        while True:
            with self._path.open("ab+") as file:
                lock(file, self._path, wait=True)
                # While we waited, another process may have put a new file in its place.
                if os.path.exists(self._path) and os.path.samestat(os.fstat(file.fileno()), os.stat(self._path)):
                    yield file
                    return


def _parse(line: bytes) -> dict[str, Any] | None:
    try:
        entry = json.loads(unmarked(line.decode(errors="replace")))
    except (ValueError, RecursionError):
        return None
    return entry if isinstance(entry, dict) else None
