"""What can be wrong with a plan: a closed list, each with its definition."""

from __future__ import annotations

from dataclasses import dataclass

FAULTS: dict[str, str] = {
    "parse": "the reply cannot be read as one plan",
    "unknown_thing": "a command that this kitchen does not have",
    "not_at_station": "the robot does not stand where the step is done",
    "occupied": "two robots claim one station or object, or their steps contradict each other",
    "hand_full": "the step needs an empty gripper",
    "hand_empty": "the step needs something in the gripper",
    "loaded": "what is to be lifted has something on or in it",
    "unreachable": "the object is in a gripper or on the floor",
    "door_closed": "a shut door is in the way, and no later step opens it",
    "blocked": "there is no room, or something keeps the fixture from running",
    "wrong_order": "a shut or open door is in the way, and a later step sees to it",
    "advised_against": "nothing stops the step, but it is wrong (food that needs a vessel there)",
    "missing_step": "all steps work, the goal is not reached, and more steps would reach it",
    "goal_not_reached": "all steps work, and after them the goal is out of reach",
    "redundant": "the goal is reached, and steps can be left out",
    "detour": "the goal is reached, no step can be left out, and there is a shorter plan",
}
"""Type -> definition. All but the last two make a plan invalid; those two make a valid one suboptimal."""

HARMLESS = ("redundant", "detour")

BY_REASON = {
    "not_at_station": "not_at_station",
    "station_occupied": "occupied",
    "hands_full": "hand_full",
    "hands_empty": "hand_empty",
    "dropped": "hand_full",
    "loaded": "loaded",
    "unreachable": "unreachable",
    "door_closed": "door_closed",
    "blocked": "blocked",
    "already_done": "redundant",
}
"""Reason of a failed outcome (remac_env.rules.outcomes.REASONS) -> type; the reasons of physics do not come up here."""


@dataclass(frozen=True, kw_only=True)
class PlanFault:
    """The first thing wrong with a plan.

    Attributes:
        type: a key of FAULTS.
        sentence: what is wrong, in words.
        robot, index, subtask: whose step it is, its place in the row from 0, and its command; None where the fault
            is of the plan as a whole.
    """

    type: str
    sentence: str
    robot: str | None = None
    index: int | None = None
    subtask: str | None = None
