"""Jobs on a Ray cluster: many machines, or one. Ray is an extra, and imported only when it is asked for."""

from __future__ import annotations

import os
import sys
from collections import deque
from collections.abc import Iterator, Sequence
from typing import Any

from remac_bench.errors import UsageError
from remac_bench.playing.extensions import load_extensions
from remac_bench.playing.losses import Losses
from remac_bench.playing.machine import cores
from remac_bench.playing.watch import LOOKS, Watch
from remac_bench.playing.worker import Work, play_job, timed_out
from remac_bench.records import Record

CRASHED = 1
"""Stands for the exit status of a worker that ended by itself: Ray does not tell it."""


def play(
    works: Sequence[Work], *, workers: int | None, address: str | None, extensions: Sequence[str], watch: Watch
) -> Iterator[tuple[Work, list[Record]]]:
    """Play works on the cluster and yield each as it ends. Only this process writes records.

    The cluster's machines need the same version of this package; videos and pictures are written to the records'
    folder, which then has to be a shared one.

    Args:
        workers: jobs at the same time at most; None: one a core of the cluster.
        address: of the cluster, as for `ray.init`; None: one is started on this machine and ends with the run.

    Raises:
        UsageError: if Ray is not installed, or there is no cluster at the address.
    """
    ray = _load()
    try:
        _join(ray, workers, address)
    except (ConnectionError, ValueError, RuntimeError) as error:
        raise UsageError(f"no Ray cluster at {address or 'this machine'!r}: {str(error).splitlines()[0]}") from error
    try:
        count = workers or int(ray.cluster_resources().get("CPU", 1))
        yield from _spread(ray, deque(works), count, tuple(extensions), watch)
    finally:
        ray.shutdown()


def _spread(
    ray: Any, queue: deque[Work], count: int, extensions: tuple[str, ...], watch: Watch
) -> Iterator[tuple[Work, list[Record]]]:
    remote = ray.remote(max_retries=0, num_cpus=1)(_play)  # it is we who decide what is played again
    losses = Losses()
    running: dict[Any, Work] = {}
    while queue or running:
        while queue and len(running) < count:
            work = queue.popleft()
            running[remote.remote(work, extensions)] = work
            watch.begin(work)
        for late in [task for task, work in running.items() if watch.is_over(work)]:
            ray.cancel(late, force=True)
            watch.end(work := running.pop(late))
            yield work, [timed_out(work)]
        done, _ = ray.wait(list(running), num_returns=1, timeout=LOOKS) if running else ([], [])
        if not done:
            continue
        (ended,) = done
        watch.end(work := running.pop(ended))
        try:
            records = [Record.model_validate_json(line) for line in ray.get(ended)]
        except (ray.exceptions.RaySystemError, ray.exceptions.RayError) as error:
            lost = losses.judge(work, _status(ray, error))
            if lost is None:
                queue.appendleft(work)
                continue
            records = [lost]
        yield work, records


def _play(work: Work, extensions: tuple[str, ...]) -> list[str]:
    """On a machine of the cluster: the records as lines of JSON."""
    load_extensions(extensions)
    return [record.line() for record in play_job(work)]


def _status(ray: Any, error: BaseException) -> int | None:
    """CRASHED for a worker that ended by itself; None for a machine that was lost, or ran out of memory.

    Raises:
        RayTaskError: what was raised in our own code there, as it is.
    """
    if isinstance(error, ray.exceptions.RayTaskError):
        raise error
    return CRASHED if isinstance(error, ray.exceptions.WorkerCrashedError) else None


def _join(ray: Any, workers: int | None, address: str | None) -> None:
    quiet: dict[str, Any] = {"log_to_driver": False, "logging_level": "ERROR", "configure_logging": False}
    if address is not None:
        ray.init(address=address, **quiet)
        return
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")  # else it reports to its makers
    paths = os.pathsep.join(path for path in sys.path if path)
    environment = {"env_vars": {"PYTHONPATH": paths}}
    ray.init(address="local", num_cpus=workers or cores(), include_dashboard=False, runtime_env=environment, **quiet)


def _load() -> Any:
    try:
        import ray
    except ImportError as error:
        raise UsageError("--engine ray needs Ray: pip install 'remac-kitchen[ray]'") from error
    return ray
