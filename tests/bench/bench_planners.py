"""Planners for the tests of the runner: they crash, end their process, or are slow."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path
from typing import Any

from remac_agents.planners.literal import LiteralPlanner


class Crashes:
    """Raises, quoting whatever is in the environment variable of a key."""

    def plan(self, request: Any) -> Any:
        """Never returns."""
        raise ZeroDivisionError("planned by zero with " + os.environ.get("OPENAI_API_KEY", "no key"))


class CrashesOnce(LiteralPlanner):
    """Raises in the first episode that it plans."""

    def __init__(self) -> None:
        self.calls = 0

    def plan(self, request: Any) -> Any:
        """A literal plan, but for the first time."""
        self.calls += 1
        if self.calls == 1:
            raise RuntimeError("not yet")
        return super().plan(request)


class EndsProcess(LiteralPlanner):
    """Ends its process in the kitchen of ODD_SCENE, as a fault in native code would."""

    def plan(self, request: Any) -> Any:
        """A literal plan, but there."""
        if request.scene == os.environ["ODD_SCENE"]:
            os._exit(9)
        return super().plan(request)


class EndsProcessOnce(LiteralPlanner):
    """Ends its process in the kitchen of ODD_SCENE, the first time that any process asks."""

    def plan(self, request: Any) -> Any:
        """A literal plan, but for the first time in the kitchen of ODD_SCENE."""
        mark = Path(os.environ["BENCH_PLANNER_FOLDER"]) / "died"
        if request.scene == os.environ["ODD_SCENE"] and not mark.exists():
            mark.touch()
            os._exit(9)
        return super().plan(request)


class KillsItself(LiteralPlanner):
    """Is killed in the kitchen of ODD_SCENE, as the kernel does when memory runs out."""

    def plan(self, request: Any) -> Any:
        """A literal plan, but there."""
        if request.scene == os.environ["ODD_SCENE"]:
            os.kill(os.getpid(), signal.SIGKILL)
        return super().plan(request)


class Slow(LiteralPlanner):
    """Takes its time."""

    def plan(self, request: Any) -> Any:
        """A literal plan, late."""
        time.sleep(0.2)
        return super().plan(request)
