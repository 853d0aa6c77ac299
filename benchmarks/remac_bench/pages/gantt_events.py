"""Who did what when by the event clock: subtasks and thoughts of each robot, and what takes its time by itself."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Mapping, Sequence

from remac_bench.pages.gantt import BAR, LANE, LEAST, LEFT, LETTER, RIGHT, TOP, WIDTH, Bar, Gantt, label_of, ticks_of
from remac_bench.records import Record, SpanEntry

SLIM, LOW = 30.0, 22.0
"""Of the lane of a process, and of its bar."""

_WORDS = {"thought": "thinking", "process": "by itself"}


def draw_events(
    record: Record, spans: Sequence[tuple[float, float]], *, alarms: Mapping[tuple[int, str], bool]
) -> Gantt:
    """The timeline of a record; waits are the gaps in it.

    Args:
        spans: when each decision point was, and the next one, s; a bar belongs to that at whose end it had ended.
        alarms: decision point and robot of conditions called false -> whether wrongly.
    """
    robots = sorted({span.who for span in record.timeline if span.kind in ("subtask", "wait", "thought")})
    lanes = {robot: TOP + index * LANE for index, robot in enumerate(robots)}
    starts = (*(span[0] for span in spans), *(span[1] for span in spans[-1:]))
    total = max((*starts, *(span.ended for span in record.timeline)), default=0.0) or 1.0
    inner, latest = WIDTH - LEFT - RIGHT, WIDTH - RIGHT - LEAST

    def at(second: float) -> float:
        return round(min(LEFT + inner * second / total, latest), 1)

    def bar(span: SpanEntry, y: float, height: float) -> Bar:
        return _bar(span, x=at(span.began), y=y, height=height, scale=inner / total, starts=starts)

    below = TOP + LANE * max(1, len(robots))
    rows = _rows(span for span in record.timeline if span.kind == "process")
    shown = [span for span in record.timeline if span.kind in ("subtask", "thought")]
    bars = [bar(span, lanes[span.who] + (LANE - BAR) / 2, BAR) for span in shown]
    for index, row in enumerate(rows):
        bars += [bar(span, below + index * SLIM + (SLIM - LOW) / 2, LOW) for span in row]
    own = [("by itself", below + SLIM / 2)] if rows else []
    marks = [(at(spans[n][0]) + 3, lanes[who] + 3, n, wrong) for (n, who), wrong in alarms.items() if who in lanes]
    return Gantt(
        what="What each robot was at, and what went on by itself, over simulated time",
        width=WIDTH,
        height=below + SLIM * len(rows) + 4,
        left=LEFT,
        top=TOP,
        inner=inner,
        lanes=(*((robot, y + LANE / 2) for robot, y in lanes.items()), *own),
        bars=tuple(sorted(bars, key=lambda each: (each.y, each.x))),
        marks=tuple(marks),
        grid=tuple((at(span[0]), number) for number, span in enumerate(spans)),
        ticks=tuple((at(second), f"{second:g} s") for second in ticks_of(total)),
        starts=starts,
        video=tuple(record.video.rounds) if record.video else (),
    )


def _rows(spans: Iterable[SpanEntry]) -> list[list[SpanEntry]]:
    """Processes in as few rows as hold them side by side."""
    rows: list[list[SpanEntry]] = []
    for span in sorted(spans, key=lambda each: (each.began, each.ended)):
        row = next((row for row in rows if row[-1].ended <= span.began), None)
        if row is None:
            rows.append([span])
        else:
            row.append(span)
    return rows


def _bar(span: SpanEntry, *, x: float, y: float, height: float, scale: float, starts: Sequence[float]) -> Bar:
    seconds = span.ended - span.began
    width = round(max(seconds * scale - 2, LEAST), 1)
    doing = {"thought": _WORDS["thought"], "process": f"{span.what} {span.who}"}.get(span.kind, span.what)
    label = label_of(doing, int((width - 6) / LETTER))
    number = min(max(bisect_left(starts, span.ended) - 1, 0), max(len(starts) - 2, 0))
    who = _WORDS["process"] if span.kind == "process" else span.who
    told = f"thinking of {span.what[:200]}" if span.kind == "thought" else doing[:200]
    why = f" ({span.reason})" if span.reason else ""
    when = f"{span.began:.1f} to {span.ended:.1f} s"
    return Bar(
        round=number,
        x=x,
        y=y,
        width=width,
        height=height,
        label=label[:1] if height < BAR else label,
        title=f"decision {number + 1}, {who}: {told}: {span.status}{why}, {when}",
        status={"success": "ok", "cut": "cut"}.get(span.status, "bad"),
        kind=span.kind if span.kind in _WORDS else "subtask",
        begins=span.began,
        ends=span.ended,
    )
