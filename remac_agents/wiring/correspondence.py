"""What an agent's roles said to language models in an episode, whichever roles and however many models they are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import astuple
from typing import Any, Protocol, runtime_checkable

from remac_agents.report import Exchange, Usage
from remac_agents.roles import Roles


@runtime_checkable
class Correspondent(Protocol):
    """Keeps the book of what was said. A role shows its own as `models`; several roles may share one."""

    def begin_episode(self, label: str, errors: list[str]) -> None:
        """A new page; `label` names the episode, and what goes wrong is added to `errors`."""

    def begin_round(self, number: int) -> None:
        """How many rounds were played before what is said from here on."""

    @property
    def usage(self) -> Usage:
        """What the episode took."""

    @property
    def exchanges(self) -> tuple[Exchange, ...]:
        """Questions and answers of the episode."""

    @property
    def pictures(self) -> Mapping[str, bytes]:
        """Digest -> PNG of what was shown."""


class Correspondence:
    """The books of all roles of an agent."""

    def __init__(self, roles: Roles) -> None:
        books = [getattr(role, "models", None) for role in roles.named().values()]
        self._books = list({id(book): book for book in books if isinstance(book, Correspondent)}.values())

    def begin_episode(self, label: str, errors: list[str]) -> None:
        """Open a new page in each."""
        for book in self._books:
            book.begin_episode(label, errors)

    def begin_round(self, number: int) -> None:
        """Tell each how far the episode is."""
        for book in self._books:
            book.begin_round(number)

    @property
    def spent(self) -> tuple[int, float]:
        """Tokens that models wrote in the episode, and the seconds that it took them."""
        spent = [getattr(book, "spent", (0, 0.0)) for book in self._books]
        return sum(tokens for tokens, _ in spent), sum(seconds for _, seconds in spent)

    def fields(self) -> dict[str, Any]:
        """The fields `usage`, `exchanges` and `pictures` of an EpisodeReport."""
        columns = zip(*(astuple(book.usage) for book in self._books), strict=True)
        return {
            "usage": Usage(*(sum(column) for column in columns)),
            "exchanges": tuple(exchange for book in self._books for exchange in book.exchanges),
            "pictures": {name: png for book in self._books for name, png in book.pictures.items()},
        }
