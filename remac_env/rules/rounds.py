"""What comes of a round by the skill table alone: what succeeds, what fails, and what the world is then.

Claims are settled first (claims.py); effects of one round must commute, else all of them fail.
"""

from __future__ import annotations

from collections.abc import Mapping

from remac_env.rules.claims import first_false, settle_claims
from remac_env.rules.facts import Rules
from remac_env.rules.marks import washed
from remac_env.rules.outcomes import Outcome, Reason, failure
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
    row, after = SKILLS[subtask.skill], world
    if row.goes is not None and world.robots[robot].station != station:
        after = world.with_robot(robot, station=station)
    return SUCCESS, after if row.effect is None else row.effect(rules, after, robot, subtask.target)


def merge(world: WorldState, results: Mapping[str, WorldState]) -> WorldState | None:
    """The world after all robots' changes together, or None when two of them change one thing differently."""
    others = [after for after in results.values() if after is not world]
    if len(others) < 2:
        return others[0] if others else world
    merged = world
    for part in ("robots", "objects", "fixtures"):
        before = getattr(world, part)
        changed: dict[str, object] = {}
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
    data = {field: getattr(world, field) for field in ("robots", "objects", "fixtures")}
    return WorldState(**(data | {part: data[part].with_(name, value)}))


def transition(
    rules: Rules, world: WorldState, subtasks: Mapping[str, Subtask]
) -> tuple[WorldState, dict[str, Outcome]]:
    """One whole round by the table alone: the symbolic backend's step, and what the oracle searches over."""
    refused, stations = settle_claims(rules, world, subtasks)
    outcomes, results = dict(refused), {}
    for robot, subtask in subtasks.items():
        if robot not in refused:
            outcomes[robot], results[robot] = attempt(
                rules, world, robot, subtask, station=stations[robot]
            )
    merged = merge(world, results)
    if merged is None:
        reason: Reason = "blocked"
        clash = {r: failure(reason, "the robots' effects contradict each other") for r in results}
        return world, outcomes | clash
    return washed(rules, merged), outcomes
