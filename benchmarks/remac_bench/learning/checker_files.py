"""What checkers' cameras showed, with the truth, as files of NumPy arrays.

    station, wrist   (n, SIZE, SIZE, 3) uint8, the pictures of n robots at n moments
    view_facts    (n, 3): the seed, and numbers of texts: what the robot held ("" for nothing), the layout
    rows          (m, 7): number of the view; numbers of texts: predicate, first and second name ("" for none); then
                  1 or 0: true, shown, asked
    texts         the texts
    about         a text of JSON: version, seeds, layouts, styles, tasks
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remac_agents.vision.network import SIZE
from remac_bench.errors import UsageError
from remac_env.array_files import UNREADABLE
from remac_env.files import prepare_file

VERSION = 2

Pictures = NDArray[np.uint8]


@dataclass(frozen=True)
class Row:
    """A question about a view: predicate and names, and 1 or 0: true, shown by its pictures, asked by a method."""

    predicate: str
    names: tuple[str, ...]
    truth: bool
    shown: bool
    asked: bool


@dataclass(frozen=True, eq=False)
class Seen:
    """One robot's pictures at one moment, (SIZE, SIZE, 3) each, and every question about them."""

    station: Pictures
    wrist: Pictures
    held: str
    seed: int
    layout: str
    style: str
    task: str
    rows: tuple[Row, ...]


@dataclass(frozen=True, eq=False)
class Album:
    """Views as arrays, for training and measuring; see above. `seeds`, `layouts`, `styles`, `tasks`: of all of them."""

    station: Pictures
    wrist: Pictures
    view_facts: NDArray[np.int32]
    rows: NDArray[np.int32]
    texts: tuple[str, ...]
    seeds: tuple[int, ...]
    layouts: tuple[str, ...]
    styles: tuple[str, ...]
    tasks: tuple[str, ...]


def answers(album: Album) -> NDArray[np.int64]:
    """What is right of each row, as the number of one of ANSWERS."""
    true, shown = album.rows[:, 4], album.rows[:, 5]
    return np.where(shown == 1, np.where(true == 1, 0, 1), 2).astype(np.int64)


def write_album(path: Path, views: Sequence[Seen]) -> None:
    """Write views as a new file; a file that is there is replaced when the new one is whole."""
    texts: dict[str, int] = {"": 0}

    def number(text: str) -> int:
        return texts.setdefault(text, len(texts))

    facts = [[view.seed, number(view.held), number(view.layout)] for view in views]
    rows = [
        [index, number(row.predicate), *(number(name) for name in (*row.names, "", "")[:2]),
         row.truth, row.shown, row.asked]
        for index, view in enumerate(views) for row in view.rows
    ]  # fmt: skip
    told = {"version": VERSION, "seeds": sorted({view.seed for view in views})}
    told |= {f"{part}s": sorted({getattr(view, part) for view in views}) for part in ("layout", "style", "task")}
    fresh = prepare_file(path, "pictures").with_suffix(".part")
    with fresh.open("wb") as file:
        np.savez_compressed(
            file, station=np.array([view.station for view in views]), wrist=np.array([view.wrist for view in views]),
            view_facts=np.array(facts, np.int32), rows=np.array(rows, np.int32), texts=np.array(list(texts)),
            about=np.array(json.dumps(told)),
        )  # fmt: skip
    fresh.replace(path)


def albums(folder: Path) -> list[Path]:
    """The files of a folder, in order.

    Raises:
        UsageError: where there are none.
    """
    found = sorted(folder.glob("*.npz"))
    if not found:
        raise UsageError(f"{folder} has no pictures for a checker; record them: remac learn record-checker")
    return found


def read_albums(files: Iterable[Path]) -> Album:
    """All views of files together.

    Raises:
        UsageError: for a file of another version, or that is damaged.
    """
    parts, texts = [_read(path) for path in files], dict[str, int]()
    every: dict[str, list[NDArray[Any]]] = {name: [] for name in ("station", "wrist", "view_facts", "rows")}
    first = 0
    for part in parts:
        own = np.array([texts.setdefault(text, len(texts)) for text in part.texts], np.int32)
        told, asked = part.view_facts.copy(), part.rows.copy()
        told[:, 1:], asked[:, 1:4] = own[told[:, 1:]], own[asked[:, 1:4]]
        asked[:, 0] += first
        first += len(told)
        arrays: tuple[NDArray[Any], ...] = (part.station, part.wrist, told, asked)
        for name, array in zip(every, arrays, strict=True):
            every[name].append(array)
    spread = {name: tuple(sorted({each for part in parts for each in getattr(part, name)})) for name in _TOLD}
    whole = {name: np.concatenate(found) for name, found in every.items()}
    return Album(**whole, texts=tuple(texts), **spread)  # type: ignore[arg-type]


_TOLD = ("seeds", "layouts", "styles", "tasks")


def _read(path: Path) -> Album:
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays: dict[str, Any] = {name: file[name] for name in file.files}
        about = json.loads(str(arrays["about"]))
        if about["version"] != VERSION:
            raise UsageError(f"{path} has pictures of version {about['version']}, not {VERSION}: record it anew")
        if arrays["station"].shape[1:] != (SIZE, SIZE, 3) or arrays["station"].shape != arrays["wrist"].shape:
            raise UsageError(f"{path} has pictures of shape {arrays['station'].shape[1:]}; valid: {(SIZE, SIZE, 3)}")
        told = {name: tuple(about[name]) for name in _TOLD}
        texts = tuple(str(text) for text in arrays["texts"])
        return Album(arrays["station"], arrays["wrist"], arrays["view_facts"], arrays["rows"], texts, **told)
    except UNREADABLE as error:
        raise UsageError(f"{path} cannot be read: {error}") from error
