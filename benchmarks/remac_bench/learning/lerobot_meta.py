"""What a LeRobot dataset says of itself: features, statistics, and tables of texts. Version 3.0 of the format.

The layout is that of `LeRobotDatasetMetadata` in lerobot 0.4 and later, and the language columns are those of
`lerobot.datasets.language` in lerobot 0.6.
"""

from __future__ import annotations

import importlib
import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remac_bench.errors import UsageError
from remac_bench.learning.demos import Demo
from remac_env.backends.physics.controllers.learned.seen import entries
from remac_env.backends.physics.simulation import CONTROL_PERIOD
from remac_env.lowlevel.control import Joints
from remac_env.robots import bodies
from remac_env.rules.skills import SKILLS

CODEBASE = "v3.0"
FPS = round(1.0 / CONTROL_PERIOD)
CHUNK = 1000  # files a folder
QUANTILES = (0.01, 0.10, 0.50, 0.90, 0.99)
PICTURE = "observation.images."
_SHOWN_EVERY = 20  # pictures of which one counts in statistics

LANGUAGE = ("language_persistent", "language_events")
"""Columns that lerobot 0.6 and later read."""

NAMES = {
    "observation.state": "observations", "action": "actions", "next.reward": "rewards", "remac.commands": "commands",
    "remac.measured": "measured",
}  # fmt: skip
"""Numbers of a dataset: column -> array of a demonstration."""


def pyarrow(part: str = "pyarrow") -> Any:
    """The library for parquet, or a part of it.

    Raises:
        UsageError: where it is not installed; it says how to install it.
    """
    try:
        return importlib.import_module(part)
    except ImportError as error:
        raise UsageError(
            "LeRobot's format needs pyarrow; install it: pip install 'remac-kitchen[lerobot]'"
        ) from error


def file(kind: str, part: int, ending: str = "parquet") -> str:
    """Where a part of a dataset is kept."""
    return f"{kind}/chunk-{part // CHUNK:03d}/file-{part % CHUNK:03d}.{ending}"


def features(demo: Demo, *, videos: bool, language: bool) -> dict[str, dict[str, Any]]:
    """The columns of a dataset, as `meta/info.json` lists them."""
    seen = [entry.name for entry in entries(SKILLS[demo.skill], demo.body)]
    moved = [entry.name for entry in Joints(bodies.get(demo.body)).names]
    names = {"observation.state": seen, "action": moved, "next.reward": None}
    found: dict[str, dict[str, Any]] = {
        column: {"dtype": "float32", "shape": _shape(demo, array), "names": names.get(column)}
        for column, array in NAMES.items()
    }
    found["next.done"] = {"dtype": "bool", "shape": [1], "names": None}
    for name in ("frame_index", "episode_index", "index", "task_index", "subtask_index"):
        found[name] = {"dtype": "int64", "shape": [1], "names": None}
    found["timestamp"] = {"dtype": "float32", "shape": [1], "names": None}
    for name, shown in demo.pictures.items():
        found[PICTURE + name] = _picture(shown.shape[1:], videos=videos)
    if language:
        found |= {name: {"dtype": "language", "shape": [1], "names": None} for name in LANGUAGE}
    return found


def _shape(demo: Demo, array: str) -> list[int]:
    values = getattr(demo, array)
    return [values.shape[1] if values.ndim > 1 else 1]


def _picture(shape: Sequence[int], *, videos: bool) -> dict[str, Any]:
    told: dict[str, Any] = {"dtype": "image", "shape": list(shape), "names": ["height", "width", "channels"]}
    if videos:
        told["dtype"] = "video"
        height, width, channels = shape
        told["info"] = {
            "video.height": height, "video.width": width, "video.codec": "vp9", "video.pix_fmt": "yuv420p",
            "video.is_depth_map": False, "video.fps": FPS, "video.channels": channels, "has_audio": False,
        }  # fmt: skip
    return told


def persistent(demo: Demo) -> list[dict[str, Any]]:
    """What can be said of a demonstration, and from when on: rows of the column `language_persistent`.

    The subtask; the plan to which it belongs, a line a step; and what the robot remembers to have done, which changes
    where the skill has succeeded.
    """
    steps = [*demo.before, demo.command]
    plan = "\n".join(f"{number}. {step}" for number, step in enumerate(steps, start=1))
    succeeded = float(np.argmax(demo.rewards > 0.0)) / FPS
    rows = [("subtask", demo.command, 0.0), ("plan", plan, 0.0)]
    rows += [("memory", _done(steps[:-1]), 0.0), ("memory", _done(steps), succeeded)]
    nothing = {"camera": None, "tool_calls": None}
    return [
        {"role": "assistant", "content": text, "style": style, "timestamp": time, **nothing}
        for style, text, time in rows
    ]


def _done(steps: Sequence[str]) -> str:
    return f"Done: {', '.join(steps) or 'nothing'}."


def language_types() -> tuple[Any, Any]:
    """The arrow types of the language columns; calls of tools, of which there are none, as texts of JSON."""
    library = pyarrow()
    text, calls = library.string(), library.list_(library.string())
    rows = [("role", text, False), ("content", text, True), ("style", text, True), ("camera", text, True)]
    rows += [("tool_calls", calls, True)]
    fields = [library.field(name, kind, nullable=empty) for name, kind, empty in rows]
    when = library.field("timestamp", library.float32(), nullable=False)
    return (
        library.list_(library.struct([*fields[:3], when, *fields[3:]])), library.list_(library.struct(fields)),
    )  # fmt: skip


def statistics(demo: Demo) -> dict[str, dict[str, Any]]:
    """Of one episode: column -> what -> a number for each dimension; of pictures for each channel, from 0 to 1."""
    length = len(demo.actions)
    columns: dict[str, NDArray[Any]] = {
        name: np.asarray(getattr(demo, array)[:length], float).reshape(length, -1) for name, array in NAMES.items()
    }
    found = {name: _of(values) for name, values in columns.items()}
    for name, shown in demo.pictures.items():
        pixels = shown[:length:_SHOWN_EVERY].reshape(-1, shown.shape[-1]) / 255.0
        told = _of(pixels, len(shown[:length:_SHOWN_EVERY]))
        found[PICTURE + name] = {
            what: value if what == "count" else [[[each]] for each in value] for what, value in told.items()
        }
    return found


def _of(values: NDArray[Any], count: int | None = None) -> dict[str, Any]:
    told = {"min": values.min(0), "max": values.max(0), "mean": values.mean(0), "std": values.std(0)}
    told |= {f"q{round(100 * part):02d}": np.quantile(values, part, axis=0) for part in QUANTILES}
    return {name: value.tolist() for name, value in told.items()} | {"count": [count or len(values)]}


def merged(episodes: Sequence[Mapping[str, Any]]) -> dict[str, dict[str, Any]]:
    """Statistics of all episodes, from each one's "stats/COLUMN/WHAT". Quantiles are means of theirs, as LeRobot's."""
    found: dict[str, dict[str, Any]] = {}
    keys = [key.split("/") for key in episodes[0] if key.startswith("stats/")]
    for column in dict.fromkeys(key[1] for key in keys):
        told = {
            what: np.array([each[f"stats/{column}/{what}"] for each in episodes])
            for _, name, what in keys
            if name == column
        }
        count = told.pop("count").reshape(-1)
        share = count / count.sum()
        mean = np.tensordot(share, told["mean"], 1)
        spread = np.tensordot(share, told["std"] ** 2 + (told["mean"] - mean) ** 2, 1)
        values = {name: np.tensordot(share, value, 1) for name, value in told.items()}
        values |= {"min": told["min"].min(0), "max": told["max"].max(0), "mean": mean, "std": np.sqrt(spread)}
        found[column] = {name: value.tolist() for name, value in values.items()} | {"count": [int(count.sum())]}
    return found


def texts(kind: str, known: Sequence[str]) -> Any:
    """A table of texts and their numbers, as pandas writes a frame whose index the texts are."""
    library = pyarrow()
    table = library.table({f"{kind}_index": list(range(len(known))), kind: list(known)})
    columns = [
        {"name": name, "field_name": name, "pandas_type": as_pandas, "numpy_type": as_numpy, "metadata": None}
        for name, as_pandas, as_numpy in ((f"{kind}_index", "int64", "int64"), (kind, "unicode", "object"))
    ]
    told = {"index_columns": [kind], "column_indexes": [], "columns": columns, "pandas_version": "2.0.0"}
    return table.replace_schema_metadata({b"pandas": json.dumps(told).encode()})
