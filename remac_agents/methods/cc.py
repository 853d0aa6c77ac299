"""CC: condition checks. The paper's first stage: check before and after every subtask, adjust, retry."""

from __future__ import annotations

from remac_agents.running.method_run import Episode, Turns


def cc(episode: Episode) -> Turns:
    """Plan once, for all robots, then carry the plan out with checks."""
    episode.make_plan(episode.briefing.robots)
    yield from checked(episode)


def checked(episode: Episode) -> Turns:
    """The loop of checks around a plan, for one robot or several.

    A false pre-condition changes the rest of the plan, and the pre-conditions of what then comes first are
    checked again. A false post-condition is a failure of execution: the subtask is tried again, its
    pre-conditions first.
    """
    while not episode.finished:
        while not episode.finished and (failed := episode.check_before()):
            episode.adjust(failed)
        if episode.finished:
            return
        yield episode.turn
        episode.check_after()
