"""Mappings that cannot change, so that they can be shared and hashed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NoReturn, TypeVar

Value = TypeVar("Value")


class FrozenMap(dict[str, Value]):
    """An immutable, hashable mapping from names; equality ignores order, and is to other FrozenMaps alone.

    It is a dict so that looking up and going through it run in C: searches spend their time there. What would change
    it raises TypeError.
    """

    __slots__ = ("_hash",)

    def __hash__(self) -> int:  # type: ignore[override]
        try:
            return self._hash
        except AttributeError:
            self._hash: int = hash(frozenset(self.items()))
            return self._hash

    def __eq__(self, other: object) -> bool:
        return isinstance(other, FrozenMap) and dict.__eq__(self, other)

    def __ne__(self, other: object) -> bool:
        return not self == other

    def __reduce__(self) -> tuple[object, ...]:
        # Hashes of strings differ from process to process: the kept one must not travel.
        return FrozenMap, (dict(self),)

    def with_(self, key: str, value: Value) -> FrozenMap[Value]:
        """A copy in which `key` has `value`."""
        copy = FrozenMap(self)
        dict.__setitem__(copy, key, value)
        return copy

    def __or__(self, other: Mapping[str, Value]) -> NoReturn:  # type: ignore[override]
        self._refuse()

    def _refuse(self, *args: object, **named: object) -> NoReturn:
        raise TypeError("a FrozenMap cannot change; with_(key, value) gives a copy")

    __setitem__ = __delitem__ = __ior__ = _refuse  # type: ignore[assignment]
    clear = pop = popitem = setdefault = update = _refuse  # type: ignore[assignment]
