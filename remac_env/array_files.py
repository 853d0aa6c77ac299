"""Files of NumPy arrays from anywhere: read without running anything in them, and not larger than they may be."""

from __future__ import annotations

import errno
import io
import stat
import zipfile
import zlib
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remac_env import files
from remac_env.errors import OptionError

UNREADABLE = (
    *(OSError, EOFError, ValueError, KeyError, TypeError, AttributeError, RecursionError, MemoryError),
    *(zipfile.BadZipFile, zlib.error, NotImplementedError),
)
"""What NumPy, zipfile, json and texts of wrong types raise for a file that is damaged."""

_PACKED = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)  # how NumPy packs arrays
_LOCKED = 1  # the bit that says that a password is needed


def read_bytes(path: str | Path, most: int) -> bytes:
    """A file that has no more bytes than it may have.

    Raises:
        OptionError: if it has more, or is a pipe, which would be waited for.
        OSError: if it cannot be read.
    """
    if stat.S_ISFIFO(Path(path).stat().st_mode):
        raise OptionError("it is a pipe, and no file")
    try:
        return files.read_bytes(path, most)
    except OSError as error:
        if error.errno == errno.EFBIG:
            raise OptionError(str(error.strerror)) from error
        raise


def unpacked(data: bytes, most: int) -> dict[str, NDArray[Any]]:
    """Name -> array, of the bytes of a .npz. What a header says is believed only as far as the bytes reach.

    Arrays of objects, which NumPy would unpickle, are refused, and so is what NumPy packs no array as. most: bytes of
    all arrays together.

    Raises:
        OptionError: if they have more, two have one name, or they are packed otherwise.
        Exception: one of UNREADABLE, if it is damaged.
    """
    with zipfile.ZipFile(io.BytesIO(data)) as parts:
        told = parts.infolist()
    size = sum(part.file_size for part in told)
    if size > most:
        raise OptionError(f"unpacked it has {size} bytes; valid: at most {most}")
    if (often := Counter(part.filename for part in told).most_common(1)) and often[0][1] > 1:
        raise OptionError(f"it has {often[0][0]!r} more than once")
    if any(part.compress_type not in _PACKED or part.flag_bits & _LOCKED for part in told):
        raise OptionError("its arrays are packed or locked as NumPy packs none")
    with np.load(io.BytesIO(data), allow_pickle=False) as found:
        return {name: found[name] for name in found.files}
