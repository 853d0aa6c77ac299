"""A person as planner: what they are shown lies on a table, and what they send is played. Two threads share it."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from remac_agents import Plan, StopEpisode
from remac_agents.plan import MAX_STEPS, Commands
from remac_agents.roles import PlanRequest
from remac_bench.errors import UsageError
from remac_env.rules.subtasks import WAIT

Rows = Mapping[str, Sequence[str]]


@dataclass(frozen=True, kw_only=True)
class Seen:
    """What a person is shown.

    Attributes:
        version: grows whenever anything else changes.
        phase: beginning, asked (it is their turn), playing, recording, ended or broken.
        turn: how often they were asked.
        robots: their names; commands: robot -> what it can be told.
        goal, scene: as planners are told.
        holding: robot -> what it feels in its gripper, "" for nothing.
        rounds: for each round what became of each robot's subtask, as planners are told: (robot, text, whether it is
            known to have failed).
        left: what had been sent and was not played, because something failed before.
        pictures: how many there are; the last one is of now. blind: why there is none of now.
        result, page: at the end, how it ended, and the address of its page.
        problem: what is wrong with the last order, or why nothing goes on.
    """

    version: int = 0
    phase: str = "beginning"
    turn: int = 0
    robots: tuple[str, ...] = ()
    commands: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    goal: str = ""
    scene: str = ""
    holding: Mapping[str, str] = field(default_factory=dict)
    rounds: tuple[tuple[tuple[str, str, bool], ...], ...] = ()
    left: Rows = field(default_factory=dict)
    pictures: int = 0
    blind: str = ""
    result: str = ""
    page: str = ""
    problem: str = ""


class Table:
    """What lies between the person and the episode."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._seen = Seen()
        self._pictures: list[bytes] = []
        self._orders: Rows | None = None
        self._left_alone = False

    @property
    def seen(self) -> Seen:
        """What is shown now."""
        with self._changed:
            return self._seen

    def show(self, **facts: Any) -> None:
        """Change what is shown."""
        with self._changed:
            self._show(**facts)

    def add_picture(self, data: bytes) -> None:
        """Show another picture."""
        with self._changed:
            self._pictures.append(data)
            self._show(pictures=len(self._pictures))

    def picture(self, number: int) -> bytes | None:
        """A picture by its number, from 1; None where there is none."""
        with self._changed:
            return self._pictures[number - 1] if 0 < number <= len(self._pictures) else None

    def order(self, rows: object) -> None:
        """Send subtasks, robot -> commands; nothing for anybody ends the episode.

        Raises:
            UsageError: for what is no order of this kitchen, or comes when nobody was asked; nothing is changed then.
        """
        with self._changed:
            if self._seen.phase != "asked" or self._orders is not None:
                raise UsageError("the last order is still being carried out, or the episode is over")
            self._orders = read_rows(rows, self._seen.commands)
            self._show(phase="playing", left={}, problem="")
            self._changed.notify_all()

    def leave(self) -> None:
        """Nobody will send anything any more."""
        with self._changed:
            self._left_alone = True
            self._changed.notify_all()

    def wait(self) -> Rows:
        """The next order.

        Raises:
            StopEpisode: where nobody will send one.
        """
        with self._changed:
            self._show(phase="asked", turn=self._seen.turn + 1)
            self._changed.wait_for(lambda: self._orders is not None or self._left_alone)
            if self._orders is None:
                raise StopEpisode("the person left before the end", infrastructure=True)
            rows, self._orders = self._orders, None
            return rows

    def _show(self, **facts: Any) -> None:
        self._seen = Seen(**{**vars(self._seen), **facts, "version": self._seen.version + 1})


def read_rows(rows: object, commands: Mapping[str, Sequence[str]]) -> dict[str, list[str]]:
    """Orders as they were sent, robot -> commands.

    Raises:
        UsageError: for anything else than commands of these robots.
    """
    if not isinstance(rows, dict) or not set(rows) <= set(commands):
        raise UsageError(f"orders name robots and their commands; valid robots: {', '.join(commands)}")
    read: dict[str, list[str]] = {}
    for robot, row in rows.items():
        if not isinstance(row, list) or len(row) > MAX_STEPS:
            raise UsageError(f"{robot}: a row is a list of at most {MAX_STEPS} commands")
        known = Commands(commands[robot])
        for entry in row:
            if not isinstance(entry, str) or known.parse(entry) is None:
                raise UsageError(f"{robot}: {known.unknown(entry)}")
        read[robot] = list(row)
    if any(read.values()) and all(text == WAIT.text for row in read.values() for text in row):
        raise UsageError("rounds in which every robot waits change nothing; give one of them something to do")
    return read


class PersonPlanner:
    """Asks whoever sits at the table."""

    needs_truth = needs_rules = False

    def __init__(self, table: Table) -> None:
        self._table = table
        self._sent: Rows = {}
        self._before = 0

    def plan(self, request: PlanRequest) -> Plan:
        """What they send: a long plan or single steps."""
        played = max((each.round for each in request.ran), default=0)
        left = {robot: list(row)[played - self._before :] for robot, row in self._sent.items()}
        failure = [request.failure] if request.failure else []
        self._table.show(
            scene=request.scene,
            holding={robot: held or "" for robot, held in request.holding.items()},
            left={robot: row for robot, row in left.items() if row},
            problem="; ".join(failure),
        )
        self._sent, self._before = self._table.wait(), played
        commands = Commands(request.commands)
        return Plan.of({robot: [commands[text] for text in row] for robot, row in self._sent.items()})


Tell = Callable[[Mapping[str, Any], Mapping[str, int]], None]
"""Is given the infos of a reset or step, and the tokens that led there (none at a reset)."""


class Watched:
    """An agent that tells somebody what became of each round, before the next one is chosen and at the end."""

    def __init__(self, agent: Any, tell: Tell) -> None:
        self._agent, self._tell = agent, tell
        self._sent: Mapping[str, int] | None = None

    def reset(self, observations: Any, infos: Any) -> None:
        """Begin an episode."""
        self._tell(infos, {})
        self._agent.reset(observations, infos)

    def act(self, observations: Any, infos: Any) -> Any:
        """A token for every robot."""
        self._ended(infos)
        self._sent = self._agent.act(observations, infos)
        return self._sent

    def close_episode(self, observations: Any, infos: Any) -> None:
        """End an episode."""
        self._ended(infos)
        self._agent.close_episode(observations, infos)

    def _ended(self, infos: Any) -> None:
        sent, self._sent = self._sent, None
        if infos and sent is not None:
            self._tell(infos, sent)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._agent, name)
