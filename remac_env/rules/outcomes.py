"""How a robot's subtask of a round ended, and the closed list of reasons why it did not succeed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Reason = Literal[
    "not_at_station",
    "station_occupied",
    "hands_full",
    "hands_empty",
    "loaded",
    "door_closed",
    "unreachable",
    "blocked",
    "slipped",
    "dropped",
    "already_done",
    "not_found",
    "timeout",
    "invalid",
    "interrupted",
]
"""Why a subtask did not succeed."""

REASONS: tuple[str, ...] = Reason.__args__  # type: ignore[attr-defined]
"""The closed list of failure reasons."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """How one robot's subtask of a round ended.

    `status` is success or failure; `reason` is None on success, `detail` says more of it in words; `seconds` is
    simulated time. `refused`: the controller declined, and nothing moved.
    `began` and `ended` are on the kitchen's clock: simulated seconds since the start, rests between rounds included.
    """

    status: Literal["success", "failure"]
    reason: Reason | None = None
    detail: str = ""
    seconds: float = 0.0
    refused: bool = False
    began: float = 0.0
    ended: float = 0.0

    @property
    def success(self) -> bool:
        """True when the subtask did what it says."""
        return self.status == "success"


def failure(reason: Reason, detail: str = "", *, seconds: float = 0.0, refused: bool = False) -> Outcome:
    """A failed outcome."""
    return Outcome("failure", reason, detail, seconds, refused)
