"""The records of a folder as they are appended: each line is read once."""

from __future__ import annotations

import threading
from pathlib import Path

from remac_bench.blame.sheet import FILE as BLAMES
from remac_bench.records import Record
from remac_bench.store import Store, latest


class Tail:
    """Follows a folder's records. Threads may share it."""

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        self._store = Store(self.folder)
        self._records: list[Record] = []
        self._read = 0
        self._lock = threading.Lock()

    def records(self) -> list[Record]:
        """Those that count by now; none where nothing has been written yet.

        Raises:
            RecordFileError: if a line is no record.
        """
        with self._lock:
            if self._store.size < self._read:  # the run began anew
                self._records, self._read = [], 0
            more, self._read = self._store.lines_from(self._read, lines=len(self._records))
            self._records += more
            return latest(self._records)

    def stamp(self) -> str:
        """Another text whenever something has been written: what pages were made of."""
        blames = self.folder / BLAMES
        told = blames.stat() if blames.is_file() else None
        return f"{self._store.size}-{told.st_size if told else 0}-{told.st_mtime_ns if told else 0}"
