"""Files that users give and get: byte order marks are no part of a text; what cannot be written is refused first."""

from __future__ import annotations

import codecs
import errno
import os
from pathlib import Path
from typing import IO

from remac_env.errors import OptionError
from remac_env.quoting import PATH, quoted, words

_MARKS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),  # before UTF-16: its mark begins with that one
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
"""Byte order mark -> the encoding that it announces. Editors put one before texts."""


MOST_BYTES = 256 << 20
"""What is read at a time at most: more is no text that anyone wrote, or a device that never ends."""


def read_text(path: str | os.PathLike[str]) -> str:
    """A file's text: UTF-8, or what its byte order mark says, which is no part of it.

    Raises:
        OSError: if it cannot be read, or has more than MOST_BYTES.
        UnicodeDecodeError: if it is not in that encoding.
    """
    return decode(read_bytes(path))


def read_bytes(path: str | os.PathLike[str], most: int = MOST_BYTES) -> bytes:
    """A file's bytes. Its size is not asked for but met: devices say that they have none.

    Raises:
        OSError: if it cannot be read, or has more than `most` bytes.
    """
    with Path(path).open("rb") as file:
        data = file.read(most + 1)
    if len(data) > most:
        raise OSError(errno.EFBIG, f"it has more than {most} bytes", os.fspath(path))
    return data


def decode(data: bytes) -> str:
    """The same for bytes; every kind of line end becomes a newline."""
    mark, encoding = next(((m, e) for m, e in _MARKS if data.startswith(m)), (b"", "utf-8"))
    return data[len(mark) :].decode(encoding).replace("\r\n", "\n").replace("\r", "\n")


def unmarked(line: str) -> str:
    """A line without a byte order mark: the first of a stream may have one."""
    return line.removeprefix("\ufeff").removeprefix("\u00ef\u00bb\u00bf")


def ends_torn(file: IO[bytes]) -> bool:
    """Whether the last line of a file, opened to be read, lacks its end: whoever wrote it was stopped."""
    if file.seek(0, os.SEEK_END) == 0:
        return False
    file.seek(-1, os.SEEK_END)
    return file.read(1) != b"\n"


def prepare_file(path: str | os.PathLike[str], what: str) -> Path:
    """See that a file can be written, before anything is worked for; its folder is made. Returns the path.

    Args:
        what: what errors call it, such as "--json".

    Raises:
        OptionError: if it cannot.
    """
    target = Path(path)
    prepare_folder(target.parent, what)
    try:
        there = target.exists()
        with target.open("ab"):
            pass
        if not there:
            target.unlink()
    except (OSError, ValueError) as error:
        raise _refused(what, path, error) from error
    return target


def prepare_folder(path: str | os.PathLike[str], what: str) -> Path:
    """The same for a folder, which is made.

    Raises:
        OptionError: if nothing can be written into it.
    """
    folder = Path(path)
    try:
        if not os.fspath(path):
            raise ValueError("it is empty")
        folder.mkdir(parents=True, exist_ok=True)
        if not os.access(folder, os.W_OK | os.X_OK):
            raise PermissionError(13, "Permission denied")
    except (OSError, ValueError) as error:
        raise _refused(what, path, error) from error
    return folder


def _refused(what: str, path: object, error: Exception) -> OptionError:
    why = getattr(error, "strerror", None) or words(error)
    given = quoted(os.fspath(path), PATH)  # type: ignore[call-overload]
    return OptionError(f"{what} {given} cannot be written: {why}; valid: a path where files can be made")
