"""BASE: the plan as it is, step after step, without looking."""

from __future__ import annotations

from remac_agents.running.method_run import Episode, Turns


def base(episode: Episode) -> Turns:
    """Carry out the planner's plan for all robots open-loop; a subtask that fails does not stop it."""
    episode.make_plan(episode.briefing.robots)
    yield from open_loop(episode)


def open_loop(episode: Episode) -> Turns:
    """The plan at hand to its end."""
    while not episode.finished:
        yield episode.turn
        episode.advance()
