"""What is to be known of the pictures by whoever looks at them: how robots are told apart, what each camera shows."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

ACCENTS = {
    "blue": (0.10, 0.42, 0.78),
    "orange": (0.93, 0.52, 0.12),
    "green": (0.25, 0.62, 0.35),
    "purple": (0.62, 0.30, 0.66),
}
"""Name -> RGB, 0..1, of the colours by which robots are told apart, in the order of the robots."""

CAMERAS = {
    "front": "shows the whole room from in front",
    "side": "looks closely at what the robot holds and at its place (at the whole room while it is out of the way)",
    "station": "looks closely at the robot's place, whatever it holds (at the whole room while it is out of the way)",
    "wrist": "sits on the robot's hand and looks along its fingers, the room's up upwards",
}
"""Camera of the observations -> what it does, as words after its name."""


def accents(robots: Sequence[str]) -> dict[str, str]:
    """Robot -> the name of its colour."""
    names = tuple(ACCENTS)
    return {robot: names[index % len(names)] for index, robot in enumerate(robots)}


def describe_sight(robots: Sequence[str], cameras: Iterable[str]) -> str:
    """One line on the robots' colours and on these cameras."""
    marked = ", ".join(f"{robot} {colour}" for robot, colour in accents(robots).items())
    known = dict.fromkeys(name for name in cameras if name in CAMERAS)
    told = [f"The {name} camera {CAMERAS[name]}." for name in known]
    return " ".join([f"Bands of colour on body and hand mark the robots: {marked}.", *told])
