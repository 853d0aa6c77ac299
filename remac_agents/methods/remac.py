"""REMAC: RE by one robot until its plan succeeds as it is; then a second one takes over prerequisites."""

from __future__ import annotations

from remac_agents.episode import Episode, Turns
from remac_agents.methods.cc import checked


def remac(episode: Episode) -> Turns:
    """One iteration, alone or, once the task is mastered alone, as a team."""
    episode.recall()
    helper, single = episode.briefing.helper, episode.proven_plan()
    if helper is None or single is None or not episode.hand_over(single, helper):
        episode.make_plan()
    yield from checked(episode)
