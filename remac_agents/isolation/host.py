"""In the process of a job's roles: they are made, and asked, one line after the other."""

from __future__ import annotations

import os
import traceback
from typing import Any

from remac_agents.isolation.codec import dumps, loads
from remac_agents.isolation.lines import Ended, Lines
from remac_agents.roles import StopEpisode
from remac_agents.roles.grants import reads_truth
from remac_agents.text.printable import printable, type_name, words
from remac_agents.wiring.catalogue import VERBS, make_role

OPTIONAL = ("begin_episode", "review")
"""Verbs that a role may have beside those of its protocol."""

FRAMES = 12
"""Frames of a traceback that are told."""

LONGEST = 4_000
"""Characters of an exception's words."""


def serve(lines: Lines, given: dict[str, Any]) -> None:
    """Make the roles, say what they are, and answer; Ended when nobody asks any more."""
    try:
        roles = {name: make_role(name, who) for name, who in given.items()}
        lines.send(dumps({"ready": {name: _described(name, role) for name, role in roles.items()}}))
    except BaseException as error:  # noqa: BLE001 - whatever a stranger raises; it is told
        lines.send(dumps({"raised": told_error(error)}))
        return

    def call(name: str, arguments: list[Any]) -> Any:
        """Ask the other side; it may put questions of its own before it answers."""
        lines.send(dumps({"ask": name, "arguments": arguments}))
        while "answer" not in (told := loads(lines.receive(), call)):
            handle(told)
        return told["answer"]

    def handle(asked: dict[str, Any]) -> None:
        try:
            role, verb = roles[asked["role"]], asked["verb"]
            arguments = [list(each) if isinstance(each, tuple) else each for each in asked["arguments"]]
            line = dumps({"answer": getattr(role, verb)(*arguments, **asked["named"])})
        except Ended:
            raise
        except BaseException as error:  # noqa: BLE001 - the same
            line = dumps({"raised": told_error(error)})
        lines.send(line)

    while True:
        handle(loads(lines.receive(), call))


def told_error(error: BaseException) -> dict[str, Any]:
    """An exception in plain words. `stop`: whether a StopEpisode says that nobody is to blame, None for others."""
    frames = [(frame.f_code, line) for frame, line in traceback.walk_tb(error.__traceback__)][-FRAMES:]
    return {
        "type": type_name(error),
        "message": words(error)[:LONGEST],
        "where": [printable(f"{os.path.basename(c.co_filename)}:{line} in {c.co_name}") for c, line in frames],
        "stop": bool(error.infrastructure) if isinstance(error, StopEpisode) else None,
    }


def _described(name: str, role: Any) -> dict[str, Any]:
    return {
        "class": type_name(role),
        "needs_truth": reads_truth(role),
        "needs_rules": bool(getattr(role, "needs_rules", False)),
        "needs_images": bool(getattr(role, "needs_images", False)),
        "verbs": [*VERBS[name], *(verb for verb in OPTIONAL if callable(getattr(role, verb, None)))],
    }
