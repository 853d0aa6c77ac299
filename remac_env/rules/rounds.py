"""What comes of a round by the skill table alone: what succeeds, what fails, and what the world is then.

Claims are settled first (claims.py); effects of one round must commute, else all of them fail.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

from remac_env.rules.claims import first_false, settle_claims
from remac_env.rules.facts import Rules
from remac_env.rules.marks import given, ordered, washed
from remac_env.rules.outcomes import Outcome, failure
from remac_env.rules.quirks import changed, drifted, hindered
from remac_env.rules.skills import SKILLS, drop
from remac_env.rules.subtasks import Subtask
from remac_env.state import WorldState

SUCCESS = Outcome("success")
"""What the table says of a subtask that does what it says; it took no time yet."""


def attempt(
    rules: Rules, world: WorldState, robot: str, subtask: Subtask, *, station: str
) -> tuple[Outcome, WorldState]:
    """What the table says comes of an accepted subtask, seen from the world before the round."""
    false = first_false(rules, world, robot, subtask, "attempt")
    if false is not None:
        after = drop(world, robot) if false.drops else world
        return false.outcome, after
    if rules.quirks and (hindrance := hindered(rules, world, robot, subtask)) is not None:
        return hindrance
    row, after = SKILLS[subtask.skill], world
    if row.goes is not None and world.robots[robot].station != station:
        after = world.with_robot(robot, station=station)
    after = after if row.effect is None else row.effect(rules, after, robot, subtask.target)
    return SUCCESS, changed(rules, after, subtask) if rules.quirks else after


def attempts(
    rules: Rules, world: WorldState, subtasks: Mapping[str, Subtask], stations: Mapping[str, str]
) -> tuple[dict[str, Outcome], dict[str, WorldState]]:
    """What the table says comes of accepted subtasks: each one's outcome, and the world after it alone."""
    outcomes: dict[str, Outcome] = {}
    results: dict[str, WorldState] = {}
    for robot, subtask in subtasks.items():
        outcomes[robot], results[robot] = attempt(rules, world, robot, subtask, station=stations[robot])
    return outcomes, results


def contradicted(results: Mapping[str, WorldState]) -> dict[str, Outcome]:
    """What comes of subtasks whose effects contradict each other."""
    return {robot: failure("blocked", "the robots' effects contradict each other") for robot in results}


def merge(world: WorldState, results: Mapping[str, WorldState]) -> WorldState | None:
    """The world after all robots' changes together, or None when two of them change one thing differently."""
    others = [after for after in results.values() if after is not world]
    if len(others) < 2:
        return others[0] if others else world
    merged = world
    for part in ("robots", "objects", "fixtures"):
        before = getattr(world, part)
        changed: dict[str, Any] = {}
        for after in others:
            if getattr(after, part) is before:
                continue
            for name, value in getattr(after, part).items():
                if value is before[name] or value == before[name]:
                    continue
                if name in changed and changed[name] != value:
                    return None
                changed[name] = value
        for name, value in changed.items():
            merged = _set(merged, part, name, value)
    return merged


def _set(world: WorldState, part: str, name: str, value: object) -> WorldState:
    """The world with another state of one robot, object or fixture."""
    changed = getattr(world, part).with_(name, value)
    robots, objects = world.robots, world.objects
    if part == "robots":
        return WorldState(changed, objects, world.fixtures)
    return WorldState(robots, changed, world.fixtures) if part == "objects" else WorldState(robots, objects, changed)


def carried(before: WorldState, after: WorldState, now: WorldState) -> WorldState:
    """`now` with all in which `after` differs from `before`, field by field: an effect that comes true later."""
    if now is before or after is before:
        return after if now is before else now
    for part in ("robots", "objects", "fixtures"):
        old = getattr(before, part)
        if getattr(after, part) is old:
            continue
        for name, value in getattr(after, part).items():
            was = old[name]
            if value is not was and value != was:
                is_now = getattr(now, part)[name]
                now = _set(now, part, name, value if is_now is was else _changed(was, value, is_now))
    return now


def _changed(before: Any, after: Any, now: Any) -> Any:
    """One state with the fields in which another has changed; of sets, what was added and taken away."""
    changes: dict[str, Any] = {}
    for field in fields(after):
        old, new = getattr(before, field.name), getattr(after, field.name)
        if new != old:
            sets = isinstance(new, frozenset)
            changes[field.name] = (getattr(now, field.name) - (old - new)) | (new - old) if sets else new
    return replace(now, **changes)


def transition(
    rules: Rules, world: WorldState, subtasks: Mapping[str, Subtask]
) -> tuple[WorldState, dict[str, Outcome]]:
    """One whole round by the table alone: what the oracle searches over, and the symbolic backend's round."""
    refused, stations = settle_claims(rules, world, subtasks)
    accepted = {robot: subtask for robot, subtask in subtasks.items() if robot not in refused}
    outcomes, results = attempts(rules, world, accepted, stations)
    merged = merge(world, results)
    if merged is None:
        return world, refused | contradicted(results)
    return at_rest(rules, merged), refused | outcomes


def at_rest(rules: Rules, world: WorldState) -> WorldState:
    """The world once everything has run its course that runs by itself: doors fall, water washes, heat heats."""
    world = washed(rules, drifted(rules, world) if rules.quirks else world)
    world = given(rules, world) if rules.givers else world
    # What a dirty vessel holds does not stay washed either.
    world = drifted(rules, world) if rules.quirks else world
    return ordered(rules, world) if rules.orders else world
