"""What the commands about the checker that sees do: record its pictures, train it, measure it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from remac_agents.vision import network as player
from remac_agents.vision.weights import About, Weights, read_weights, save_weights
from remac_bench.errors import UsageError
from remac_bench.learning.cells import Cells
from remac_bench.learning.checker_files import Album, albums, read_albums, write_album
from remac_bench.learning.checker_measure import judge, least, measure, warmth
from remac_bench.learning.checker_record import BACKENDS, record
from remac_bench.learning.checker_train import Recipe, common_in, train
from remac_bench.learning.demos import file_digest
from remac_bench.learning.sessions import side_by_side
from remac_env.errors import check_choice
from remac_env.seeding import digest

SHARD = 4
"""Episodes a file: what is lost at most where recording is killed."""

PARTS = ("train", "calibrate", "test")
"""The folders of pictures: to learn from, to find out from when on the network is sure, and to measure it."""

_SAMPLE = 2  # views that weights keep, with what the network says about them
_TOLD = ("layouts", "styles", "tasks")
_SAMPLED = 24  # questions about them


def record_pictures(
    seeds: Sequence[int], cells: Cells, out: Path, *, backend: str, processes: int, paints: bool = False
) -> Iterator[str]:
    """Record these episodes, a file for each SHARD of them; a line for each that is done.

    paints: whether kitchens may be painted as no style has them.
    """
    check_choice("backend", backend, BACKENDS)
    parts = [seeds[index : index + SHARD] for index in range(0, len(seeds), SHARD)]
    jobs = [(part, out / f"{backend}_{part[0]:06d}.npz") for part in parts]
    yield from (f"{path.name}: there already" for _, path in jobs if path.exists())
    fresh = [job for job in jobs if not job[1].exists()]
    yield from side_by_side(partial(_record_part, cells=cells, backend=backend, paints=paints), fresh, processes)


def _record_part(job: tuple[Sequence[int], Path], *, cells: Cells, backend: str, paints: bool) -> str:
    seeds, path = job
    views = list(record(seeds, cells, backend=backend, paints=paints))
    if not views:
        raise UsageError(f"none of the seeds {seeds[0]}..{seeds[-1]} has a kitchen; valid: other layouts or seeds")
    write_album(path, views)
    return f"{path.name}: {len(views)} views, {sum(len(view.rows) for view in views)} questions"


def train_checker(folder: Path, out: Path, recipe: Recipe) -> Iterator[str]:
    """Train on `train`, calibrate on `calibrate` and measure on `test`, folders of pictures; lines on how it goes.

    Raises:
        UsageError: where pictures are missing, parts share episodes, or what it needs is not installed.
    """
    files = {part: albums(folder / part) for part in PARTS}
    parts = {part: read_albums(found) for part, found in files.items()}
    _check_apart(parts)
    sizes = {part: (len(album.station), len(album.seeds)) for part, album in parts.items()}
    yield "; ".join(f"{part}: {views} views of {episodes} episodes" for part, (views, episodes) in sizes.items())
    losses: list[float] = []
    network = train(parts["train"], recipe, report=lambda epoch, loss: losses.append(loss))
    tuned, common = judge(network, parts["calibrate"]), common_in(parts["train"])
    temperature = warmth(tuned)
    levels = least(tuned, temperature, common)
    told: dict[str, Any] = {name: {part: getattr(album, name) for part, album in parts.items()} for name in _TOLD}
    about = About(
        predicates=network.words.predicates, words=network.words.words, common=common, temperature=temperature,
        least=levels,
        sample=_questions(parts["train"], network.words), views=len(parts["train"].station),
        seeds={part: spans(album.seeds) for part, album in parts.items()},
        **told,
        data=file_digest(path for found in files.values() for path in found), code=code_digest(),
    )  # fmt: skip
    about = replace(about, measured=measure(judge(network, parts["test"]), about))
    album = parts["train"]
    sample = tuple((album.station[index], album.wrist[index]) for index in range(min(_SAMPLE, len(album.station))))
    save_weights(out, Weights(about=about, network=network, sample=sample))
    how = f"loss {losses[0]:.3f} to {losses[-1]:.3f} in {len(losses)} epochs, temperature {temperature:.2f}"
    yield f"{how}; {out}, {out.stat().st_size / 1000:.0f} kB"


def evaluate_checker(
    weights: Path, folder: Path, *, asked_only: bool
) -> tuple[dict[str, dict[str, float]], Album]:
    """How a checker judges the pictures of a folder, by predicate.

    Raises:
        UsageError: where it has learnt from these episodes.
        OptionError: for weights that cannot be used.
    """
    known = read_weights(weights)
    album = read_albums(albums(folder))
    shared = {part for part in PARTS[:2] for seed in album.seeds if _within(known.about.seeds.get(part, ""), seed)}
    if shared:
        raise UsageError(f"{folder} has episodes from which {weights} was made ({', '.join(sorted(shared))})")
    judged = judge(known.network, album)
    return measure(judged, known.about, asked_only=asked_only), album


def note_measured(weights: Path, measured: Mapping[str, Mapping[str, float]]) -> None:
    """Write into weights how they did."""
    known = read_weights(weights)
    save_weights(weights, replace(known, about=replace(known.about, measured=measured)))


def spans(seeds: Iterable[int]) -> str:
    """Whole numbers as text: "3:5,9:10" are 3, 4 and 9."""
    found: list[list[int]] = []
    for seed in sorted(seeds):
        if found and found[-1][1] == seed:
            found[-1][1] += 1
        else:
            found.append([seed, seed + 1])
    return ",".join(f"{first}:{last}" for first, last in found)


def _within(text: str, seed: int) -> bool:
    ends = [span.split(":") for span in text.split(",") if span]
    return any(int(first) <= seed < int(last) for first, last in ends)


def _check_apart(parts: Mapping[str, Album]) -> None:
    for one in PARTS:
        for other in PARTS:
            both = sorted(set(parts[one].seeds) & set(parts[other].seeds)) if one < other else []
            if both:
                raise UsageError(f"{one} and {other} have the same episodes: {spans(both)}; valid: seeds of their own")


def _questions(album: Album, words: player.Words) -> tuple[tuple[str, ...], ...]:
    """Questions of the first view, evenly spread."""
    own = album.rows[album.rows[:, 0] == 0]
    texts = [[album.texts[number] for number in row[1:4] if album.texts[number]] for row in own]
    return tuple(tuple(text) for text in texts[:: max(1, len(texts) // _SAMPLED)][:_SAMPLED])


def code_digest() -> str:
    """A name for the code that decides what is learnt: recording, labels, training and the network's player."""
    here, played = Path(__file__).parent, Path(player.__file__).parent
    files = [here / f"checker_{name}.py" for name in ("record", "scenes", "poses", "paint", "train", "measure")]
    return digest([path.read_text("utf-8") for path in (*files, played / "network.py", played / "questions.py")])
