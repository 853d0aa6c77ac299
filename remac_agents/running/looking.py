"""What the kitchen's answer shows: the view of the roles, and apart from it the truth."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from remac_agents.roles import Report, View
from remac_agents.running.briefing import Briefing
from remac_agents.running.pace import Told, ready, timed
from remac_env.errors import OptionError
from remac_env.quoting import quoted
from remac_env.rules.scene import public_scene
from remac_env.rules.subtasks import Subtask
from remac_env.state import WorldState

NOT_PICTURES = ("observation", "action_mask")


def check_told(obs: object, infos: object, needed: tuple[str, ...] = ()) -> None:
    """Refuse observations and infos that no kitchen gives.

    Args:
        needed: keys of the infos of every robot.

    Raises:
        OptionError: saying what is wrong.
    """
    valid = "valid: those of the kitchen's reset or step"
    if not isinstance(infos, Mapping) or not infos:
        raise OptionError(f"infos {quoted(infos)} name no robot; {valid}")
    if not isinstance(obs, Mapping):
        raise OptionError(f"observations {quoted(obs)} are not valid; {valid}")
    for robot, info in infos.items():
        if not isinstance(info, Mapping):
            raise OptionError(f"infos of {quoted(robot)} {quoted(info)} are not valid; {valid}")
        missing = [key for key in needed if key not in info]
        if missing:
            raise OptionError(f"infos of {quoted(robot)} lack {', '.join(missing)}; {valid}")
    for robot, seen in obs.items():
        if not isinstance(seen, Mapping):
            raise OptionError(f"observations of {quoted(robot)} {quoted(seen)} are not valid; {valid}")


def look(
    obs: Told, infos: Told, briefing: Briefing, sent: Mapping[str, Subtask]
) -> tuple[View, WorldState | None]:
    """What roles see now, and apart from it the truth. `sent`: robot -> the subtask that its report is about."""
    told = infos.get(briefing.lead) or next(iter(infos.values()))
    world: WorldState | None = told.get("world")
    holding = {} if world is None else {name: state.holding for name, state in world.robots.items()}
    images = {
        robot: {name: value for name, value in seen.items() if name not in NOT_PICTURES}
        for robot, seen in obs.items()
    }
    reports = {robot: _report_of(info, sent.get(robot)) for robot, info in infos.items()}
    scene = public_scene(told["scene"])
    view = View(
        briefing.goal, scene, holding, reports, images, text=str(told.get("text", "")), ready=ready(infos),
        unseen=tuple(told.get("unseen", ())),
    )  # fmt: skip
    if timed(infos):
        running = {robot: str(info["running"]) for robot, info in infos.items() if info["running"]}
        slow = {str(what): float(seconds) for what, seconds in told.get("processes", {}).items()}
        view = replace(view, clock=float(told["seconds"]), running=running, slow=slow)
    return view, world


def _report_of(info: Mapping[str, Any], subtask: Subtask | None) -> Report | None:
    outcome = info.get("outcome")
    if not outcome:
        return None
    told_why = info.get("feedback") == "reason"
    reason = (outcome.get("reason") or None) if told_why else None
    return Report(str(outcome["status"]), reason, "" if subtask is None else subtask.text)
