"""Plays a record again: the worlds it went through, and what the skill table alone would have made of each round."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from remac_agents.plan import Commands
from remac_bench.judging.episodes import RESTING
from remac_bench.playing.extensions import check_body
from remac_bench.playing.timing import odd_token
from remac_bench.records import OutcomeEntry, Record
from remac_env.errors import UnknownNameError
from remac_env.oracle import Certificate, certify, solve
from remac_env.rules.facts import Rules
from remac_env.rules.outcomes import Outcome
from remac_env.rules.rounds import transition
from remac_env.rules.subtasks import WAIT, Subtask
from remac_env.state import WorldState
from remac_env.tasks.goals import Goal

Joint = Mapping[str, Subtask]


@dataclass(frozen=True, kw_only=True)
class ReplayedRound:
    """One round as it was played again.

    Attributes:
        joint: robot -> its subtask; `wait` for a token that named none.
        before, after: the worlds at rest.
        expected, table: what the skill table says of the same subtasks in the same world: outcomes, and the world.
        outcomes: how they ended.
    """

    joint: Joint
    before: WorldState
    after: WorldState
    expected: Mapping[str, Outcome]
    table: WorldState
    outcomes: Mapping[str, OutcomeEntry]


@dataclass(frozen=True, kw_only=True)
class Replay:
    """An episode that was played again.

    Attributes:
        scene, goal, start: what the kitchen was, what was wanted, and the world at the start.
        commands: the subtasks that this kitchen knows.
        faithful: it began and went as the record says.
        rounds: what was played; where it is not faithful, only up to the difference.
    """

    scene: Rules
    commands: Mapping[str, Subtask]
    goal: Goal
    start: WorldState
    rounds: tuple[ReplayedRound, ...]
    faithful: bool

    @property
    def end(self) -> WorldState:
        """The world after the last round."""
        return self.rounds[-1].after if self.rounds else self.start

    def world(self, index: int) -> WorldState:
        """The world before round `index`."""
        return self.rounds[index].before if index < len(self.rounds) else self.end

    def certify(self, world: WorldState, *, max_rounds: int) -> Certificate:
        """What is known of the shortest plan from there."""
        return certify(self.scene, world, self.goal, max_rounds=max_rounds)

    def carry_out(self, plan: Sequence[Joint], world: WorldState) -> int | None:
        """Rounds after which the goal holds if every skill does what the table says; None if it never does."""
        for done, joint in enumerate(plan, start=1):
            world, _ = transition(self.scene, world, {robot: joint.get(robot, WAIT) for robot in self.scene.robots})
            if self.goal.holds(self.scene, world):
                return done
        return None


def play_again(record: Record) -> Replay:
    """Re-execute a record's subtasks from its seed, in the backend that it was played in.

    Raises:
        UnknownNameError, OptionError: if the record's task or options do not exist here.
    """
    with _kitchen(record) as env:
        begun = record.digest in (None, env.start.digest)
        rounds, faithful = _re_execute(env, record.outcomes if begun else ())
        return Replay(
            scene=env.start.scene,
            commands=_commands(env),
            goal=env.goal,
            start=rounds[0].before if rounds else env.world,
            rounds=tuple(rounds),
            faithful=begun and faithful,
        )


def rescue(record: Record, index: int) -> bool:
    """Whether the oracle's steps, from round `index` on, still reach the goal in the rounds that were left.

    The episode is re-executed up to that round in its own backend; from there a search that knows the truth finds
    each step anew where the last one did not do what the table says.
    """
    with _kitchen(record) as env:
        _re_execute(env, record.outcomes[:index])
        plan: list[Joint] = []
        expected: WorldState | None = None
        left = int(env.options.max_rounds) - index
        while env.agents and left > 0:
            if not plan or env.world != expected:
                found = solve(env.start.scene, env.world, env.goal, max_rounds=left)
                plan = [] if found is None else list(found.rounds)
            if not plan:
                return False
            joint = plan.pop(0)
            expected, _ = transition(env.start.scene, env.world, joint)
            env.step({robot: env.vocabulary.encode(joint[robot].text) for robot in env.agents})
            left -= 1
        return bool(env.goal.holds(env.start.scene, env.world))


def rounds_of(plan: Mapping[str, Sequence[str]], replay: Replay) -> list[Joint]:
    """A record's plan as rounds; texts that this kitchen does not know wait."""
    length = max((len(row) for row in plan.values()), default=0)
    rows = {robot: row for robot, row in plan.items() if robot in replay.scene.robots}
    return [
        {robot: replay.commands.get(row[at], WAIT) if at < len(row) else WAIT for robot, row in rows.items()}
        for at in range(length)
    ]


def _commands(env: Any) -> Mapping[str, Subtask]:
    return Commands(env.vocabulary.commands(env.start.scene))


@contextmanager
def _kitchen(record: Record) -> Iterator[Any]:
    """The kitchen of the record, at its start."""
    import remac_env

    options = {**record.options.get("kitchen", {}), "render_mode": None, "obs": "state"}
    options = {"backend": record.backend, "starts": record.starts, **options, "robots": record.robots}
    check_body(options)
    env = remac_env.parallel_env(record.task, **options)
    try:
        env.reset(seed=record.seed)
        yield env
    finally:
        env.close()


def _re_execute(env: Any, played: Sequence[Mapping[str, OutcomeEntry]]) -> tuple[list[ReplayedRound], bool]:
    rounds: list[ReplayedRound] = []
    commands = _commands(env)
    for outcomes in played:
        if set(outcomes) != set(env.agents):
            return rounds, False
        tokens = {robot: _token(env, entry.subtask) for robot, entry in outcomes.items()}
        joint = {robot: commands.get(entry.subtask, WAIT) for robot, entry in outcomes.items()}
        before = env.world
        table, expected = transition(env.start.scene, before, joint)
        _, _, _, _, infos = env.step(tokens)
        rounds.append(
            ReplayedRound(
                joint=joint, before=before, after=env.world, expected=expected, table=table, outcomes=outcomes
            )
        )
        now = {r: (i["outcome"].get("status"), i["outcome"].get("reason")) for r, i in infos.items()}
        if any(now[robot] != (entry.status, entry.reason or "") for robot, entry in outcomes.items()):
            return rounds, False
    return rounds, True


def _token(env: Any, text: str) -> int:
    """The token of a command, or the one that named nothing."""
    if (number := odd_token(text)) is not None:
        return number
    try:
        return int(env.vocabulary.encode(text))
    except UnknownNameError:
        return -1


def is_work(entry: OutcomeEntry) -> bool:
    """Whether a robot was told to do something."""
    return entry.subtask not in RESTING
