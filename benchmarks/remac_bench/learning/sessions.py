"""What the commands do: record shards, train a skill from them, try skills; side by side in processes where wanted."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from remac_bench.errors import UsageError
from remac_bench.learning.cells import Cells
from remac_bench.learning.demos import file_digest, read_demos, shards, write_shard
from remac_bench.learning.evaluate import Score, Trial, evaluate, score
from remac_bench.learning.record import Recorder
from remac_bench.learning.train import Recipe, code_digest, frames, train
from remac_env.backends.physics.controllers.learned.weights import About, Weights, read_weights, save_weights
from remac_env.lowlevel.names import camel

SHARD = 40
"""Episodes a file: what is lost at most where recording is killed."""

SCRIPTED = "scripted"
SETS = ("layouts and styles of the demonstrations", "layouts and styles held out")
_SAMPLE = 8  # observations that weights keep, with what the network says to them


def record_all(
    skills: Sequence[str], seeds: Sequence[int], cells: Cells, out: Path, *, target: str | None, disturb: float,
    processes: int,
) -> Iterator[str]:
    """Record every skill on these seeds, a file for each SHARD of them; a line for each that is done."""
    parts = [seeds[index : index + SHARD] for index in range(0, len(seeds), SHARD)]
    jobs = [(skill, part, out / f"{camel(skill)}_{part[0]:06d}.hdf5") for part in parts for skill in skills]
    fresh = [job for job in jobs if not job[2].exists()]
    yield from (f"{path.name}: there already" for _, _, path in jobs if path.exists())
    yield from _side_by_side(partial(_record_part, cells=cells, target=target, disturb=disturb), fresh, processes)


def _record_part(
    job: tuple[str, Sequence[int], Path], *, cells: Cells, target: str | None, disturb: float
) -> str:
    skill, seeds, path = job
    recorder = Recorder(skill, target, disturb=disturb)
    demos = []
    for seed in seeds:
        style, layout = cells.of(seed, skill)
        demo = recorder.record(seed, style=style, layout=layout)
        demos += [demo] if demo is not None else []
    if not demos:
        raise UsageError(f"{skill}: none of the seeds {seeds[0]}..{seeds[-1]} was carried out")
    write_shard(path, demos)
    return f"{path.name}: {len(demos)} of {len(seeds)} episodes, {sum(len(demo.actions) for demo in demos)} steps"


def train_skill(skill: str, folder: Path, out: Path, recipe: Recipe) -> Iterator[str]:
    """Train a skill on what a folder holds of it and write its weights; lines on how it goes.

    Raises:
        UsageError: where nothing was recorded, or what it needs is not installed.
    """
    files = shards(folder, skill)
    demos = list(read_demos(files))
    data = frames(demos, recipe.chunk)
    yield f"{skill}: {len(demos)} demonstrations, {len(data.seen)} frames"
    losses: list[float] = []
    network = train(data, recipe, report=lambda epoch, loss: losses.append(loss))
    step = max(1, len(data.seen) // _SAMPLE)
    seeds = [demo.seed for demo in demos]
    about = About(
        skill=skill, targets=tuple(sorted({demo.target for demo in demos})), execute=recipe.execute,
        demonstrations=len(demos), seeds=f"{min(seeds)}:{max(seeds) + 1}",
        layouts=tuple(sorted({demo.layout for demo in demos})), styles=tuple(sorted({demo.style for demo in demos})),
        data=file_digest(files), code=code_digest(),
    )  # fmt: skip
    path = out / f"{camel(skill)}.npz"
    save_weights(path, Weights(about=about, network=network, sample=data.seen[::step][:_SAMPLE]))
    size = path.stat().st_size / 1000
    yield f"{skill}: loss {losses[0]:.3f} to {losses[-1]:.3f} in {len(losses)} epochs; {path}, {size:.0f} kB"


def evaluate_all(
    skills: Sequence[str], folder: Path, seeds: Sequence[int], cells: tuple[Cells, Cells], *, note: bool,
    processes: int,
) -> list[Score]:
    """Try skills on seeds, in the cells of the demonstrations and in those held out; a score each, and by target.

    Args:
        folder: of the weights; "scripted": the scripted controllers.
        note: write into the weights how often they succeeded.
    """
    jobs = [(skill, where, part) for skill in skills for where in (0, 1) for part in _parts(seeds, processes)]
    done = list(_side_by_side(partial(_try_part, folder=folder, cells=cells), jobs, processes))
    found = []
    for skill in skills:
        measured = {}
        for where, name in enumerate(SETS):
            tried = [trial for job, part in zip(jobs, done, strict=True) if job[:2] == (skill, where) for trial in part]
            for target in sorted({trial.target for trial in tried}):
                some = [trial for trial in tried if trial.target == target]
                found.append(score(f"{skill} {target}: {name}", some))
                measured[found[-1].name] = {"trials": len(some), "successes": found[-1].successes}
        if note and str(folder) != SCRIPTED:
            path = folder / f"{camel(skill)}.npz"
            weights = read_weights(path)
            save_weights(path, replace(weights, about=replace(weights.about, measured=measured)))
    return found


def _parts(seeds: Sequence[int], processes: int) -> list[Sequence[int]]:
    size = -(-len(seeds) // processes)
    return [seeds[index : index + size] for index in range(0, len(seeds), size)]


def _try_part(job: tuple[str, int, Sequence[int]], *, folder: Path, cells: tuple[Cells, Cells]) -> list[Trial]:
    skill, where, seeds = job
    weights = None if str(folder) == SCRIPTED else read_weights(folder / f"{camel(skill)}.npz")
    return list(evaluate(skill, weights, seeds, cells[where]))


def _side_by_side(play: Callable[[Any], Any], jobs: Sequence[Any], processes: int) -> Iterator[Any]:
    """Jobs in order, in as many processes; in this one where one is enough."""
    if processes == 1:
        yield from map(play, jobs)
        return
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        yield from pool.map(play, jobs)
