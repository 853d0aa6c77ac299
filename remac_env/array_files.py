"""Files of NumPy arrays from anywhere: read without running anything in them, and not larger than they may be."""

from __future__ import annotations

import errno
import io
import zipfile
import zlib
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


def read_bytes(path: str | Path, most: int) -> bytes:
    """A file that has no more bytes than it may have.

    Raises:
        OptionError: if it has more.
        OSError: if it cannot be read.
    """
    try:
        return files.read_bytes(path, most)
    except OSError as error:
        if error.errno == errno.EFBIG:
            raise OptionError(str(error.strerror)) from error
        raise


def unpacked(data: bytes, most: int) -> dict[str, NDArray[Any]]:
    """Name -> array, of the bytes of a .npz. What a header says is believed only as far as the bytes reach.

    Arrays of objects, which NumPy would unpickle, are refused. most: bytes of all arrays together.

    Raises:
        OptionError: if they have more.
        Exception: one of UNREADABLE, if it is damaged.
    """
    with zipfile.ZipFile(io.BytesIO(data)) as parts:
        size = sum(part.file_size for part in parts.infolist())
    if size > most:
        raise OptionError(f"unpacked it has {size} bytes; valid: at most {most}")
    with np.load(io.BytesIO(data), allow_pickle=False) as found:
        return {name: found[name] for name in found.files}
