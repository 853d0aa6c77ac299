"""Plug-ins that hang, die, and raise or return odd things cost their own episode and nothing else."""

from __future__ import annotations

import pwd
import signal
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from bench_helpers import jobs, odd_scene, read
from remac_bench.commands.progress import Bar
from remac_bench.console import console
from remac_bench.errors import JobTimeoutError
from remac_bench.playing.deadline import ASKING_SECONDS, JOB_SECONDS, Deadline, job_seconds
from remac_bench.playing.interrupts import SIGNALS, Stopped, is_stop, stoppable
from remac_bench.playing.runner import RunSummary, Settings, run_jobs
from remac_bench.playing.watch import GRACE_SECONDS, SLOW_SECONDS, Watch
from remac_bench.playing.worker import Work
from remac_bench.redaction import redact

from remac_env.errors import OptionError

ODD_SEED = 1


@pytest.fixture(autouse=True)
def told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Planners misbehave in the kitchen of this seed."""
    monkeypatch.setenv("ODD_SCENE", odd_scene(ODD_SEED))


def played(folder: Path, deed: str, settings: Settings, method: str = "CC") -> dict[int, Any]:
    """Seed -> the scored record, of three seeds of which one is odd; a second run has nothing left to do."""
    listed = jobs(method, seeds=range(3), planner=f"odd_planners:Misbehaves,deed={deed}")
    assert run_jobs(listed, folder, settings) == RunSummary(0, 3, ())
    assert run_jobs(listed, folder, settings) == RunSummary(3, 0, ())
    scored = {entry.seed: entry for entry in read(folder) if entry.scored}
    assert {seed: entry.success for seed, entry in scored.items()} == {0: True, ODD_SEED: False, 2: True}
    error = scored[ODD_SEED].error
    assert error is None or error.kind == "agent"
    return scored


@pytest.mark.parametrize(
    ("deed", "type_", "message"),
    [
        ("exits", "SystemExit", "enough"),
        ("stops", "KeyboardInterrupt", ""),
        ("closes", "GeneratorExit", ""),
        ("ends", "RuntimeError", "generator raised StopIteration"),
        ("deep", "Deep", ""),
        ("full", "MemoryError", ""),
        ("recurses", "RecursionError", "maximum recursion depth exceeded"),
        ("odd", "Odd", "<unprintable Odd>"),
        ("half", "Half", "half a pair: \\ud83d"),
        ("sour", "Odd", "<unprintable Odd>"),
        ("sour row", "Odd", "<unprintable Odd>"),
        ("sour rows", "Odd", "<unprintable Odd>"),
        ("sour plan", "Odd", "<unprintable Odd>"),
    ],
)
@pytest.mark.parametrize("engine", ["here", "threads"])
def test_what_planners_raise_and_return(tmp_path: Path, deed: str, type_: str, message: str, engine: str) -> None:
    settings = Settings(workers=0) if engine == "here" else Settings(workers=2, engine=engine)
    error = played(tmp_path, deed, settings)[ODD_SEED].error
    assert (error.type, error.message) == (type_, message)


@pytest.mark.parametrize("deed", ["stops", pytest.param("odd", marks=pytest.mark.long)])
def test_the_same_in_processes(tmp_path: Path, deed: str) -> None:
    played(tmp_path, deed, Settings(workers=2))


@pytest.mark.long
@pytest.mark.parametrize("deed", ["leaves", "fails"])
def test_a_planner_that_ends_its_process(tmp_path: Path, deed: str) -> None:
    error = played(tmp_path, deed, Settings(workers=2))[ODD_SEED].error
    assert error.type == "WorkerDiedError"


@pytest.mark.parametrize(
    ("settings", "deed"),
    [
        (Settings(workers=2, job_seconds=3.0), "counts"),
        (Settings(workers=1, job_seconds=3.0, engine="threads"), "hangs"),
        (Settings(workers=0, job_seconds=3.0), "spins"),
    ],
    ids=["processes", "threads", "here"],
)
def test_a_planner_that_never_returns(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, settings: Settings, deed: str
) -> None:
    for module in ("watch", "engines"):
        monkeypatch.setattr(f"remac_bench.playing.{module}.GRACE_SECONDS", 0.0)
    record = played(tmp_path, deed, settings, "RE")[ODD_SEED]
    assert (record.error.type, record.iteration) == ("JobTimeoutError", 2)
    assert record.options["job_seconds"] == 3.0
    assert record.error.message == "timeout: the job was not through after 3 s (--job-seconds)"


def test_what_fails_at_the_end_of_an_episode_is_not_the_next_one_s(tmp_path: Path) -> None:
    planner = "odd_planners:Misbehaves,deed=odd,once=true"
    listed = jobs("RE", seeds=range(ODD_SEED, ODD_SEED + 1), planner=planner, reflector="odd_planners:Reviews")
    run_jobs(listed, tmp_path, Settings(workers=0))
    first, *others = read(tmp_path)
    assert first.rounds == 0 and first.error is not None
    assert all(entry.rounds > 0 and entry.error is not None for entry in others)


# -- clocks ----------------------------------------------------------------------------------------------------


class Clock:
    """Shows what it is told."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


def test_slow_jobs_are_named_and_late_ones_found() -> None:
    clock, told = Clock(), []
    (job,) = jobs(seeds=range(1))
    work = Work(job=replace(job, seconds=600.0), folder="")
    watch = Watch(lambda job, seconds: told.append(seconds), clock)
    assert not watch.is_over(work)
    watch.begin(work)
    for clock.now in (0.0, SLOW_SECONDS - 1, SLOW_SECONDS, SLOW_SECONDS + 30, 200.0, 599.0, 601.0):
        assert not watch.is_over(work)
    assert told == [60.0, 200.0, 599.0]
    clock.now = 600.0 + GRACE_SECONDS
    assert watch.is_over(work)
    watch.end(work)
    assert not watch.is_over(work)


def test_a_deadline_is_looked_at_between_rounds() -> None:
    clock = Clock()
    deadline = Deadline.within(5.0, clock)
    deadline.check()
    clock.now = 5.0
    with pytest.raises(JobTimeoutError, match="after 5 s"):
        deadline.check()


def test_progress_names_the_job(capsys: pytest.CaptureFixture[str]) -> None:
    (job,) = jobs(seeds=range(3, 4), tasks="OpenCabinetPnP")
    bar = Bar(screen=console(stderr=True))
    bar.begin([job])
    bar.slow(job, 90.4)
    bar.stop()
    told = capsys.readouterr().err
    assert f"job {job.key}: OpenCabinetPnP seed 3 (BASE) has been running for 90 s\n" in told


def test_progress_says_whose_answers_are_waited_for(capsys: pytest.CaptureFixture[str]) -> None:
    (job,) = jobs(planner="http://127.0.0.1:9/plan", seeds=range(1))
    bar = Bar(screen=console(stderr=True))
    bar.slow(job, 61.0)
    told = " ".join(capsys.readouterr().err.split())
    assert told.endswith("for 61 s, the waiting for answers of http://127.0.0.1:9/plan included")


@pytest.mark.parametrize(
    ("agent", "seconds"),
    [
        ({}, JOB_SECONDS),
        ({"planner": "my.py:plan"}, JOB_SECONDS),
        ({"planner": "human"}, ASKING_SECONDS),
        ({"planner": "http://127.0.0.1:8000/plan"}, ASKING_SECONDS),
        ({"model": "o3"}, ASKING_SECONDS),
        ({"checker": "openai:gpt-4o"}, ASKING_SECONDS),
    ],
)
def test_the_bound_hangs_on_who_is_asked(agent: dict[str, str], seconds: float) -> None:
    assert job_seconds(None, agent) == seconds
    assert job_seconds(7.0, agent) == 7.0


@pytest.mark.parametrize("seconds", [0.0, -1.0, float("inf"), float("nan"), "9"])
def test_bounds_that_are_none(seconds: Any) -> None:
    with pytest.raises(OptionError, match="job_seconds .* valid: a number from 0.001 to"):
        Settings(job_seconds=seconds)


# -- stopping --------------------------------------------------------------------------------------------------


def test_who_wants_to_stop() -> None:
    assert is_stop(KeyboardInterrupt()) and is_stop(Stopped())
    with stoppable(*SIGNALS):
        assert is_stop(Stopped()) and not is_stop(KeyboardInterrupt())
    assert is_stop(KeyboardInterrupt()) and not is_stop(SystemExit())


def test_who_presses_ctrl_c_again_does_not_stop_the_stopping() -> None:
    before = signal.getsignal(signal.SIGINT)
    ended = []
    with pytest.raises(Stopped), stoppable(*SIGNALS):
        try:
            with stoppable(signal.SIGINT):
                try:
                    signal.raise_signal(signal.SIGINT)
                finally:
                    signal.raise_signal(signal.SIGINT)
                    ended.append("inner")
        finally:
            for number in SIGNALS:
                signal.raise_signal(number)
            ended.append("outer")
    assert ended == ["inner", "outer"] and signal.getsignal(signal.SIGINT) is before
    with pytest.raises(Stopped), stoppable(signal.SIGINT):
        signal.raise_signal(signal.SIGINT)


# -- a user without a home -------------------------------------------------------------------------------------


def test_a_user_without_a_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def nobody(number: int) -> Any:
        raise KeyError(f"getpwuid(): uid not found: {number}")

    monkeypatch.delenv("HOME")
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(pwd, "getpwuid", nobody)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(RuntimeError):
        Path.home()
    assert redact("in /a/b/c.txt") == "in c.txt"
    played(tmp_path / "out", "half", Settings(workers=0))
    from remac_env.rendering import gl

    gl._remember("key", "egl")
    gl.forget("nothing")
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
