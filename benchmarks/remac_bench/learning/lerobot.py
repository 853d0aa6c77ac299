"""Demonstrations as a LeRobot dataset, version 3.0: parquet, and pictures as videos or in the tables.

A dataset grows by parts of some episodes each, one file of every kind, and is whole after each part: `meta/info.json`,
which says how much there is, is written last.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from remac_bench.errors import UsageError
from remac_bench.learning.demos import Demo, Pictures, check_body
from remac_bench.learning.lerobot_meta import (
    CHUNK,
    CODEBASE,
    FPS,
    LANGUAGE,
    NAMES,
    PICTURE,
    features,
    file,
    language_types,
    merged,
    persistent,
    pyarrow,
    statistics,
    texts,
)
from remac_env.backends.physics.controllers.learned.seen import VERSION
from remac_env.files import prepare_file
from remac_env.rendering.video import write_whole
from remac_env.robots import bodies
from remac_env.robots.bodies import STANDARD
from remac_env.simulator import load_opencv

_INFO, _OURS, _STATS = "meta/info.json", "meta/remac.json", "meta/stats.json"
_TOLD = ("skill", "target", "task", "seed", "style", "layout")
_MEGABYTES = {"data_files_size_in_mb": 100, "video_files_size_in_mb": 200}  # the format's own; our parts are smaller


class Dataset:
    """A dataset in a folder, new or to be gone on with.

    Args:
        folder: of the dataset.
        videos: pictures are kept as videos; else as PNG in the tables.
        language: also the columns that lerobot 0.6 and later read, and older ones cannot.
        body: the name of the robots'.

    Raises:
        UsageError: without pyarrow, or for a folder with something else in it.
    """

    def __init__(self, folder: Path, *, videos: bool = True, language: bool = True, body: str = STANDARD) -> None:
        pyarrow()
        self._body = {} if body == STANDARD else {"body": bodies.get(body).fingerprint}
        self._folder, self._videos, self._language = folder, videos, language
        self._parts: list[str] = []
        if (folder / _OURS).exists():
            there = _json(folder / _OURS)
            self._parts = there.pop("parts")
            if there != self._told():
                raise UsageError(f"{folder} was recorded with {there}, not {self._told()}; choose a new folder")
        elif folder.exists() and any(folder.iterdir()):
            raise UsageError(f"{folder} holds something else; choose a new folder, or one that this command has filled")

    def has(self, part: str) -> bool:
        """Whether a part of this name is there."""
        return part in self._parts

    def add(self, part: str, demos: Sequence[Demo]) -> None:
        """Add demonstrations as a part with a name.

        Raises:
            UsageError: for demonstrations that see something else than those that are there, as with pictures.
        """
        number, parquet = len(self._parts), pyarrow("pyarrow.parquet")
        told = features(demos[0], videos=self._videos, language=self._language)
        if number and _json(self._folder / _INFO)["features"] != told:
            raise UsageError(f"{self._folder} has other columns than these demonstrations; choose a new folder")
        before = self._episodes()
        kept = {kind: self._texts(kind, demos) for kind in ("task", "subtask")}
        frames, start = [], sum(each["length"] for each in before)
        for index, demo in enumerate(demos, start=len(before)):
            frames.append(self._frames(demo, index, start, kept))
            start += len(demo.actions)
        self._write(file("data", number), pyarrow().concat_tables(frames))
        for name in demos[0].pictures if self._videos else ():
            shown = (picture for demo in demos for picture in demo.pictures[name][:-1])
            write_whole(self._fresh(file(f"videos/{PICTURE}{name}", number, "mp4")), shown, fps=FPS)
        rows = self._rows(demos, before, number)
        self._write(file("meta/episodes", number), pyarrow().Table.from_pylist(rows))
        for kind, known in kept.items():
            parquet.write_table(texts(kind, known), self._fresh(f"meta/{kind}s.parquet"))
        self._save(_STATS, merged([*before, *rows]))
        self._parts.append(part)
        self._save(_OURS, self._told() | {"parts": self._parts})
        self._save(_INFO, self._info(told, [*before, *rows], len(kept["task"])))

    def _told(self) -> dict[str, Any]:
        """What all parts have in common."""
        return {"version": VERSION, "videos": self._videos, "language": self._language, **self._body}

    def _frames(self, demo: Demo, index: int, start: int, kept: dict[str, list[str]]) -> Any:
        """The table of an episode, a row for each control period."""
        library, length = pyarrow(), len(demo.actions)
        columns: dict[str, Any] = {}
        for name, array in NAMES.items():
            values = np.ascontiguousarray(getattr(demo, array)[:length], np.float32)
            columns[name] = library.array(values.reshape(-1))
            if values.ndim > 1:
                columns[name] = library.FixedSizeListArray.from_arrays(columns[name], values.shape[1])
        whole = np.arange(length)
        numbers = {"frame_index": whole, "index": start + whole, "episode_index": np.full(length, index)}
        numbers |= {f"{kind}_index": np.full(length, kept[kind].index(demo.command)) for kind in kept}
        columns |= {name: library.array(values.astype(np.int64)) for name, values in numbers.items()}
        columns["timestamp"] = library.array((whole / FPS).astype(np.float32))
        columns["next.done"] = library.array(whole == length - 1)
        if not self._videos:
            columns |= {PICTURE + name: _embedded(shown[:-1]) for name, shown in demo.pictures.items()}
        if self._language:
            for name, rows, kind in zip(LANGUAGE, (persistent(demo), []), language_types(), strict=True):
                columns[name] = library.array([rows] * length, kind)
        return library.table(columns)

    def _rows(self, demos: Sequence[Demo], before: Sequence[dict[str, Any]], number: int) -> list[dict[str, Any]]:
        """What is known of each episode: where it is, what it is about, and its statistics."""
        where = {"chunk_index": number // CHUNK, "file_index": number % CHUNK}
        start, rows, time = sum(each["length"] for each in before), [], 0.0
        for index, demo in enumerate(demos, start=len(before)):
            length = len(demo.actions)
            row = {"episode_index": index, "tasks": [demo.command], "length": length}
            row |= {"dataset_from_index": start, "dataset_to_index": start + length}
            row |= {f"{kind}/{name}": value for kind in ("data", "meta/episodes") for name, value in where.items()}
            for name in demo.pictures if self._videos else ():
                seen = where | {"from_timestamp": time, "to_timestamp": time + length / FPS}
                row |= {f"videos/{PICTURE}{name}/{what}": value for what, value in seen.items()}
            row |= {f"remac.{name}": getattr(demo, name) for name in (*_TOLD, "case")}
            row |= {"remac.before": list(demo.before)}
            stats = statistics(demo)
            row |= {f"stats/{name}/{what}": value for name, told in stats.items() for what, value in told.items()}
            rows.append(row)
            start, time = start + length, time + length / FPS
        return rows

    def _info(self, told: dict[str, Any], episodes: Sequence[dict[str, Any]], tasks: int) -> dict[str, Any]:
        shown = any(each["dtype"] == "video" for each in told.values())
        return {
            "codebase_version": CODEBASE, "robot_type": "panda_mobile", "total_episodes": len(episodes),
            "total_frames": sum(each["length"] for each in episodes), "total_tasks": tasks, "chunks_size": CHUNK,
            **_MEGABYTES, "fps": FPS, "splits": {"train": f"0:{len(episodes)}"},
            "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
            "video_path": "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4" if shown else None,
            "features": told,
        }  # fmt: skip

    def _episodes(self) -> list[dict[str, Any]]:
        """The rows of the parts that are whole."""
        return [row for number in range(len(self._parts)) for row in _rows(self._folder, number)]

    def _texts(self, kind: str, demos: Sequence[Demo]) -> list[str]:
        """What is known of texts, with those of the demonstrations added."""
        path = self._folder / f"meta/{kind}s.parquet"
        known = pyarrow("pyarrow.parquet").read_table(path)[kind].to_pylist() if self._parts else []
        return list(dict.fromkeys([*known, *(demo.command for demo in demos)]))

    def _write(self, name: str, table: Any) -> None:
        pyarrow("pyarrow.parquet").write_table(table, self._fresh(name))

    def _save(self, name: str, told: Any) -> None:
        path = self._fresh(name)
        fresh = path.with_suffix(".part")
        fresh.write_text(json.dumps(told, indent=4), "utf-8")
        fresh.replace(path)

    def _fresh(self, name: str) -> Path:
        return prepare_file(self._folder / name, "demonstrations")


def is_dataset(folder: Path) -> bool:
    """Whether a folder holds a dataset of this command's."""
    return (folder / _OURS).exists()


def read_dataset(folder: Path, skill: str, body: str = STANDARD) -> Iterator[Demo]:
    """The demonstrations of a skill in a dataset, without states, the last observation, and pictures.

    Args:
        body: the name of the body that they have to be of.

    Raises:
        UsageError: for a dataset of another version of observations or another body, or that is damaged.
    """
    try:
        ours, parquet = _json(folder / _OURS), pyarrow("pyarrow.parquet")
        if ours["version"] != VERSION:
            raise UsageError(f"{folder} has observations of version {ours['version']}, not {VERSION}: record it anew")
        check_body(folder, body, str(ours.get("body", bodies.get().fingerprint)))
        for number in range(len(ours["parts"])):
            rows = [row for row in _rows(folder, number) if row["remac.skill"] == skill]
            if not rows:
                continue
            table = parquet.read_table(folder / file("data", number), columns=["index", *NAMES])
            first = table["index"][0].as_py()
            for row in rows:
                yield _read(table.slice(row["dataset_from_index"] - first, row["length"]), row, body)
    except (OSError, KeyError, ValueError, IndexError) as error:
        raise UsageError(f"{folder} cannot be read: {error}") from error


def _rows(folder: Path, number: int) -> list[dict[str, Any]]:
    table = pyarrow("pyarrow.parquet").read_table(folder / file("meta/episodes", number))
    rows: list[dict[str, Any]] = table.to_pylist()
    return rows


def _read(table: Any, row: dict[str, Any], body: str) -> Demo:
    arrays: dict[str, Any] = {}
    for name, array in NAMES.items():
        column = table[name].combine_chunks()
        flat = column.flatten() if hasattr(column, "flatten") and column.type != pyarrow().float32() else column
        arrays[array] = np.array(flat, np.float32).reshape(len(table), -1)
    arrays["rewards"] = arrays["rewards"][:, 0]
    told = {name: row[f"remac.{name}"] for name in _TOLD}
    told |= {"before": tuple(row["remac.before"]), "case": row.get("remac.case") or ""}
    return Demo(**arrays, states=np.zeros((len(table), 0), np.float32), body=body, **told)


def _embedded(shown: Pictures) -> Any:
    """Pictures as PNG files in a column, as the library `datasets` keeps them."""
    library, cv2 = pyarrow(), load_opencv()
    found = [{"bytes": cv2.imencode(".png", each[..., ::-1])[1].tobytes(), "path": None} for each in shown]
    return library.array(found, library.struct([("bytes", library.binary()), ("path", library.string())]))


def _json(path: Path) -> Any:
    return json.loads(path.read_text("utf-8"))
