"""Files of learned skills from anywhere: whatever is wrong with one, it is refused with a reason."""

from __future__ import annotations

import json
import os
import warnings
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from learned_kit import SKILL, weights

from remac_env.backends.physics.controllers.learned.library import learned_skills
from remac_env.backends.physics.controllers.learned.network import DEEPEST
from remac_env.backends.physics.controllers.learned.weights import read_weights, save_weights
from remac_env.errors import OptionError


def edited(change: Callable[[dict[str, Any]], None]) -> Callable[[Path], None]:
    """A change of what the file says of itself."""

    def edit(path: Path) -> None:
        with np.load(path) as file:
            arrays = {name: file[name] for name in file.files}
        about = json.loads(str(arrays["about"]))
        change(about)
        np.savez(path, **(arrays | {"about": np.array(json.dumps(about))}))

    return edit


def with_array(name: str, change: Callable[[Any], Any]) -> Callable[[Path], None]:
    def edit(path: Path) -> None:
        with np.load(path) as file:
            arrays = {key: file[key] for key in file.files}
        arrays[name] = change(arrays[name])
        np.savez(path, **arrays)

    return edit


def cut(path: Path) -> None:
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2])


def pickled(path: Path) -> None:
    with np.load(path) as file:
        arrays: dict[str, Any] = {name: file[name] for name in file.files}
    np.savez(path, **(arrays | {"mean": np.array([object()] * len(arrays["mean"]), dtype=object)}))


def bomb(path: Path) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("mean.npy", b"0" * 30_000_000)


def told(**said: Any) -> Callable[[Path], None]:
    """A file that says this of itself."""
    return edited(lambda about: about.update(said))


def with_member(name: str, data: bytes, packed: int = zipfile.ZIP_DEFLATED) -> Callable[[Path], None]:
    def add(path: Path) -> None:
        with zipfile.ZipFile(path, "a", packed) as archive:
            archive.writestr(name, data)

    return add


def twice(path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # zipfile's own
        with_member("mean.npy", b"")(path)


def locked(path: Path) -> None:
    """As if a password were needed."""
    data = bytearray(path.read_bytes())
    for mark, offset in ((b"PK\x01\x02", 8), (b"PK\x03\x04", 6)):
        at = -1
        while (at := data.find(mark, at + 1)) >= 0:
            data[at + offset] |= 1
    path.write_bytes(data)


def many_layers(path: Path) -> None:
    thin, one = np.zeros((1, 1), np.float32), np.zeros(1, np.float32)
    with np.load(path) as file:
        arrays = {name: file[name] for name in file.files}
    for number in range(1, DEEPEST + 1):
        arrays |= {f"weight_{number}": thin, f"bias_{number}": one, f"gain_{number}": one, f"shift_{number}": one}
    np.savez(path, **arrays)


def replaced(make: Callable[[Path], Any]) -> Callable[[Path], None]:
    """Something else of the same name."""

    def put(path: Path) -> None:
        path.unlink()
        make(path)

    return put


def lying(path: Path) -> None:
    """An array that its header calls far larger than it is."""
    head = b"{'descr': '<f4', 'fortran_order': False, 'shape': (200000000,), }".ljust(117) + b"\n"
    with np.load(path) as file:
        arrays = {name: file[name] for name in file.files if name != "mean"}
    np.savez(path, **arrays)
    with_member("mean.npy", b"\x93NUMPY\x01\x00v\x00" + head + b"1234")(path)


def flipped(values: Any) -> Any:
    changed = values.copy()
    changed.flat[3] += 1
    return changed


BEYOND = np.float64(1e300)

BAD = {
    "of another observation": (edited(lambda about: about.update(observation="0" * 12)), "made for observation"),
    "of another body": (edited(lambda about: about.update(body="0" * 12)), "made for body"),
    "of other code": (edited(lambda about: about.update(format="remac-skill-0")), "made for format"),
    "of no skill": (edited(lambda about: about.update(skill="juggle")), "valid: navigate to"),
    "that says more than it may": (edited(lambda about: about.update(run="rm")), "valid: "),
    "that says nothing": (edited(lambda about: about.clear()), "made for format"),
    "with too long steps": (edited(lambda about: about.update(execute=99)), "execute 99"),
    "of texts": (with_array("last_weight", lambda values: values.astype(str)), "holds <U"),
    "with an endless number": (with_array("weight_0", lambda values: values + np.float16(np.inf)), "finite"),
    "that divides by nothing": (with_array("std", lambda values: values * 0.0), "fit together"),
    "that says no number": (with_array("answer", lambda values: values * np.nan), "damaged"),
    "that is about a list of skills": (edited(lambda about: about.update(skill=[SKILL])), "valid: navigate to"),
    "whose steps are a text": (edited(lambda about: about.update(execute="8")), "execute '8'"),
    "with a number that is none": (with_array("last_bias", lambda values: values * np.nan), "finite"),
    "with another network": (with_array("last_weight", lambda values: values[:, :4]), "fit together"),
    "with one number changed": (with_array("last_bias", flipped), "damaged"),
    "without a sample": (with_array("sample", lambda values: values[:0]), "sample"),
    "that is cut off": (cut, "cannot be read"),
    "that is pickled": (pickled, "cannot be read"),
    "that is a bomb": (bomb, "bytes"),
    "that is not there": (Path.unlink, "cannot be read"),
    "whose targets are one text": (told(targets="faucet"), "targets 'faucet'"),
    "whose targets are numbers": (told(targets=[1]), "targets"),
    "whose cases are none": (told(cases=None), "cases None"),
    "whose cases are numbers": (told(cases=[1]), "cases"),
    "measured by a list": (told(measured=[1]), "measured"),
    "measured in words": (told(measured={"faucet: here": {"trials": "many", "successes": 1}}), "measured"),
    "measured in part": (told(measured={"faucet: here": {}}), "measured"),
    "with more successes than trials": (told(measured={"faucet: here": {"trials": 1, "successes": 2}}), "measured"),
    "with trials of infinite number": (told(measured={"faucet: here": {"trials": 1e400, "successes": 1}}), "measured"),
    "of fewer demonstrations than none": (told(demonstrations=-1), "demonstrations -1"),
    "of seeds that are a number": (told(seeds=5), "seeds 5"),
    "of a layout that is a number": (told(layouts=[1]), "layouts"),
    "with steps of a thousand digits": (told(execute=10**1000), r"execute 1000+\.\.\. is"),
    "that multiplies by nothing": (with_array("out_std", lambda values: values * 0.0), "fit together"),
    "that multiplies by less than nothing": (with_array("out_std", lambda values: -values), "fit together"),
    "that divides by an infinite number": (with_array("std", lambda values: values + np.inf), "finite"),
    "that divides by next to nothing": (with_array("std", lambda values: values * np.float32(1e-38)), "damaged"),
    "with numbers that 32 bits cannot hold": (with_array("last_bias", lambda values: values * 0.0 + BEYOND), "finite"),
    "of records": (with_array("mean", lambda values: np.zeros(len(values), [("a", "f4")])), "holds"),
    "of a single number": (with_array("mean", lambda values: np.float32(1.0)), "fit together"),
    "with a commands array of one number": (with_array("out_mean", lambda values: np.float32(1.0)), "fit together"),
    "with a thousand samples": (with_array("sample", lambda values: np.repeat(values, 500, axis=0)), "sample"),
    "with too many layers": (many_layers, "17 layers; valid: at most 16"),
    "with a file that leads elsewhere": (with_member("../../mean.npy", b""), "cannot be read"),
    "with a file that is no array": (with_member("mean2", b"abc"), "cannot be read"),
    "with an array twice": (twice, "more than once"),
    "that needs a password": (locked, "packed or locked"),
    "that is packed otherwise": (with_member("more.npy", b"0" * 99, zipfile.ZIP_LZMA), "packed or locked"),
    "whose header lies": (lying, "cannot be read"),
    "that is a folder": (replaced(Path.mkdir), "cannot be read"),
    "that is a pipe": (replaced(os.mkfifo), "a pipe"),
    "that never ends": (replaced(lambda path: path.symlink_to("/dev/zero")), "more than"),
    "that is a link to itself": (replaced(lambda path: path.symlink_to(path)), "cannot be read"),
    "that is a link to nowhere": (replaced(lambda path: path.symlink_to("/nowhere")), "cannot be read"),
}


@pytest.mark.parametrize("case", BAD)
def test_a_file_is_refused(case: str, tmp_path: Path) -> None:
    path = tmp_path / "TurnOn.npz"
    save_weights(path, weights())
    spoil, reason = BAD[case]
    spoil(path)
    with pytest.raises(OptionError, match=reason) as caught:
        read_weights(path)
    assert "TurnOn.npz" in str(caught.value)
    if os.path.lexists(path):
        with pytest.raises(OptionError, match=reason):
            learned_skills(str(tmp_path), 1)


