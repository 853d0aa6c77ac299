"""`remac learn`: record demonstrations of skills, train networks on them, and measure what they learnt."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from remac_bench.columns import show
from remac_bench.command import Command, joined
from remac_bench.console import say
from remac_bench.errors import UsageError
from remac_bench.flags import takes

if TYPE_CHECKING:
    from remac_bench.learning.evaluate import Score

Folders = Annotated[list[str], typer.Argument(help="The --out of runs.")]

app = typer.Typer(no_args_is_help=True, help="Learned skills: record demonstrations, train on them, measure.")


@app.command(cls=Command)
@takes(
    *("learn.skills", "learn.target", "learn.case", "learn.led_by", "style", "layout", "body"),
    *("learn.episodes", "learn.first_seed", "learn.cells", "learn.held_out", "learn.disturb", "learn.format"),
    *("learn.pictures", "learn.image_size", "learn.wordless", "learn.out", "learn.processes"),
)
def record(
    *, skills: list[str] | None, target: str | None, case: str | None, led_by: Path | None, style: str | None,
    layout: str | None, body: str, episodes: int, first_seed: int, cells: str, held_out: list[str] | None,
    disturb: float, format: str,  # noqa: A002 - the flag
    pictures: str, image_size: int, wordless: bool, out: Path, processes: int,
) -> None:
    """Record what the scripted controllers do, with disturbed servos: HDF5 in robomimic's layout, or a LeRobot dataset.

    Parts hold 40 episodes each, 5 with pictures, less those that failed; one that is there is not recorded again.
    --style, --layout, --target and --case narrow what is recorded, where something is rare.
    """
    from remac_bench.learning.cells import cells as choose
    from remac_bench.learning.demos import h5py
    from remac_bench.learning.lerobot import Dataset
    from remac_bench.learning.record import Recorder
    from remac_bench.learning.sessions import record_all, record_dataset
    from remac_env.rules.skills import SKILLS

    if format == "hdf5" and pictures == "videos":
        raise UsageError("--pictures videos: HDF5 keeps images; valid: images, or --format lerobot")
    chosen = _skills(skills)
    if led_by is not None and (others := [name for name in chosen if not (SKILLS[name].takes or SKILLS[name].puts)]):
        raise UsageError(f"--led-by: {', '.join(others)} cannot be taken over midway; valid: skills that take or put")
    seen, _ = choose(cells, _names(held_out, "--hold-out"))
    where = (chosen, range(first_seed, first_seed + episodes), seen.narrowed(style, layout))
    make = partial(
        Recorder, target=target, case=case, led_by=led_by, disturb=disturb, body=body,
        image_size=None if pictures == "none" else image_size,
    )
    if format == "hdf5":
        h5py()
        lines = record_all(*where, out, make, processes=processes)
    else:
        dataset = Dataset(out, videos=pictures != "images", language=not wordless, body=body)
        lines = record_dataset(*where, dataset, make, processes=processes)
    for line in lines:
        say(line)


@app.command(cls=Command)
@takes(
    *("learn.skills", "learn.demos", "learn.weights", "learn.together", "learn.epochs", "learn.width", "learn.chunk"),
    *("learn.execute", "learn.hand", "body"),
)
def train(
    *, skills: list[str] | None, demos: Path, weights: Path, together: bool, epochs: int, width: int, chunk: int,
    execute: int, hand: bool, body: str,
) -> None:
    """Train a network for each skill on what was recorded, with torch, on a GPU where there is one."""
    from remac_bench.learning.demos import h5py
    from remac_bench.learning.lerobot import is_dataset
    from remac_bench.learning.sessions import train_skill, train_together
    from remac_bench.learning.train import Recipe, check_sizes, torch

    if not is_dataset(demos):
        h5py()
    torch()
    recipe = Recipe(epochs=epochs, width=width, chunk=chunk, execute=execute, hand=hand)
    check_sizes(recipe)
    chosen = _skills(skills)
    every = (train_skill(skill, demos, weights, recipe, body) for skill in chosen)
    for line in train_together(chosen, demos, weights, recipe, body) if together else chain.from_iterable(every):
        say(line)


@app.command(cls=Command)
@takes(
    *("learn.skills", "learn.weights", "learn.trials", "learn.tried_from", "learn.cells", "learn.held_out"),
    *("learn.note", "body", "learn.processes"),
)
def evaluate(
    *, skills: list[str] | None, weights: Path, trials: int, tried_from: int, cells: str,
    held_out: list[str] | None, note: bool, body: str, processes: int,
) -> None:
    """Measure skills on unseen seeds: in layouts and styles of the demonstrations, and in those held out.

    --weights scripted measures the scripted controllers.
    """
    from remac_bench.learning.cells import cells as choose
    from remac_bench.learning.sessions import evaluate_all

    chosen = choose(cells, _names(held_out, "--hold-out"))
    seeds = range(tried_from, tried_from + trials)
    scores = evaluate_all(_skills(skills), weights, seeds, chosen, note=note, processes=processes, body=body)
    show(_table(scores))


@app.command("record-checker", cls=Command)
@takes(
    *("learn.episodes", "learn.first_seed", "learn.cells", "learn.held_out", "learn.held_kitchens"),
    *("learn.pictures_backend", "learn.pictures_out", "learn.processes"),
)
def record_checker(
    *, episodes: int, first_seed: int, cells: str, held_out: list[str] | None, held_kitchens: bool,
    pictures_backend: str, pictures_out: Path, processes: int,
) -> None:
    """Record what a checker's cameras show, with the truth of every condition that could be asked about it.

    Files hold 4 episodes each; one that is there is not recorded again.
    """
    from remac_bench.learning.cells import cells as choose
    from remac_bench.learning.checker_sessions import record_pictures

    chosen = choose(cells, _names(held_out, "--hold-out"))[held_kitchens]
    seeds = range(first_seed, first_seed + episodes)
    for line in record_pictures(
        seeds, chosen, pictures_out, backend=pictures_backend, processes=processes, paints=not held_kitchens
    ):
        say(line)


@app.command("train-checker", cls=Command)
@takes("learn.albums", "learn.checker_out", "learn.checker_epochs")
def train_checker(*, albums: Path, checker_out: Path, checker_epochs: int) -> None:
    """Train a checker that sees, with torch: on the folder train, calibrated on calibrate and measured on test."""
    from remac_bench.learning.checker_sessions import train_checker as train_on
    from remac_bench.learning.checker_train import Recipe
    from remac_bench.learning.train import torch

    torch()
    for line in train_on(albums, checker_out, Recipe(epochs=checker_epochs)):
        say(line)


@app.command("evaluate-checker", cls=Command)
@takes("learn.albums", "learn.checker", "learn.asked", "learn.note")
def evaluate_checker(*, albums: Path, checker: Path | None, asked: bool, note: bool) -> None:
    """Measure a checker that sees on pictures it never learnt from: precision, recall and what it cannot tell."""
    from remac_agents.vision.weights import SHIPPED
    from remac_bench.learning.checker_sessions import evaluate_checker as measured
    from remac_bench.learning.checker_sessions import note_measured

    weights = SHIPPED if checker is None else checker
    found, album = measured(weights, albums, asked_only=asked)
    show(_checker_table(found))
    say(
        f"{len(album.station)} views of {len(album.seeds)} episodes; layouts {', '.join(album.layouts)}; "
        f"styles {', '.join(album.styles)}"
    )
    if note:
        note_measured(weights, found)


@app.command(cls=Command)
@takes("learn.chats", "learn.roles", "learn.successful")
def chats(folders: Folders, *, chats: Path, roles: list[str] | None, successful: bool) -> None:
    """Write what language models were asked and answered in runs as JSON lines, for fine-tuning."""
    from remac_bench.learning.chats import chats as conversations
    from remac_bench.learning.chats import write_chats
    from remac_bench.report import read_records

    records = [record for folder in folders for record in read_records(folder)]
    count = write_chats(chats, conversations(records, roles=_names(roles, "--roles"), successful=successful))
    typer.echo(f"{chats}: {count} conversations")


def _skills(given: list[str] | None) -> list[str]:
    """The skills by their names in the table.

    Raises:
        UnknownNameError: for one that is not among them; it lists them.
    """
    from remac_env.lowlevel.names import skill_named, skills

    wanted = _names(given, "--skills")
    if not wanted or wanted == ["all"]:
        return [row.name for row in skills().values()]
    return [skill_named(name).name for name in wanted]


def _names(given: list[str] | None, flag: str) -> list[str]:
    text = joined(given, flag)
    return [name.strip() for name in (text or "").split(",") if name.strip()]


def _table(scores: list[Score]) -> Any:
    from rich import box
    from rich.table import Table

    table = Table(box=box.MARKDOWN)
    for name in ("skill", "tried in", "successes", "95%", "s", "failures"):
        table.add_column(name, justify="right" if name in ("successes", "95%", "s") else "left")
    for score in scores:
        low, high = score.interval
        why = ", ".join(f"{reason} {count}" for reason, count in score.reasons)
        name, _, where = score.name.partition(": ")
        table.add_row(
            name, where, f"{score.successes} of {score.trials}", f"{100 * low:.0f}-{100 * high:.0f}%",
            f"{score.seconds:.1f}", why,
        )  # fmt: skip
    return table


def _checker_table(found: Mapping[str, Mapping[str, float]]) -> Any:
    """Predicate by predicate, and all together."""
    from rich import box
    from rich.table import Table

    table = Table(box=box.MARKDOWN)
    columns = ["condition", "n", "true: precision", "true: recall", "false: precision", "false: recall", "cannot tell"]
    for index, name in enumerate([*columns, "hidden", "said"]):
        table.add_column(name, justify="right" if index else "left")
    total = {name: sum(row[name] for row in found.values()) for name in next(iter(found.values()), {})}
    for name, row in {**found, "all": total}.items():
        if not row:
            continue
        shown = row["true"] + row["false"]
        said = sum(row[f"{how} {answer}"] for how in ("right", "wrong") for answer in ("true", "false"))
        table.add_row(
            name, f"{shown:.0f}", *(
                text for answer in ("true", "false")
                for text in (
                    _share(row[f"right {answer}"], row[f"right {answer}"] + row[f"wrong {answer}"]),
                    _share(row[f"right {answer}"], row[answer]),
                )
            ),
            _share(shown - said, shown), f"{row['hidden']:.0f}", _share(row["hidden told"], row["hidden"]),
        )  # fmt: skip
    return table


def _share(part: float, whole: float) -> str:
    return f"{100 * part / whole:.1f}%" if whole else "-"
