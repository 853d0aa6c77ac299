"""The records file: appended to a job at a time, repaired after a crash, read with later lines winning."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from pathlib import Path

from pydantic import ValidationError

from remac_bench.errors import RecordFileError
from remac_bench.records import SCHEMA, Record

FILE = "records.jsonl"
VIDEOS = "videos"


class Store:
    """The records of a folder."""

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        self.path = self.folder / FILE

    def append(self, records: Sequence[Record]) -> None:
        """Write the records of one finished job in one piece, and wait until the disk has them."""
        data = "".join(f"{record.line()}\n" for record in records).encode()
        fresh = not self.path.exists()
        with self.path.open("ab") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        if fresh:
            _sync_folder(self.folder)

    def read(self) -> list[Record]:
        """The records that count: of each job and iteration the last one written, in the order of writing.

        A last line without its end, torn by a crash, is left out.

        Raises:
            RecordFileError: for any other line that is no record, and for records of a later version.
        """
        if not self.path.exists():
            return []
        whole, torn = _split(self.path.read_bytes())
        lines = [*whole, torn] if _is_record(torn) else whole
        return latest(
            _parse(line, f"{self.path}, line {number}") for number, line in enumerate(lines, start=1)
        )

    def repair(self) -> int:
        """Cut off a torn last line; returns the bytes cut. A record that only lacks its end gets it."""
        if not self.path.exists():
            return 0
        data = self.path.read_bytes()
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
        """Remove the records and the videos that belong to them; other files stay."""
        self.path.unlink(missing_ok=True)
        for video in sorted((self.folder / VIDEOS).glob("*.webm")):
            video.unlink()


def latest(records: Iterable[Record]) -> list[Record]:
    """The last record of each job and iteration."""
    kept = {(record.job, record.iteration): record for record in records}
    return list(kept.values())


def finished_jobs(records: Iterable[Record]) -> set[str]:
    """Keys of the jobs whose last iteration is recorded; not those stopped by an infrastructure error."""
    return {record.job for record in records if record.scored}


def _split(data: bytes) -> tuple[list[bytes], bytes]:
    """The lines that have their end, and what comes after the last of them."""
    *whole, torn = data.split(b"\n")
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
