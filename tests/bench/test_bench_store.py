"""The records file and the lock, under what a crash leaves behind."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from bench_helpers import ROOT, record
from remac_bench.errors import LockedError, RecordFileError
from remac_bench.playing.lock import FILE, locked
from remac_bench.records import ErrorEntry
from remac_bench.store import Store, finished_jobs


def written(folder: Path) -> Store:
    """A folder with two jobs: one of two iterations, one of one."""
    store = Store(folder)
    store.append([record(job="a", scored=False), record(job="a", iteration=1)])
    store.append([record(job="b", agent="Gemüse|x")])
    return store


def test_what_is_written_is_read(tmp_path: Path) -> None:
    store = written(tmp_path)
    assert [(r.job, r.iteration, r.agent) for r in store.read()] == [
        ("a", 0, "CC"),
        ("a", 1, "CC"),
        ("b", 0, "Gemüse|x"),
    ]
    assert '"schema":1' in store.path.read_text("utf-8")
    assert finished_jobs(store.read()) == {"a", "b"}


@pytest.mark.parametrize("step", [29, pytest.param(1, marks=pytest.mark.long)])
def test_a_file_torn_at_any_byte_is_repaired_and_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: int
) -> None:
    monkeypatch.setattr(os, "fsync", lambda handle: None)  # thousands of waits for a disk prove nothing here
    data = written(tmp_path).path.read_bytes()
    ends = [index + 1 for index, byte in enumerate(data) if byte == ord("\n")]
    store = Store(tmp_path)
    for size in sorted({*range(0, len(data), step), *(end + by for end in ends for by in (-2, -1, 0))} - {len(data)}):
        store.path.write_bytes(data[:size])
        # The end of a line may be missing: the record before it is whole.
        whole = sum(size >= end - 1 for end in ends)
        assert len(store.read()) == whole, size
        cut = store.repair()
        assert cut == (
            0 if size in ends or size + 1 in ends else size - max([0, *(e for e in ends if e < size)])
        )
        store.append([record(job="next")])
        assert [r.job for r in store.read()] == ["a", "a", "b"][:whole] + ["next"], size


def test_half_a_job_is_not_finished_and_is_replaced(tmp_path: Path) -> None:
    store = Store(tmp_path)
    store.append([record(job="a", iteration=0, scored=False, rounds=1)])
    assert finished_jobs(store.read()) == set()
    store.append([record(job="a", iteration=0, scored=False, rounds=2), record(job="a", iteration=1)])
    assert [(r.iteration, r.rounds) for r in store.read()] == [(0, 2), (1, 0)]
    assert finished_jobs(store.read()) == {"a"}


def test_an_infrastructure_error_leaves_a_job_unfinished(tmp_path: Path) -> None:
    store = Store(tmp_path)
    broken = ErrorEntry(kind="infrastructure", type="OSError", message="")
    store.append([record(scored=False, success=False, error=broken)])
    assert finished_jobs(store.read()) == set()


@pytest.mark.parametrize("line", [b"{}", b"not json", b'{"job": 3', b"\xff\xfe", b""])
def test_a_foreign_line_in_the_middle_is_named(tmp_path: Path, line: bytes) -> None:
    store = written(tmp_path)
    lines = store.path.read_bytes().split(b"\n")
    store.path.write_bytes(b"\n".join([lines[0], line, *lines[1:]]))
    with pytest.raises(RecordFileError, match=r"records\.jsonl, line 2"):
        store.read()


def test_records_that_are_a_folder_are_named(tmp_path: Path) -> None:
    (tmp_path / "records.jsonl").mkdir()
    for read in (Store(tmp_path).lines, Store(tmp_path).raw_lines, Store(tmp_path).repair):
        with pytest.raises(RecordFileError, match="cannot be read: Is a directory; valid"):
            read()


def test_records_of_a_later_version_are_refused_and_added_fields_are_not(tmp_path: Path) -> None:
    store = Store(tmp_path)
    line = record().line()
    store.path.write_text(line.replace('"schema":1', '"schema":1,"colour":"red"') + "\n", "utf-8")
    assert len(store.read()) == 1
    store.path.write_text(line.replace('"schema":1', '"schema":2') + "\n", "utf-8")
    with pytest.raises(RecordFileError, match="later version"):
        store.read()


def test_clear_removes_records_and_their_videos_only(tmp_path: Path) -> None:
    store = written(tmp_path)
    (tmp_path / "videos").mkdir()
    (tmp_path / "videos" / "a.webm").touch()
    (tmp_path / "videos" / "mine.txt").touch()
    (tmp_path / "notes.md").touch()
    store.clear()
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["mine.txt", "notes.md", "videos"]


HOLDER = (
    "import sys, time, pathlib\n"
    "from remac_bench.playing.lock import locked\n"
    "with locked(pathlib.Path(sys.argv[1])):\n"
    "    sys.stdout.write('held\\n'); sys.stdout.flush(); time.sleep(60)\n"
)


def test_a_second_runner_is_refused_until_the_first_is_gone(tmp_path: Path) -> None:
    environment = {**os.environ, "PYTHONPATH": f"{ROOT}{os.pathsep}{ROOT / 'benchmarks'}"}
    first = subprocess.Popen(
        [sys.executable, "-c", HOLDER, str(tmp_path)], env=environment, stdout=subprocess.PIPE, text=True
    )
    try:
        assert first.stdout is not None
        assert first.stdout.readline() == "held\n"
        with pytest.raises(LockedError, match=f"process {first.pid} on "), locked(tmp_path):
            pass
    finally:
        first.send_signal(signal.SIGKILL)
        first.communicate()
    assert (tmp_path / FILE).exists()  # it had no time to clear up, and yet:
    with locked(tmp_path):
        pass
    assert not (tmp_path / FILE).exists()


def test_a_lock_that_is_let_go_can_be_taken_again(tmp_path: Path) -> None:
    for _ in range(2):
        with locked(tmp_path), pytest.raises(LockedError), locked(tmp_path):
            pass
