"""What checks and searches answer: free, what meets what, or why there is no way. Only the first of them is true."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, slots=True)
class Free:
    """Nothing is in the way."""

    def __bool__(self) -> Literal[True]:
        return True


@dataclass(frozen=True, slots=True)
class Hit:
    """Body ``a`` meets ``b``."""

    a: str
    b: str

    def __bool__(self) -> Literal[False]:
        return False

    def __str__(self) -> str:
        return f"{self.a} meets {self.b}"


@dataclass(frozen=True, slots=True)
class NoWay:
    """There is none, for another reason than what meets what."""

    why: str

    def __bool__(self) -> Literal[False]:
        return False

    def __str__(self) -> str:
        return self.why


FREE = Free()
