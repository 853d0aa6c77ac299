"""What holds after every round of every episode, each as a function of what was seen."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from remac_env.rules.facts import Rules
from remac_env.rules.outcomes import REASONS
from remac_env.state import CLOSED_MAX, OPEN_MIN, WorldState
from remac_env.testing import check_world
from remac_env.testing.play import expect

SLACK = 0.03
"""How far, rad or m, a joint may be pressed over its soft limit."""


@dataclass(frozen=True)
class Joint:
    """A joint of a fixture: its position and limits, rad or m."""

    name: str
    position: float
    low: float
    high: float


@dataclass(frozen=True)
class Seen:
    """A round: the worlds before and after it and all that came back. `numbers`: the arrays of the simulation.

    In the symbolic backend there are no joints, numbers or warnings.
    """

    scene: Rules
    before: WorldState
    after: WorldState
    observations: Mapping[str, Mapping[str, Any]]
    spaces: Mapping[str, Any]
    infos: Mapping[str, Mapping[str, Any]]
    joints: tuple[Joint, ...] = ()
    numbers: Mapping[str, Any] = field(default_factory=dict)
    warnings: Mapping[str, int] = field(default_factory=dict)


def look(env: Any, before: WorldState, observations: Any, infos: Any) -> Seen:
    """What is to be seen in an environment after a round, or after the reset."""
    parts: dict[str, Any] = {}
    if env.options.backend == "physics":
        model, data = env._backend.model, env._backend.data
        parts["joints"] = tuple(_joints(env, model, data))
        parts["numbers"] = {name: getattr(data, name).copy() for name in ("qpos", "qvel", "act", "ctrl", "xpos")}
        parts["warnings"] = {f"warning {kind}": int(w.number) for kind, w in enumerate(data.warning)}
    return Seen(env.start.scene, before, env.world, observations, env.observation_spaces, infos, **parts)


def _joints(env: Any, model: Any, data: Any) -> list[Joint]:
    found = []
    for index in range(model.njnt):
        name = model.joint(index).name
        if model.jnt_limited[index] and name.split("/")[0] in env.start.scene.fixtures:
            low, high = model.jnt_range[index]
            found.append(Joint(name, float(data.qpos[model.jnt_qposadr[index]]), float(low), float(high)))
    return found


def objects_are_conserved(seen: Seen) -> None:
    """The same robots, objects and fixtures; each object in one place; hands and held objects agree; equal hashes."""
    for part in ("robots", "objects", "fixtures"):
        names = set(getattr(seen.before, part)) ^ set(getattr(seen.after, part))
        expect(not names, f"{part} came or went: {sorted(names)}")
    check_world(seen.scene, seen.after, where="after the round")


def marks_stay(seen: Seen) -> None:
    """What has happened to an object is never forgotten."""
    for name, item in seen.before.objects.items():
        expect(item.marks <= seen.after.objects[name].marks, f"the {name} lost marks {sorted(item.marks)}")


def doors_and_switches_keep_their_limits(seen: Seen) -> None:
    """Joints of fixtures are within their limits, and doors are called what their angles are."""
    angles: dict[str, list[float]] = {}
    for joint in seen.joints:
        fine = joint.low - SLACK <= joint.position <= joint.high + SLACK
        expect(fine, f"{joint.name} is at {joint.position:.3f}; limits {joint.low:.3f}..{joint.high:.3f}")
        if "door" in joint.name:
            angles.setdefault(joint.name.split("/")[0], []).append(joint.position)
    for name, opened in angles.items():
        told = seen.after.fixtures[name].door
        fine = {"closed": max(opened) <= CLOSED_MAX, "open": max(opened) >= OPEN_MIN, "ajar": max(opened) > CLOSED_MAX}
        expect(told in fine and fine[str(told)], f"the {name} door is called {told} at {opened} rad")


def numbers_are_finite(seen: Seen) -> None:
    """Nothing in the simulation, or in what robots are told, is infinite or no number."""
    for name, values in seen.numbers.items():
        expect(np.isfinite(values).all(), f"{name} is not finite")
    for robot, parts in seen.observations.items():
        for key, values in parts.items():
            expect(np.isfinite(values).all(), f"{key} of {robot} is not finite")


def the_simulator_does_not_warn(seen: Seen) -> None:
    """All of MuJoCo's counters of warnings are zero."""
    raised = {name: count for name, count in seen.warnings.items() if count}
    expect(not raised, f"MuJoCo warned: {raised}")


def observations_lie_in_their_spaces(seen: Seen) -> None:
    """Observation and mask, each in its space; somebody is told something; `wait` is always legal."""
    expect(seen.observations, "nobody was told anything")
    for robot, parts in seen.observations.items():
        expect(seen.spaces[robot].contains(dict(parts)), f"the observation of {robot} is outside its space")
        expect(parts["action_mask"][0] == 1, f"{robot} must not wait")


def outcomes_are_from_the_list(seen: Seen) -> None:
    """Success without a reason, or failure for one of the reasons that there are."""
    for robot, info in seen.infos.items():
        outcome = info["outcome"]
        if not outcome:
            expect(info["round"] == 0, f"{robot} is told no outcome in round {info['round']}")
            continue
        known = ("",) if outcome["status"] == "success" else REASONS
        told = f"{outcome['status']!r}, {outcome['reason']!r}"
        expect(outcome["status"] in ("success", "failure") and outcome["reason"] in known, f"{robot}: {told}")


def refused_robots_stay_as_they_are(seen: Seen) -> None:
    """Who is told that nothing was done still stands where it stood and holds what it held."""
    for robot, info in seen.infos.items():
        reason = info["outcome"].get("reason")
        if reason in ("invalid", "not_at_station", "station_occupied", "hands_full", "hands_empty"):
            stayed = seen.after.robots[robot] == seen.before.robots[robot]
            expect(stayed, f"{robot} was refused ({reason}) and yet is {seen.after.robots[robot]}")


PROPERTIES: tuple[Callable[[Seen], None], ...] = (
    objects_are_conserved,
    marks_stay,
    doors_and_switches_keep_their_limits,
    numbers_are_finite,
    the_simulator_does_not_warn,
    observations_lie_in_their_spaces,
    outcomes_are_from_the_list,
    refused_robots_stay_as_they_are,
)
