"""RE: reflective evolvement. CC, iteration after iteration, with a memory of failed pre-conditions."""

from __future__ import annotations

from remac_agents.methods.cc import cc
from remac_agents.running.method_run import Episode, Turns


def re(episode: Episode) -> Turns:
    """One iteration: the memory's lessons go into the plan, and new ones into the memory."""
    episode.recall()
    yield from cc(episode)
