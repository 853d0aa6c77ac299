"""REFLECT and REFLECT+CC: when a plan has failed, explain why from what was seen, and correct it once."""

from __future__ import annotations

from remac_agents.methods.base import base, open_loop
from remac_agents.methods.cc import cc, checked
from remac_agents.running.hindsight import correct
from remac_agents.running.method_run import MethodRun, Turns


def reflect(run: MethodRun) -> Turns:
    """Open-loop; who is still asked after that has failed: one corrected plan, open-loop again."""
    yield from base(run)
    if correct(run):
        yield from open_loop(run)


def reflect_cc(run: MethodRun) -> Turns:
    """The same with the checks of CC around both plans."""
    yield from cc(run)
    if correct(run):
        yield from checked(run)
