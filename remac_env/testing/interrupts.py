"""check_interrupts: a robot that is told to stop ends at a safe pose, and leaves nothing behind."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from remac_env.envs.event_parallel import CONTINUE, STOP
from remac_env.rules.claims import feasible
from remac_env.state import RobotState
from remac_env.testing.play import EnvMaker, Tokens, Turn, expect, opened, play, random_legal

if TYPE_CHECKING:
    from remac_env.envs.parallel import KitchenParallelEnv

LONG = 60.0
"""s in which a robot that was told to stop has stopped: what a skill takes at most."""


@dataclass
class _Told:
    """What a robot was told last: its command's token, where it was and what it held then, and when it was stopped.

    `again`: it was interrupted, and is told the same again, while the others wait.
    """

    token: int = -1
    state: RobotState | None = None
    stopped: float | None = None
    again: bool = False


def check_interrupts(env_fn: EnvMaker, *, seeds: Iterable[int] = (0, 1), steps: int = 80) -> None:
    """Play random legal episodes in which busy robots are told to stop now and then.

    Only who was told to stop is `interrupted`, and soon; it is where it was and holds what it held, so that nothing has
    jumped; and the same command can begin again where the table allows it, so that no claim was left behind.

    Raises:
        ContractError: with the seed, the step and the robot at fault.
    """
    with opened(env_fn) as env:
        for seed in seeds:
            watch = _Watch(env, seed)
            for turn in play(env, seed, watch.choose, rounds=steps):
                watch.look(turn, f"check_interrupts, seed {seed}, step {turn.number}")
            expect(watch.stops, f"check_interrupts, seed {seed}: nobody could be told to stop in {steps} steps")


class _Watch:
    def __init__(self, env: KitchenParallelEnv, seed: int) -> None:
        self._env, self._random = env, random_legal(seed, env.vocabulary)
        self._goes_on, self._stop = env.vocabulary.encode(CONTINUE), env.vocabulary.encode(STOP)
        self._wait = env.vocabulary.encode("wait")
        self._told = {name: _Told() for name in env.possible_agents}
        self._trying: str | None = None
        self.stops = 0

    def choose(self, turn: Turn) -> Tokens:
        """Random tokens; but who was interrupted tries again, where nobody else is at anything."""
        tokens, now = self._random(turn), self._env.world
        ready = [name for name in turn.alive if turn.infos[name]["ready"]]
        again = [name for name in ready if self._told[name].again]
        self._trying = None
        if again and len(ready) == len(turn.alive):
            tokens = dict.fromkeys(turn.alive, self._wait) | {again[0]: self._told[again[0]].token}
            subtask = self._env.vocabulary.subtask(tokens[again[0]])
            self._trying = again[0] if feasible(self._env.start.scene, now, again[0], subtask) else None
        for name in turn.alive:
            if name in ready:
                self._told[name] = _Told(tokens[name], now.robots[name])
            elif tokens[name] == self._stop:
                self.stops += 1
                self._told[name].stopped = turn.infos[name]["seconds"]
        return tokens

    def look(self, turn: Turn, where: str) -> None:
        """What has come of it."""
        for name in turn.alive:
            info, told = turn.infos[name], self._told[name]
            if told.stopped is not None and not info["ready"] and not turn.ended:
                late = info["seconds"] - told.stopped
                expect(late <= LONG, f"{where}, {name}: told to stop {late:g} s ago, and still at {info['running']!r}")
            if not info["outcome"]:
                continue
            if name == self._trying and info["outcome"]["reason"] != "interrupted":
                refused = not info["outcome"]["seconds"] > 1.0 and info["outcome"]["status"] != "success"
                expect(not refused, f"{where}, {name}: after a stop the same is refused: {info['outcome']}")
            if info["outcome"]["reason"] == "interrupted":
                expect(told.stopped is not None, f"{where}, {name}: interrupted, and nobody told it to stop")
                state = self._env.world.robots[name]
                told.again = self._env.vocabulary.decode(told.token) not in ("wait", "done")
                expect(state == told.state, f"{where}, {name}: it was {told.state}, and is {state} when it has stopped")
