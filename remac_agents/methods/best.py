"""Equal-budget controls: the best of k+1 tries, with nothing learnt from one to the next."""

from __future__ import annotations

from collections.abc import Callable

from remac_agents.running.method_run import Episode, Turns


def best_of(method: Callable[[Episode], Turns]) -> Callable[[Episode], Turns]:
    """The method anew in each iteration until one succeeds; after that, the first try that did is played again.

    So the last iteration, which is the scored one, succeeds where any of the job's records does. The planner is
    told nothing of earlier tries, and playing again asks no role anything.
    """

    def run(episode: Episode) -> Turns:
        if episode.won is None:
            yield from method(episode)
        else:
            yield from _again(episode)

    return run


def _again(episode: Episode) -> Turns:
    won = episode.won
    if won is None:
        return
    episode.adopt(won.plan)
    episode.ledger.initial, episode.ledger.adjusted = won.initial, won.adjusted
    following = 0
    while not episode.finished:
        following += 1
        yield episode.turn
        episode.advance(again=following in won.retries)
