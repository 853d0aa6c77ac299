"""Equal-budget controls: the best of k+1 tries, with nothing learnt from one to the next."""

from __future__ import annotations

from collections.abc import Callable

from remac_agents.running.method_run import MethodRun, Turns


def best_of(method: Callable[[MethodRun], Turns]) -> Callable[[MethodRun], Turns]:
    """The method anew in each iteration until one succeeds; after that, the first try that did is played again.

    So the last iteration, which is the scored one, succeeds where any of the job's records does. The planner is
    told nothing of earlier tries, and playing again asks no role anything.
    """

    def best(run: MethodRun) -> Turns:
        if run.won is None:
            yield from method(run)
        else:
            yield from _again(run)

    return best


def _again(run: MethodRun) -> Turns:
    won = run.won
    if won is None:
        return
    run.adopt(won.plan)
    run.book.ledger.initial, run.book.ledger.adjusted = won.initial, won.adjusted
    following = 0
    while not run.finished:
        following += 1
        yield run.turn
        run.advance(again=following in won.retries)
