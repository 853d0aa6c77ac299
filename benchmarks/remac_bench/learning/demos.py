"""Demonstrations, and their files: HDF5 in robomimic's layout, with what our own training needs beside it."""

from __future__ import annotations

import hashlib
import importlib
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remac_bench.errors import UsageError
from remac_env.backends.physics.controllers.learned.seen import VERSION
from remac_env.files import prepare_file
from remac_env.lowlevel.names import camel
from remac_env.robots import bodies
from remac_env.robots.bodies import STANDARD
from remac_env.rules.subtasks import Subtask

Numbers = NDArray[np.float32]
Pictures = NDArray[np.uint8]
_VALID = 10  # one demonstration in so many is for validation
_IMAGE = "_image"  # how robomimic's names of pictures end
_GYM = 2  # what robomimic calls environments that gymnasium.make makes


@dataclass(frozen=True, kw_only=True, eq=False)
class Demo:
    """One subtask, carried out with success; arrays of T control periods.

    Attributes:
        observations: (T + 1, n), as `entries(skill)` lists them; the last one is what came of it.
        actions: (T, j + 1) with j joints, of the environment with control="joints": what the controller wanted, not
            what the disturbed servos were told.
        commands: (T, j + 1), the joints that it wanted, relative to the stand, and the fingers' travel, m.
        measured: (T, j), the joints as they were, relative to the stand.
        states: (T, nq + nv), positions and velocities of the simulation.
        rewards: (T,), 1 from where the skill has succeeded.
        skill, target, task, seed, style, layout: which subtask in which kitchen.
        before: what the robot had done there already, as commands.
        case: which object is handled where, see `case_of`; "" for other skills.
        body: the name of the robot's.
        pictures: camera -> (T + 1, height, width, 3), where pictures were recorded.
    """

    observations: Numbers
    actions: Numbers
    commands: Numbers
    measured: Numbers
    states: Numbers
    rewards: Numbers
    skill: str
    target: str
    task: str
    seed: int
    style: str
    layout: str
    before: tuple[str, ...] = ()
    case: str = ""
    body: str = STANDARD
    pictures: Mapping[str, Pictures] = field(default_factory=dict)

    @property
    def command(self) -> str:
        """The subtask as text."""
        return Subtask(self.skill, self.target).text


_TOLD = ("skill", "target", "task", "seed", "style", "layout")


def h5py() -> Any:
    """The library for HDF5.

    Raises:
        UsageError: where it is not installed; it says how to install it.
    """
    try:
        return importlib.import_module("h5py")
    except ImportError as error:
        raise UsageError("demonstrations need h5py; install it: pip install 'remac-kitchen[learn]'") from error


def write_shard(path: Path, demos: Sequence[Demo]) -> None:
    """Write demonstrations of one skill as a new file; a file that is there is replaced when the new one is whole."""
    library, skill = h5py(), demos[0].skill
    fresh = prepare_file(path, "demonstrations").with_suffix(".part")
    with library.File(fresh, "w") as file:
        group = file.create_group("data")
        options = {"control": "joints"} | ({} if demos[0].body == STANDARD else {"body": demos[0].body})
        made = {"env_name": f"RemacSkill-{camel(skill)}-v0", "type": _GYM, "env_kwargs": options}
        group.attrs.update(env_args=json.dumps(made), total=sum(len(demo.actions) for demo in demos), version=VERSION)
        group.attrs["body"] = bodies.get(demos[0].body).fingerprint
        for number, demo in enumerate(demos):
            _write(group.create_group(f"demo_{number}"), demo)
        names, kept = [f"demo_{number}" for number in range(len(demos))], len(demos) - len(demos) // _VALID
        for mask, chosen in (("train", names[:kept]), ("valid", names[kept:])):
            file.create_dataset(f"mask/{mask}", data=np.array(chosen, dtype="S16"))
    fresh.replace(path)


def _write(group: Any, demo: Demo) -> None:
    told = {name: getattr(demo, name) for name in _TOLD} | {"before": json.dumps(demo.before), "case": demo.case}
    group.attrs.update(num_samples=len(demo.actions), **told)
    done = np.zeros(len(demo.actions), np.int64)
    done[-1] = 1
    arrays: dict[str, NDArray[Any]] = {
        "actions": demo.actions, "rewards": demo.rewards, "dones": done, "states": demo.states,
        "obs/state": demo.observations[:-1], "next_obs/state": demo.observations[1:],
        "remac/commands": demo.commands, "remac/measured": demo.measured,
    }  # fmt: skip
    for name, shown in demo.pictures.items():
        arrays |= {f"obs/{name}{_IMAGE}": shown[:-1], f"next_obs/{name}{_IMAGE}": shown[1:]}
    for name, values in arrays.items():
        group.create_dataset(name, data=values, compression="lzf" if values.ndim > 1 else None)


def shards(folder: Path, skill: str) -> list[Path]:
    """The files of a folder that hold demonstrations of a skill, in order.

    Raises:
        UsageError: where there are none.
    """
    found = sorted(folder.glob(f"{camel(skill)}_*.hdf5"))
    if not found:
        raise UsageError(f"{folder} has no demonstrations of {skill!r}; record them: remac learn record")
    return found


def read_demos(files: Iterable[Path], body: str = STANDARD) -> Iterator[Demo]:
    """The demonstrations of files, in order.

    Args:
        body: the name of the body that they have to be of.

    Raises:
        UsageError: for a file of another version of observations or another body, or that is damaged.
    """
    library = h5py()
    for path in files:
        try:
            with library.File(path, "r") as file:
                version = int(file["data"].attrs["version"])
                if version != VERSION:
                    raise UsageError(f"{path} has observations of version {version}, not {VERSION}: record it anew")
                check_body(path, body, str(file["data"].attrs.get("body", bodies.get().fingerprint)))
                for name in sorted(file["data"], key=lambda key: int(key.rpartition("_")[2])):
                    yield _read(file["data"][name], body)
        except (OSError, KeyError, ValueError) as error:
            raise UsageError(f"{path} cannot be read: {error}") from error


def check_body(path: Path, body: str, fingerprint: str) -> None:
    """Refuse demonstrations of another body: of another number of joints, or another reach."""
    if fingerprint != bodies.get(body).fingerprint:
        told = next((name for name in bodies.names() if bodies.get(name).fingerprint == fingerprint), fingerprint)
        raise UsageError(f"{path} was recorded with body {told!r}, not {body!r}; give --body, or record it anew")


def _read(group: Any, body: str) -> Demo:
    told = {name: value.item() if hasattr(value := group.attrs[name], "item") else value for name in _TOLD}

    def whole(name: str) -> Any:
        return np.concatenate([group[f"obs/{name}"][:], group[f"next_obs/{name}"][-1:]])

    pictures = {name.removesuffix(_IMAGE): whole(name) for name in group["obs"] if name.endswith(_IMAGE)}
    return Demo(
        observations=whole("state"), actions=group["actions"][:], commands=group["remac/commands"][:],
        measured=group["remac/measured"][:], states=group["states"][:], rewards=group["rewards"][:], pictures=pictures,
        before=tuple(json.loads(group.attrs.get("before", "[]"))), case=str(group.attrs.get("case", "")), body=body,
        **told,
    )  # fmt: skip


def file_digest(files: Iterable[Path]) -> str:
    """A name for what files hold."""
    found = hashlib.sha256()
    for path in files:
        found.update(path.read_bytes())
    return found.hexdigest()[:12]
