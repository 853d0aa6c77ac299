"""BASE: the plan as it is, step after step, without looking."""

from __future__ import annotations

from remac_agents.running.method_run import MethodRun, Turns


def base(run: MethodRun) -> Turns:
    """Carry out the planner's plan for all robots open-loop; a subtask that fails does not stop it."""
    run.make_plan(run.briefing.robots)
    yield from open_loop(run)


def open_loop(run: MethodRun) -> Turns:
    """The plan at hand to its end."""
    while not run.finished:
        yield run.turn
        run.advance()
