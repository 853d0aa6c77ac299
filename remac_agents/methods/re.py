"""RE: reflective evolvement. CC, iteration after iteration, with a memory of failed pre-conditions."""

from __future__ import annotations

from remac_agents.methods.cc import cc
from remac_agents.running.method_run import MethodRun, Turns


def re(run: MethodRun) -> Turns:
    """One iteration: the memory's lessons go into the plan, and new ones into the memory."""
    run.recall()
    yield from cc(run)
