"""CC: condition checks. The paper's first stage: check before and after every subtask, adjust, retry."""

from __future__ import annotations

from remac_agents.running.checks import adjust, check_after, check_before
from remac_agents.running.method_run import MethodRun, Turns


def cc(run: MethodRun) -> Turns:
    """Plan once, for all robots, then carry the plan out with checks."""
    run.make_plan(run.briefing.robots)
    yield from checked(run)


def checked(run: MethodRun) -> Turns:
    """The loop of checks around a plan, for one robot or several.

    A false pre-condition changes the rest of the plan, and the pre-conditions of what then comes first are
    checked again. A false post-condition is a failure of execution: the subtask is tried again, its
    pre-conditions first.
    """
    while not run.finished:
        while not run.finished and (failed := check_before(run)):
            adjust(run, failed)
        if run.finished:
            return
        yield run.turn
        check_after(run)
