"""A planner's request as JSON, for planners in other processes and languages. The truth is never part of it."""

from __future__ import annotations

import base64
import struct
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remac_agents.roles.accounts import Attempt, PreviousTry, Ran
from remac_agents.roles.requests import PlanRequest


def as_json(request: PlanRequest, iteration: int = 0) -> dict[str, Any]:
    """The request as values that json.dumps takes; images are PNG files in base64."""
    images = {
        robot: {camera: base64.b64encode(png(picture)).decode() for camera, picture in seen.items()}
        for robot, seen in request.images.items()
    }
    return {
        "goal": request.goal,
        "scene": request.scene,
        "robots": list(request.robots),
        "lead": request.lead,
        "commands": list(request.commands),
        "reflections": list(request.reflections),
        "previous_plan": _rows(request.previous_plan),
        "previous": _previous(request.previous),
        "executed": _rows(request.executed),
        "ran": [_ran(ran) for ran in request.ran],
        "failure": request.failure,
        "repairs": [{"answer": repair.answer, "problems": list(repair.problems)} for repair in request.repairs],
        "holding": dict(request.holding),
        "history": [_attempt(attempt) for attempt in request.history],
        "single_step": request.single_step,
        "explanation": request.explanation,
        "events": list(request.events),
        "question": request.question,
        "skills": {robot: list(skills) for robot, skills in request.skills.items()},
        "subtasks": [dict(subtask) for subtask in request.subtasks],
        "teammates": dict(request.teammates),
        "slow": dict(request.slow),
        "verbs": {verb: list(commands) for verb, commands in request.verbs.items()},
        "episode": {str(key): value for key, value in request.episode.items() if _plain(value)},
        "iteration": iteration,
        "images": images,
    }


def png(picture: NDArray[np.uint8]) -> bytes:
    """A picture, uint8 of shape (height, width, 3), as a PNG file."""
    height, width = picture.shape[:2]
    rows = np.ascontiguousarray(picture, dtype=np.uint8).reshape(height, width * 3)
    filtered = np.concatenate([np.zeros((height, 1), np.uint8), rows], axis=1)  # filter 0 on every row
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    parts = ((b"IHDR", header), (b"IDAT", zlib.compress(filtered.tobytes(), 6)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(name, data) for name, data in parts)


def _chunk(name: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def _rows(plan: Any) -> dict[str, list[str]] | None:
    return None if plan is None else {robot: list(row) for robot, row in plan.items()}


def _previous(previous: PreviousTry | None) -> dict[str, Any] | None:
    if previous is None:
        return None
    return {
        "plan": _rows(previous.plan),
        "success": previous.success,
        "rounds": previous.rounds,
        "changed": previous.changed,
        "ran": [_ran(ran) for ran in previous.ran],
    }


def _ran(ran: Ran) -> dict[str, Any]:
    return {
        "round": ran.round,
        "robot": ran.robot,
        "command": ran.command,
        "succeeded": ran.succeeded,
        "reason": ran.reason,
    }


def _attempt(attempt: Attempt) -> dict[str, Any]:
    return {
        "robot": attempt.robot,
        "command": attempt.subtask.text,
        "ran": attempt.ran,
        "succeeded": attempt.succeeded,
        "reason": attempt.reason,
        "false": [condition.sentence for condition in attempt.false],
    }


def _plain(value: object) -> bool:
    return value is None or isinstance(value, str | int | float | bool)
