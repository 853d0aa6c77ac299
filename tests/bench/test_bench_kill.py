"""Runners that are killed or stopped in the middle, and what the same command then makes of it."""

from __future__ import annotations

import resource
import signal
import socket
import time
from pathlib import Path

import pytest
from bench_helpers import jobs, read, start, timeless, wait_for
from remac_bench.playing.runner import Settings, run_jobs
from remac_bench.report import read_rows

ARGUMENTS = (
    *("bench", "run", "--tasks", "HeatOnStove,OpenCabinetPnP", "--methods", "CC,RE"),
    *("--seeds", "0:3", "--backend", "symbolic", "--planner", "bench_planners:Slow", "--jobs", "2"),
    "--no-isolation",
)
EPISODES = 2 * 3 * (1 + 3)


def lines(folder: Path) -> int:
    """How many lines the records have by now."""
    path = folder / "records.jsonl"
    return path.read_bytes().count(b"\n") if path.exists() else 0


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the same jobs run without being disturbed."""
    folder = tmp_path_factory.mktemp("whole")
    listed = jobs("CC,RE", tasks="HeatOnStove,OpenCabinetPnP", seeds=range(3), planner="bench_planners:Slow")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("time.sleep", lambda seconds: None)
        run_jobs(listed, folder, Settings(workers=0))
    return folder


def children(pid: int) -> list[int]:
    """The processes that a process has started."""
    try:
        return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    except (FileNotFoundError, ProcessLookupError):  # it has ended
        return []


def gone(pid: int) -> bool:
    """True when a process has ended, whether or not anybody has taken note of it."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] == "Z"
    except (FileNotFoundError, ProcessLookupError):
        return True


def test_the_second_of_two_runners_is_told_and_goes_on_to_the_same_table_once_the_first_is_killed(
    tmp_path: Path, whole: Path
) -> None:
    runner = start(*ARGUMENTS, "--out", str(tmp_path))
    wait_for(lambda: lines(tmp_path) >= 6 or runner.poll() is not None)
    workers = children(runner.pid)
    runner.send_signal(signal.SIGSTOP)  # or else, on a busy machine, it might be done before the second one looks
    second = start(*ARGUMENTS, "--out", str(tmp_path))
    _, told = second.communicate(timeout=60)
    assert second.returncode == 1
    assert f"is in use by another runner (process {runner.pid} on {socket.gethostname()})" in told
    runner.send_signal(signal.SIGKILL)
    runner.communicate()
    recorded = lines(tmp_path)
    assert 0 < recorded < EPISODES, "it was not killed in the middle"
    for worker in workers:
        wait_for(lambda worker=worker: gone(worker))  # type: ignore[misc]
    assert lines(tmp_path) == recorded  # a worker without its runner writes nothing
    with (tmp_path / "records.jsonl").open("ab") as file:
        file.write(b'{"schema":1,"job":"torn')

    again = start(*ARGUMENTS, "--out", str(tmp_path))
    out, told = again.communicate(timeout=120)
    assert again.returncode == 0, told
    assert "found finished" in out
    assert read_rows(tmp_path) == read_rows(whole)
    assert timeless(read(tmp_path)) == timeless(read(whole))


@pytest.mark.parametrize(("number", "times"), [
    (signal.SIGINT, 1), pytest.param(signal.SIGINT, 2, marks=pytest.mark.long),
    pytest.param(signal.SIGTERM, 1, marks=pytest.mark.long),
])  # fmt: skip
def test_ctrl_c_and_termination_stop_cleanly(tmp_path: Path, whole: Path, number: signal.Signals, times: int) -> None:
    runner = start(*ARGUMENTS, "--out", str(tmp_path))
    wait_for(lambda: lines(tmp_path) >= 4 or runner.poll() is not None)
    workers = children(runner.pid)
    for _ in range(times):  # somebody may be impatient
        runner.send_signal(number)
        time.sleep(0.01)
    _, told = runner.communicate(timeout=60)
    assert runner.returncode == 130, told
    assert "jobs are recorded; the same command resumes" in told
    assert "Traceback" not in told
    assert not (tmp_path / "runner.lock").exists()
    for worker in workers:
        wait_for(lambda worker=worker: gone(worker), seconds=10)  # type: ignore[misc]
    assert 0 < lines(tmp_path) < EPISODES
    if number == signal.SIGTERM:  # after a kill it goes on in the same way: see above
        assert start(*ARGUMENTS, "--out", str(tmp_path)).wait(timeout=120) == 0
        assert read_rows(tmp_path) == read_rows(whole)


@pytest.mark.long
@pytest.mark.parametrize("part", [0.0, 0.6])
def test_a_full_disk_stops_a_run_and_the_same_command_goes_on(tmp_path: Path, whole: Path, part: float) -> None:
    room = int((whole / "records.jsonl").stat().st_size * part)

    def fill() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (room, room))

    runner = start(*ARGUMENTS, "--out", str(tmp_path), preexec_fn=fill)
    _, told = runner.communicate(timeout=120)
    assert runner.returncode == 1, told
    assert "File too large; make room, and the same command resumes" in told
    assert "Traceback" not in told
    kept = read(tmp_path)
    assert len(kept) < EPISODES
    assert not part or kept

    assert start(*ARGUMENTS, "--out", str(tmp_path)).wait(timeout=120) == 0
    assert read_rows(tmp_path) == read_rows(whole)
    assert timeless(read(tmp_path)) == timeless(read(whole))
