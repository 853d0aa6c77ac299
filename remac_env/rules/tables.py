"""Tables of rows: every row by its name, with words of its own."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, Protocol, TypeVar

from remac_env.errors import OptionError


class Named(Protocol):
    """A row."""

    @property
    def name(self) -> str:
        """What the row is called."""


Row = TypeVar("Row", bound=Named)


def by_name(kind: str, words: Literal["sentence", "form"], rows: Iterable[Row]) -> dict[str, Row]:
    """The rows by name, in their order.

    Args:
        kind: what errors call a row.
        words: the field from which a row is read back.

    Raises:
        OptionError: for two rows of one name, or of the same words: they could not be read back.
    """
    found: dict[str, Row] = {}
    said: dict[str, str] = {}
    for row in rows:
        if row.name in found:
            raise OptionError(f"{kind} {row.name!r} has two rows; valid: one")
        if (other := said.setdefault(getattr(row, words), row.name)) != row.name:
            raise OptionError(f"{kind}s {other!r} and {row.name!r} have one {words}; valid: one of their own each")
        found[row.name] = row
    return found
