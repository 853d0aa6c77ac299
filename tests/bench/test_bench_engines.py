"""Engines: threads for those that wait, Ray for many machines; which is picked, and that none changes a result."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from pathlib import Path
from typing import Any

import pytest
from bench_helpers import jobs, read, timeless, wait_for
from remac_bench.errors import UsageError
from remac_bench.playing.engines import Engine
from remac_bench.playing.runner import Listener, Settings, run_jobs

from remac_agents.planners.literal import LiteralPlanner


class Gate(LiteralPlanner):
    """Answers once so many ask at the same time."""

    wanted, inside, most = 8, 0, 0
    lock = threading.Condition()

    def plan(self, request: Any) -> Any:
        """A literal plan, together with the others."""
        with Gate.lock:
            Gate.inside += 1
            Gate.most = max(Gate.most, Gate.inside)
            Gate.lock.notify_all()
            together = Gate.lock.wait_for(lambda: Gate.most >= Gate.wanted, timeout=20)
            Gate.inside -= 1
        if not together:
            raise TimeoutError(f"only {Gate.most} asked at the same time")
        return super().plan(request)


def test_threads_ask_at_the_same_time(tmp_path: Path) -> None:
    listed = jobs("BASE", seeds=range(16), planner="test_bench_engines:Gate")
    gate = sys.modules["test_bench_engines"].Gate
    gate.inside = gate.most = 0
    run_jobs(listed, tmp_path, Settings(workers=8, engine="threads"))
    assert gate.most == 8
    assert [record.error for record in read(tmp_path)] == [None] * 16


def test_threads_change_nothing(tmp_path: Path) -> None:
    listed = jobs("CC,REMAC", tasks="HeatOnStove,OpenCabinetPnP", seeds=range(3))
    run_jobs(listed, tmp_path / "here", Settings(workers=0))
    run_jobs(listed, tmp_path / "threads", Settings(workers=4, engine="threads"))
    assert timeless(read(tmp_path / "here")) == timeless(read(tmp_path / "threads"))


def test_a_defect_in_a_thread_ends_the_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: Any) -> Any:
        raise MemoryError("no more")

    monkeypatch.setattr("remac_bench.playing.threads.play_job", broken)
    with pytest.raises(MemoryError):
        run_jobs(jobs(seeds=range(3)), tmp_path, Settings(workers=2, engine="threads"))


@pytest.mark.parametrize(
    ("agent", "picked"),
    [
        ({}, "processes"),
        ({"planner": "oracle"}, "processes"),
        ({"planner": "bench_planners:Slow"}, "processes"),
        ({"planner": "openai:o3"}, "threads"),
        ({"model": "o3"}, "threads"),
        ({"checker": "openai:gpt-4o,seconds=3"}, "threads"),
    ],
)
def test_models_are_asked_from_threads(agent: dict[str, str], picked: str) -> None:
    from dataclasses import replace

    (job,) = [replace(job, agent=agent) for job in jobs(seeds=range(1))]
    assert Engine().picked([job]) == picked
    assert Engine(workers=0).picked([job]) == "here"
    assert Engine(name="processes").picked([job]) == "processes"


def test_ray_that_is_not_installed_is_named_with_its_extra(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(UsageError, match=r"pip install 'remac-kitchen\[ray\]'"):
        run_jobs(jobs(seeds=range(1)), tmp_path, Settings(engine="ray"))


@pytest.mark.long
def test_a_ray_worker_killed_midway_loses_nothing(tmp_path: Path) -> None:
    pytest.importorskip("ray")
    listed = jobs("CC,RE", seeds=range(6), planner="bench_planners:Slow")
    run_jobs(listed, tmp_path / "here", Settings(workers=2))
    killed: list[int] = []

    class Kills(Listener):
        """Kills a worker after the first job."""

        def end(self, job: Any, records: Any) -> None:
            """Once."""
            if not killed:
                wait_for(lambda: bool(_ray_workers()))
                killed.append(_ray_workers()[0])
                os.kill(killed[0], signal.SIGKILL)

    run_jobs(listed, tmp_path / "ray", Settings(workers=2, engine="ray"), listener=Kills())
    assert killed
    assert timeless(read(tmp_path / "ray")) == timeless(read(tmp_path / "here"))


def _ray_workers() -> list[int]:
    """Processes below this one that play a job on the cluster now."""
    found = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            line, status = path.read_bytes(), (path.parent / "stat").read_text()
        except OSError:
            continue
        if line.startswith(b"ray::_play") and _descends(int(status.split()[0])):
            found.append(int(path.parent.name))
    return found


def _descends(pid: int) -> bool:
    deadline = time.monotonic() + 5
    while pid > 1 and time.monotonic() < deadline:
        if pid == os.getpid():
            return True
        try:
            pid = int(Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[1])
        except OSError:
            return False
    return False
