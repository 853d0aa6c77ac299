"""What the commands do: record shards, train a skill from them, try skills; side by side in processes where wanted."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from remac_bench.errors import UsageError
from remac_bench.learning.cells import Cells
from remac_bench.learning.demos import Demo, file_digest, read_demos, shards, write_shard
from remac_bench.learning.evaluate import Score, Trial, evaluate, score
from remac_bench.learning.lerobot import Dataset, is_dataset, read_dataset
from remac_bench.learning.record import Recorder
from remac_bench.learning.train import Recipe, code_digest, frames, train, words_of
from remac_env.backends.physics.controllers.learned.library import file_name, weights_of
from remac_env.backends.physics.controllers.learned.weights import (
    SEVERAL,
    About,
    Weights,
    observation,
    read_weights,
    save_weights,
)
from remac_env.lowlevel.names import camel
from remac_env.robots.bodies import STANDARD
from remac_env.rules.skills import SKILLS

MakeRecorder = Callable[[str], Recorder]
"""Makes what records a skill; processes are handed it."""

SHARD, SHARD_WITH_PICTURES = 40, 5
"""Episodes a file: what is lost at most where recording is killed."""

SCRIPTED = "scripted"
SETS = ("layouts and styles of the demonstrations", "layouts and styles held out")
_OFTEN = 20  # demonstrations from which on a case counts as shown
_SAMPLE = 8  # observations that weights keep, with what the network says to them


def record_all(
    skills: Sequence[str], seeds: Sequence[int], cells: Cells, out: Path, make: MakeRecorder, *, processes: int
) -> Iterator[str]:
    """Record every skill on these seeds, a file for each SHARD of them; a line for each that is done."""
    jobs = _parts_of(skills, seeds, make)
    paths = {part: out / f"{part.name}.hdf5" for part in jobs}
    yield from (f"{path.name}: there already" for path in paths.values() if path.exists())
    fresh = [part for part in jobs if not paths[part].exists()]
    yield from side_by_side(partial(_recorded, cells=cells, make=make, out=out), fresh, processes)


def record_dataset(
    skills: Sequence[str], seeds: Sequence[int], cells: Cells, dataset: Dataset, make: MakeRecorder, *, processes: int
) -> Iterator[str]:
    """The same as parts of one LeRobot dataset."""
    jobs = _parts_of(skills, seeds, make)
    yield from (f"{part.name}: there already" for part in jobs if dataset.has(part.name))
    fresh = [part for part in jobs if not dataset.has(part.name)]
    work = partial(_demonstrated, cells=cells, make=make)
    for part, demos in zip(fresh, side_by_side(work, fresh, processes), strict=True):
        dataset.add(part.name, demos)
        yield _line(part, part.name, demos)


@dataclass(frozen=True)
class Part:
    """Seeds of a skill that are recorded together."""

    skill: str
    seeds: tuple[int, ...]

    @property
    def name(self) -> str:
        """What its file is called."""
        return f"{camel(self.skill)}_{self.seeds[0]:06d}"


def _parts_of(skills: Sequence[str], seeds: Sequence[int], make: MakeRecorder) -> list[Part]:
    size = SHARD if make(skills[0]).image_size is None else SHARD_WITH_PICTURES
    starts = range(0, len(seeds), size)
    return [Part(skill, tuple(seeds[first : first + size])) for first in starts for skill in skills]


def _recorded(part: Part, *, cells: Cells, make: MakeRecorder, out: Path) -> str:
    demos, path = _demonstrated(part, cells=cells, make=make), out / f"{part.name}.hdf5"
    write_shard(path, demos)
    return _line(part, path.name, demos)


def _demonstrated(part: Part, *, cells: Cells, make: MakeRecorder) -> list[Demo]:
    recorder, demos = make(part.skill), []
    for seed in part.seeds:
        style, layout = cells.of(seed, part.skill)
        demo = recorder.record(seed, style=style, layout=layout)
        demos += [demo] if demo is not None else []
    recorder.close()
    if not demos:
        raise UsageError(f"{part.skill}: none of the seeds {part.seeds[0]}..{part.seeds[-1]} was carried out")
    return demos


def _line(part: Part, name: str, demos: Sequence[Demo]) -> str:
    steps = sum(len(demo.actions) for demo in demos)
    return f"{name}: {len(demos)} of {len(part.seeds)} episodes, {steps} steps"


def train_skill(skill: str, folder: Path, out: Path, recipe: Recipe, body: str = STANDARD) -> Iterator[str]:
    """Train a skill on what a folder holds of it and write its weights; lines on how it goes.

    Args:
        body: the name of the body that it was recorded with.

    Raises:
        UsageError: where nothing was recorded, or what it needs is not installed.
    """
    kept, demos = _recorded_of(folder, skill, body)
    yield from _trained(skill, demos, kept, out, recipe, ())


def train_together(
    skills: Sequence[str], folder: Path, out: Path, recipe: Recipe, body: str = STANDARD
) -> Iterator[str]:
    """Train one network on all of these skills, which is told the words of commands; see `train_skill`.

    Raises:
        UsageError: for skills that do not see the same.
    """
    if len({observation(skill) for skill in skills}) > 1:
        raise UsageError(f"{', '.join(skills)}: drives look around, and others do not; valid: one kind together")
    found = [_recorded_of(folder, skill, body) for skill in skills]
    kept = sorted({path for paths, _ in found for path in paths})
    demos = [demo for _, some in found for demo in some]
    yield from _trained(SEVERAL, demos, kept, out, recipe, words_of(demos))


def _recorded_of(folder: Path, skill: str, body: str) -> tuple[list[Path], list[Demo]]:
    """The files of a skill's demonstrations, and what is in them."""
    if is_dataset(folder):
        kept, demos = sorted((folder / "data").glob("*/*.parquet")), list(read_dataset(folder, skill, body))
    else:
        kept = shards(folder, skill)
        demos = list(read_demos(kept, body))
    if not demos:
        raise UsageError(f"{folder} has no demonstrations of {skill!r}; record them: remac learn record")
    return kept, demos


def _trained(
    name: str, demos: list[Demo], kept: list[Path], out: Path, recipe: Recipe, words: tuple[str, ...]
) -> Iterator[str]:
    data = frames(demos, recipe.chunk, words, hand=recipe.hand)
    yield f"{name}: {len(demos)} demonstrations, {len(data.seen)} frames"
    losses: list[float] = []
    network = train(data, recipe, report=lambda epoch, loss: losses.append(loss))
    step = max(1, len(data.seen) // _SAMPLE)
    seeds = [demo.seed for demo in demos]
    worked = {demo.target for demo in demos if not demo.case and not SKILLS[demo.skill].moves}
    about = About(
        skill=name, targets=tuple(sorted(worked)), execute=recipe.execute,
        demonstrations=len(demos), seeds=f"{min(seeds)}:{max(seeds) + 1}",
        layouts=tuple(sorted({demo.layout for demo in demos})), styles=tuple(sorted({demo.style for demo in demos})),
        data=file_digest(kept), code=code_digest(), words=words,
        skills=tuple(sorted({demo.skill for demo in demos})) if name == SEVERAL else (), cases=shown_cases(demos),
    )  # fmt: skip
    path = out / f"{camel(name)}.npz"
    save_weights(path, Weights(about=about, network=network, sample=data.seen[::step][:_SAMPLE]), demos[0].body)
    size = path.stat().st_size / 1000
    yield f"{name}: loss {losses[0]:.3f} to {losses[-1]:.3f} in {len(losses)} epochs; {path}, {size:.0f} kB"


def shown_cases(demos: Sequence[Demo]) -> tuple[str, ...]:
    """The cases that were shown often enough, or all of them where none was; none for skills that have no cases."""
    shown = Counter(f"{demo.skill} {demo.case}" for demo in demos if demo.case)
    return tuple(sorted([told for told, count in shown.items() if count >= _OFTEN] or shown))


def evaluate_all(
    skills: Sequence[str], folder: Path, seeds: Sequence[int], cells: tuple[Cells, Cells], *, note: bool,
    processes: int, body: str = STANDARD,
) -> list[Score]:
    """Try skills on seeds, in the cells of the demonstrations and in those held out; a score for each case or target.

    Args:
        body: the name of the robot's.
        folder: of the weights; "scripted": the scripted controllers.
        note: write into the weights how often they succeeded.
    """
    jobs = [(skill, where, part) for skill in skills for where in (0, 1) for part in _parts(seeds, processes)]
    done = list(side_by_side(partial(_try_part, folder=folder, cells=cells, body=body), jobs, processes))
    found = []
    for skill in skills:
        measured = {}
        for where, name in enumerate(SETS):
            tried = [trial for job, part in zip(jobs, done, strict=True) if job[:2] == (skill, where) for trial in part]
            for what in sorted({trial.what for trial in tried}):
                some = [trial for trial in tried if trial.what == what]
                found.append(score(f"{skill} {what}: {name}", some))
                measured[found[-1].name] = {"trials": len(some), "successes": found[-1].successes}
        if note and str(folder) != SCRIPTED:
            _note(folder, skill, measured, body)
    return found


def _note(folder: Path, skill: str, measured: dict[str, dict[str, int]], body: str) -> None:
    path = folder / file_name(skill)
    path = path if path.exists() else folder / file_name(SEVERAL)
    weights = read_weights(path, body)
    told = {**weights.about.measured, **measured} if weights.about.skill == SEVERAL else measured
    save_weights(path, replace(weights, about=replace(weights.about, measured=told)), body)


def _parts(seeds: Sequence[int], processes: int) -> list[Sequence[int]]:
    size = -(-len(seeds) // processes)
    return [seeds[index : index + size] for index in range(0, len(seeds), size)]


def _try_part(
    job: tuple[str, int, Sequence[int]], *, folder: Path, cells: tuple[Cells, Cells], body: str
) -> list[Trial]:
    skill, where, seeds = job
    weights = None if str(folder) == SCRIPTED else weights_of(folder, skill, body)
    if weights is None and str(folder) != SCRIPTED:
        raise UsageError(f"{folder} has no weights for {skill!r}: no {file_name(skill)}, and none of several skills")
    return list(evaluate(skill, weights, seeds, cells[where], body=body))


def side_by_side(play: Callable[[Any], Any], jobs: Sequence[Any], processes: int) -> Iterator[Any]:
    """Jobs in order, in as many processes; in this one where one is enough."""
    if processes == 1:
        yield from map(play, jobs)
        return
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        yield from pool.map(play, jobs)
