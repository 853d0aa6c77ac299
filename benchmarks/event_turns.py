"""The loop by which scripts carry out a plan of their own under the event clock."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from remac_env.rules.subtasks import WAIT

Infos = Mapping[str, Mapping[str, Any]]
Choose = Callable[[Sequence[str], Infos], Mapping[str, int]]
"""From the robots that are ready and the infos, the tokens of those that begin something; the others wait."""


def turns(env: Any, infos: Infos, choose: Choose) -> Iterator[Infos]:
    """Run an episode that has been reset from decision point to decision point, to its end; the infos of each."""
    wait, goes_on = env.vocabulary.encode(WAIT.text), env.vocabulary.encode("continue")
    while env.agents:
        ready = [robot for robot in env.agents if infos[robot]["ready"]]
        tokens = {**dict.fromkeys(env.agents, goes_on), **dict.fromkeys(ready, wait), **choose(ready, infos)}
        _, _, _, _, infos = env.step(tokens)
        yield infos
