"""The records file: appended to a job at a time, repaired after a crash, read with later lines winning."""

from __future__ import annotations

import json
import os
import re
from codecs import BOM_UTF8
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from remac_bench.errors import RecordFileError, StorageError, UsageError
from remac_bench.records import SCHEMA, Record
from remac_env.files import read_text

FILE = "records.jsonl"
"""The records, in a run's folder."""

VIDEOS = "videos"
"""The folder of videos beside the records."""

PICTURES = "pictures"
"""The folder of pictures that models were shown."""

VIDEO_PATH = re.compile(rf"{VIDEOS}/[A-Za-z0-9_.-]+\.webm")
"""Where a record's video may lie."""

SUITE = "suite.json"
"""Which suite the records belong to."""


class Store:
    """The records of a `folder`, in the file `path` in it."""

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        self.path = self.folder / FILE

    def __repr__(self) -> str:
        return f"Store({str(self.folder)!r})"

    def append(self, records: Sequence[Record]) -> None:
        """Write the records of one finished job in one piece, and wait until the disk has them.

        Raises:
            StorageError: if they cannot be written; what was written before stays as it was.
        """
        data = "".join(f"{record.line()}\n" for record in records).encode()
        fresh = not self.path.exists()
        before = 0 if fresh else self.path.stat().st_size
        try:
            with self.path.open("ab") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
        except OSError as error:
            with suppress(OSError):  # what cannot be taken back, the next run repairs
                os.truncate(self.path, before)
            why = error.strerror or str(error)
            raise StorageError(f"{self.path}: {why}; make room, and the same command resumes") from error
        if fresh:
            _sync_folder(self.folder)

    def read(self) -> list[Record]:
        """The records that count: of each job and iteration the last one written, in the order of writing.

        Raises:
            RecordFileError: see `lines`.
        """
        return latest(self.lines())

    def lines(self) -> list[Record]:
        """Every record, in the order of writing; a last line without its end, torn by a crash, is left out.

        Raises:
            RecordFileError: for any other line that is not a record, and for records of a later version.
        """
        if not self.path.exists():
            return []
        whole, torn = _split(self._bytes())
        lines = [*whole, torn] if _is_record(torn) else whole
        return [_parse(line, f"{self.path}, line {number}") for number, line in enumerate(lines, start=1)]

    def _bytes(self) -> bytes:
        try:
            return self.path.read_bytes()
        except OSError as error:
            why = error.strerror or str(error)
            raise RecordFileError(f"{self.path} cannot be read: {why}; valid: a file of records") from error

    def raw_lines(self) -> list[bytes]:
        """The lines as they stand in the file, the torn last one too."""
        whole, torn = _split(self._bytes()) if self.path.exists() else ([], b"")
        return [*whole, torn] if torn else whole

    @property
    def size(self) -> int:
        """Bytes of the records; 0 where there are none yet."""
        return self.path.stat().st_size if self.path.is_file() else 0

    def lines_from(self, start: int, *, lines: int = 0) -> tuple[list[Record], int]:
        """The records behind a byte, and the byte behind the last line that has its end: a run may be writing more.

        Args:
            lines: how many lines lie before, for what errors say.

        Raises:
            RecordFileError: for a line that is not a record, and for records of a later version.
        """
        if not self.size:
            return [], 0
        with self.path.open("rb") as file:
            file.seek(start)
            data = file.read()
        whole, torn = _split(data)
        return [
            _parse(line, f"{self.path}, line {number}") for number, line in enumerate(whole, start=lines + 1)
        ], start + len(data) - len(torn)

    def repair(self) -> int:
        """Cut off a torn last line; returns the bytes cut. A record that only lacks its end gets it."""
        if not self.path.exists():
            return 0
        data = self._bytes()
        _, torn = _split(data)
        if not torn:
            return 0
        with self.path.open("rb+") as file:
            if _is_record(torn):
                file.seek(0, os.SEEK_END)
                file.write(b"\n")
            else:
                file.truncate(len(data) - len(torn))
            file.flush()
            os.fsync(file.fileno())
        return 0 if _is_record(torn) else len(torn)

    def clear(self) -> None:
        """Remove the records and the videos and pictures that belong to them; other files stay."""
        self.path.unlink(missing_ok=True)
        (self.folder / SUITE).unlink(missing_ok=True)
        for file in [*(self.folder / VIDEOS).glob("*.webm"), *(self.folder / PICTURES).glob("*.png")]:
            file.unlink()

    def claim(self, suite: Mapping[str, Any] | None) -> None:
        """Note that the folder holds the records of this suite, None for no suite.

        Raises:
            UsageError: if it holds those of another one, or of another content of the same one.
        """
        path = self.folder / SUITE
        if path.exists():
            held = _read_claim(path)
            if held != suite:
                raise UsageError(
                    f"{self.folder} holds records of {_suite(held)}, not of {_suite(suite)}: a suite is frozen; "
                    "give another --out, or the suite as it was"
                )
        elif suite is not None:
            if self.path.exists() and self.path.stat().st_size:
                raise UsageError(f"{self.folder} holds records of no suite, not of {_suite(suite)}; give another --out")
            part = path.with_suffix(".part")
            try:
                part.write_text(json.dumps(suite) + "\n", "utf-8")
                part.replace(path)
            except OSError as error:
                raise StorageError(f"{path}: {error.strerror or error}; make room first") from error


def _read_claim(path: Path) -> dict[str, Any]:
    try:
        return dict(json.loads(read_text(path)))
    except ValueError as error:
        raise RecordFileError(f"{path}: names no suite ({error}); give another --out, or remove the file") from error


def _suite(facts: Mapping[str, Any] | None) -> str:
    if facts is None:
        return "no suite"
    return f"suite {facts['suite']} version {facts['suite_version']} (content {facts['suite_digest']})"


def latest(records: Iterable[Record]) -> list[Record]:
    """The last record of each job and iteration."""
    kept = {(record.job, record.iteration): record for record in records}
    return list(kept.values())


def finished_jobs(records: Iterable[Record]) -> set[str]:
    """Keys of the jobs whose last iteration is recorded; not those stopped by an infrastructure error."""
    return {record.job for record in records if record.scored}


def _split(data: bytes) -> tuple[list[bytes], bytes]:
    """The lines that have their end, and what comes after the last of them."""
    *whole, torn = data.removeprefix(BOM_UTF8).split(b"\n")
    return whole, torn


def _is_record(line: bytes) -> bool:
    try:
        Record.model_validate_json(line)
    except ValidationError:
        return False
    return True


def _parse(line: bytes, where: str) -> Record:
    try:
        record = Record.model_validate_json(line)
    except ValidationError as error:
        first = error.errors()[0]
        problem = ".".join(str(part) for part in first["loc"]) or "the line"
        raise RecordFileError(
            f"{where}: no record ({problem}: {first['msg']}); remove the line to go on"
        ) from error
    if record.schema_version > SCHEMA:
        raise RecordFileError(
            f"{where}: written by a later version (schema {record.schema_version}; this one reads {SCHEMA})"
        )
    return record


def _sync_folder(folder: Path) -> None:
    """Make sure that a new file's name is on the disk too."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
