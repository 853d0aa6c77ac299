"""What a planner is told: names and commands, and states only where they are asked for."""

from __future__ import annotations

from collections.abc import Sequence

from remac_env.state import Place, Scene, WorldState
from remac_env.subtasks import Outcome

TEXTS = ("plain", "states")
FEEDBACKS = ("status", "reason")


def describe(scene: Scene, commands: Sequence[str], goal: str) -> str:
    """The scene as names alone: robots, fixtures, objects, commands and the goal sentence."""
    return "\n".join(
        (
            f"Robots: {', '.join(scene.robots)}. Each has one gripper.",
            f"Fixtures: {', '.join(scene.fixtures)}.",
            f"Objects: {', '.join(scene.objects)}.",
            f"Commands: {', '.join(commands)}.",
            f"Goal: {goal}.",
        )
    )


def describe_states(scene: Scene, world: WorldState) -> str:
    """What is true now, one sentence a line; only with text="states"."""
    lines = []
    for name, robot in world.robots.items():
        held = f"holds the {robot.holding}" if robot.holding else "holds nothing"
        lines.append(f"{name} stands at {robot.station} and {held}.")
    for name, item in world.objects.items():
        marks = f" It has been {' and '.join(sorted(item.marks))}." if item.marks else ""
        lines.append(f"The {name} is {_where(scene, item.place)}.{marks}")
    for name, fixture in world.fixtures.items():
        if fixture.door is not None:
            lines.append(f"The {name} door is {fixture.door}.")
        if scene.fixtures[name].switches:
            lines.append(f"The {name} is switched {'on' if fixture.on else 'off'}.")
    return "\n".join(lines)


def describe_outcome(outcome: Outcome | None, *, feedback: str) -> str:
    """One line on how the last subtask ended, or "" before the first; why only with feedback="reason"."""
    if outcome is None:
        return ""
    if outcome.success:
        return "The last subtask succeeded."
    why = f" ({outcome.reason}: {outcome.detail})" if feedback == "reason" else ""
    return f"The last subtask failed{why}."


def _where(scene: Scene, place: Place) -> str:
    if place.relation == "slot":
        return f"on or in the {scene.slots[place.where].fixture}"
    if place.relation == "vessel":
        return f"on or in the {place.where}"
    return f"held by {place.where}" if place.relation == "held" else "on the floor"
