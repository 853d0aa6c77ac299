"""What single records and groups of them say: caps of failures, idle time, settings, and which record counts."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from typing import Any

from remac_bench.records import Record
from remac_env.errors import UnknownNameError
from remac_env.options import Options
from remac_env.rules.skills import SKILLS
from remac_env.rules.subtasks import DONE, WAIT

LONGEST = max(skill.seconds for skill in SKILLS.values())
"""Nominal seconds of the longest skill, from the skill table."""

RESTING = (WAIT.text, DONE.text)


def distinct(records: Iterable[Record]) -> list[Record]:
    """One record of each job and iteration, in an order that does not depend on theirs.

    Of two, one that no infrastructure error ended; further ties are settled by their text.
    """
    kept: dict[tuple[str, int], Record] = {}
    for record in records:
        key = (record.job, record.iteration)
        kept[key] = record if key not in kept else max(kept[key], record, key=_weight)
    return [kept[key] for key in sorted(kept)]


def _weight(record: Record) -> tuple[bool, str]:
    return (not record.infrastructure_error, record.line())


def setting(record: Record, *, but: Sequence[str] = ()) -> str:
    """Suite, backend, starts and whatever else makes an episode harder or easier, but not its cell and seed.

    Args:
        but: options of the kitchen that are left out.
    """
    kitchen = dict(record.options.get("kitchen", {}))
    suite = suite_of(record)
    parts = [*([f"suite {suite}"] if suite else []), record.backend, f"{record.starts} starts"]
    skipped = ["backend", "starts", "style", "layout", "robots", "render_mode", "image_size", "cameras", *but]
    skipped += ["obs"] if record.options.get("viewers") else []  # pictures for a role are the agent's own matter
    defaults: dict[str, Any] = {name: f.default for name, f in Options.__dataclass_fields__.items()}
    changed = {n: v for n, v in kitchen.items() if n not in skipped and n in defaults and v != defaults[n]}
    if record.body_digest is not None:  # by what it is, wherever its file lies
        changed["body"] = f"{record.body} {record.body_digest}"
    return ", ".join([*parts, *(f"{name}={value}" for name, value in sorted(changed.items()))])


def suite_of(record: Record) -> str:
    """The suite that the episode was played for, with its version; "" where it was none."""
    parts = (getattr(record, name, None) for name in ("suite", "suite_version"))
    return " ".join(str(part) for part in parts if part is not None)


def cap_rounds(record: Record) -> int:
    """The rounds after which the kitchen ends the episode."""
    return int(record.options.get("kitchen", {}).get("max_rounds", Options.max_rounds))


def cap_seconds(record: Record) -> float:
    """The cap in simulated seconds: every round as long as the longest skill takes by the skill table.

    Under the event clock it is when the kitchen ends the episode: by its own, or at the task's deadline.
    """
    if record.clock == "events":
        kitchen = float(record.options.get("kitchen", {}).get("max_seconds", Options.max_seconds))
        return min(kitchen, deadline_of(record.task))
    return cap_rounds(record) * LONGEST


def deadline_of(task: str) -> float:
    """s after which a task is too late; infinite where it has no deadline of its own, or is not installed here."""
    from remac_env.tasks import get

    try:
        spec = get(task)
    except UnknownNameError:
        return math.inf
    return math.inf if spec.deadline is None else spec.deadline


def idle_share(record: Record) -> float | None:
    """The share of the robots' simulated time in which they wait: for another, for work, or aside.

    1 - (seconds of all subtasks of all robots) / (robots x seconds of the slowest in each round). Under the event
    clock: seconds of all waits / (robots x seconds of the episode).
    """
    if record.clock == "events":
        return share_of(record, "wait")
    busy, span = 0.0, 0.0
    for outcomes in record.outcomes:
        times = [0.0 if entry.subtask in RESTING else entry.seconds for entry in outcomes.values()]
        busy += math.fsum(times)
        span += max(times, default=0.0) * len(times)
    return 1 - busy / span if span else None


def share_of(record: Record, kind: str) -> float | None:
    """The share of the robots' simulated time that went into spans of this kind; None with rounds."""
    whole = record.robots * record.sim_seconds
    spent = math.fsum(span.ended - span.began for span in record.timeline if span.kind == kind)
    return spent / whole if record.clock == "events" and whole else None


def by_events(method: str) -> bool:
    """Whether a method of this name is made for the event clock: asked robot by robot, when each is ready."""
    from remac_agents.methods import METHODS

    return method in METHODS and METHODS[method].by_events


def cell(record: Record) -> tuple[str, str, str]:
    """Task, style and layout."""
    return (record.task, record.style or "", record.layout or "")


def problem(record: Record) -> str:
    """The problem behind an episode: starts that differ only in looks and names are one.

    A record from before problems were recorded counts as its task's one problem where its start is a paper start, and
    else as a problem of its own.
    """
    if record.problem is not None:
        return f"{record.task} {record.problem}"
    return record.task if record.starts == "paper" else " ".join(map(str, shared_key(record)))


def code_note(records: Sequence[Record]) -> str:
    """Of which code these records are, by its digest; a warning where they are of more than one."""
    codes = Counter(record.versions.get("code", "unknown") for record in records)
    if len(codes) < 2:
        return f"Code: {next(iter(codes), 'unknown')}."
    told = ", ".join(f"{code} ({count} episodes)" for code, count in sorted(codes.items()))
    return f"Records of different code, which may not be compared: {told}."


def shared_key(record: Record) -> tuple[object, ...]:
    """What two entries have in common when they play the same episode: the cell, the starts and the seed."""
    return (*cell(record), record.starts, record.seed)
