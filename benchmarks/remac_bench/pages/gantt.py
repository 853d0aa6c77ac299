"""Who did what when: the subtasks of all robots over simulated time."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from remac_bench.pages.text import visible
from remac_bench.records import Record
from remac_env.rules.skills import SKILLS

LEFT, RIGHT, TOP = 84.0, 12.0, 30.0
"""Room for the robots' names, behind the last bar, and for the axis, in the picture's units (about pixels)."""

WIDTH, LANE, BAR = 1080.0, 58.0, 38.0
"""Of the picture, of a robot's lane and of its bar."""

LETTER = 5.9
"""Width of a letter in a bar."""

LEAST = 5.0
"""Width of the bar of a subtask that took no time, such as a refusal."""

TICKS = 10
"""On the axis at most."""


@dataclass(frozen=True, kw_only=True)
class Bar:
    """A robot's subtask in a round, `round` from 0; `title` counts from 1.

    `label`: as much of the subtask as the bar holds, in at most two lines. `kind`: subtask, thought or process;
    `begins`, `ends`: s, where bars begin and end within rounds.
    """

    round: int
    x: float
    y: float
    width: float
    height: float
    label: tuple[str, ...]
    title: str
    status: str
    kind: str = "subtask"
    begins: float | None = None
    ends: float | None = None


@dataclass(frozen=True, kw_only=True)
class Gantt:
    """A drawing in a box of `width` x `height`. `starts`: simulated seconds at which rounds begin, and the last ends.

    `video`: for each of them the second of the video, where the record has them. `what`: what is drawn, in words.
    """

    what: str
    width: float
    height: float
    left: float
    top: float
    inner: float
    lanes: tuple[tuple[str, float], ...]
    bars: tuple[Bar, ...]
    marks: tuple[tuple[float, float, int, bool], ...]
    grid: tuple[tuple[float, int], ...]
    ticks: tuple[tuple[float, str], ...]
    starts: tuple[float, ...]
    video: tuple[float, ...]


def draw(record: Record, spans: Sequence[tuple[float, float]], *, alarms: Mapping[tuple[int, str], bool]) -> Gantt:
    """Args: alarms: round and robot of conditions called false -> whether wrongly."""
    robots = sorted({robot for outcomes in record.outcomes for robot in outcomes})
    total = spans[-1][1] if spans and spans[-1][1] > 0 else 1.0
    inner = WIDTH - LEFT - RIGHT
    lanes = {robot: TOP + index * LANE for index, robot in enumerate(robots)}

    def at(second: float) -> float:
        return round(LEFT + inner * second / total, 1)

    # A refusal takes no time: its bar is kept inside the picture.
    latest = WIDTH - RIGHT - LEAST
    bars = tuple(
        _bar(number, robot, record, x=min(at(span[0]), latest), y=lanes[robot] + (LANE - BAR) / 2, scale=inner / total)
        for number, span in enumerate(spans)
        for robot in sorted(record.outcomes[number])
        if not _idle(record, number, robot)
    )
    marks = tuple(
        (min(at(spans[number][0]), latest) + 3, lanes[robot] + 3, number, wrong)
        for (number, robot), wrong in alarms.items()
        if robot in lanes
    )
    return Gantt(
        what="Subtasks of the robots over simulated time",
        width=WIDTH,
        height=TOP + LANE * max(1, len(robots)) + 4,
        left=LEFT,
        top=TOP,
        inner=inner,
        lanes=tuple((robot, y + LANE / 2) for robot, y in lanes.items()),
        bars=bars,
        marks=marks,
        grid=tuple((at(span[0]), number) for number, span in enumerate(spans)),
        ticks=tuple((at(second), f"{second:g} s") for second in ticks_of(total)),
        starts=(*(span[0] for span in spans), *(span[1] for span in spans[-1:])),
        video=tuple(record.video.rounds) if record.video else (),
    )


_STILL = frozenset(skill.form for skill in SKILLS.values() if skill.still)


def _idle(record: Record, number: int, robot: str) -> bool:
    outcome = record.outcomes[number][robot]
    return outcome.subtask in _STILL and outcome.status == "success"


def _bar(number: int, robot: str, record: Record, *, x: float, y: float, scale: float) -> Bar:
    outcome = record.outcomes[number][robot]
    width = round(max(outcome.seconds * scale - 2, LEAST), 1)
    text = outcome.subtask
    why = f" ({outcome.reason})" if outcome.reason else ""
    return Bar(
        round=number,
        x=x,
        y=y,
        width=width,
        height=BAR,
        label=label_of(text, int((width - 6) / LETTER)),
        title=f"round {number + 1}, {robot}: {text[:200]}: {outcome.status}{why}, {outcome.seconds:.1f} s",
        status="ok" if outcome.status == "success" else "bad",
    )


def label_of(text: str, room: int) -> tuple[str, ...]:
    """The text in one or two lines of at most `room` letters; words that are longer are cut, so that more are seen."""
    if room < 4:
        return ()
    words = (word if len(word) <= room else f"{word[: room - 1]}\u2026" for word in visible(text[:200]).split())
    return tuple(textwrap.wrap(" ".join(words), room, max_lines=2, placeholder="\u2026"))


def ticks_of(total: float) -> list[float]:
    """Where the axis of so many rounds or seconds has its marks: at multiples of a round number, `TICKS` at most."""
    step = next((each for each in (1, 2, 5, 10, 20, 50, 100, 200, 500) if total / each <= TICKS), total / TICKS)
    return [number * step for number in range(int(total / step) + 1)]
