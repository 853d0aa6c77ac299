"""REFLECT and REFLECT+CC: when a plan has failed, explain why from what was seen, and correct it once."""

from __future__ import annotations

from remac_agents.methods.base import base, open_loop
from remac_agents.methods.cc import cc, checked
from remac_agents.running.hindsight import correct
from remac_agents.running.method_run import Episode, Turns


def reflect(episode: Episode) -> Turns:
    """Open-loop; who is still asked after that has failed: one corrected plan, open-loop again."""
    yield from base(episode)
    if correct(episode):
        yield from open_loop(episode)


def reflect_cc(episode: Episode) -> Turns:
    """The same with the checks of CC around both plans."""
    yield from cc(episode)
    if correct(episode):
        yield from checked(episode)
