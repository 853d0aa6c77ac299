"""One running episode under the event clock: who is at what, and what each robot is told of it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from remac_env.backends.base import Counters
from remac_env.episode import End, Episode
from remac_env.events.clock import EventClock
from remac_env.events.processes import Key, in_words
from remac_env.rules.facts import Process
from remac_env.rules.outcomes import Outcome
from remac_env.rules.processes import spoilt
from remac_env.state import WorldState


@dataclass
class Decision:
    """A robot's last decision: when it was, s on the clock, what has been gained since, and how many it has made."""

    at: float = 0.0
    gained: float = 0.0
    count: int = 0


@dataclass
class EventEpisode(Episode):
    """The changeable side, looked at in decision points; `rounds` counts them.

    Attributes:
        clock: runs the kitchen from one decision point to the next.
        continues: the token of a robot that is busy.
        stops: the token that stops one; None where that may not be.
    """

    clock: EventClock = field(kw_only=True)
    continues: int = field(kw_only=True)
    stops: int | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        """Nobody has decided anything yet."""
        super().__post_init__()
        self._told = (-1, "")
        self._of_clock: dict[str, Any] = {} if self.stops is None else {"stop": self.stops}
        self._of_clock |= dict.fromkeys(("ready", "running", "elapsed", "tau", "return", "decision"))
        self._of_clock |= {"continue": self.continues, "max_seconds": float(self.terms.max_seconds), "processes": None}
        self._decisions = {robot: Decision() for robot in self.terms.scene.robots}

    def decided(self, robots: Iterable[str]) -> None:
        """These robots, which are ready, decide now."""
        now = self.clock.now
        for robot in robots:
            last = self._decisions[robot]
            last.at, last.gained, last.count = now, 0.0, last.count + 1

    def arrive(self, world: WorldState, outcomes: Mapping[str, Outcome], counters: Counters) -> None:
        """Take over a decision point, and judge it."""
        self.world, self.outcomes, self.counters = world, dict(outcomes), counters
        self.seconds, self.done = self.clock.now, self.clock.done
        self.look()

    def gain(self, reward: float) -> None:
        """Every robot gains what this decision point is worth."""
        for decision in self._decisions.values():
            decision.gained += reward

    @property
    def out_of_time(self) -> bool:
        """Whether the episode is as long as it may be."""
        return self.clock.over

    def _alike(self) -> dict[str, Any]:
        return super()._alike() | self._of_clock

    def _own(self, robot: str) -> dict[str, Any]:
        doing, now, last = self.clock.doing(robot), self.seconds, self._decisions[robot]
        told = super()._own(robot)
        told["ready"] = doing is None and self.end is None
        told["running"] = "" if doing is None else doing.text
        told["elapsed"] = 0.0 if doing is None else round(now - doing.since, 6)
        told["tau"] = round(now - last.at, 6)
        told["return"] = float(last.gained)
        told["decision"] = last.count
        told["processes"] = in_words(self._slow, now) if self.terms.scene.processes else {}
        return told

    @property
    def shares(self) -> dict[Key, float]:
        """What takes its time by itself, and which share of it is over, 0..1."""
        now = self.clock.now
        return {key: min(1.0, (now - since) / key[0].seconds) for key, since in self._slow.items()}

    @property
    def _slow(self) -> dict[Key, float]:
        """What goes on by itself and can be seen: of what nobody has seen it would tell where that is."""
        unseen = self.unseen
        return {key: since for key, since in self.clock.processes.items() if key[1] not in unseen}

    def _judge(self) -> End | None:
        """What is spoilt is lost, whatever else holds."""
        terms = self.terms
        if terms.scene.processes and spoilt(terms.scene, self.world, terms.goal.names()):
            return "lost"
        return super()._judge()

    def _text(self, robot: str) -> str:
        if self._told[0] != self.rounds:
            self._told = (self.rounds, "\n".join(self._of_time(self.seconds)))
        return f"{super()._text(robot)}\n{self._told[1]}"

    def _of_time(self, now: float) -> list[str]:
        """What all robots are told of time at a decision point."""
        lines = [f"The clock shows {now:g} of {self.terms.max_seconds:g} s."]
        for name in self.terms.scene.robots:
            doing = self.clock.doing(name)
            if doing is not None:
                lines.append(f"{name}: {doing.text}, for {now - doing.since:g} s so far.")
        if self.terms.scene.processes:
            slow = self._slow.items()
            lines += [f"{_sentence(process, name)}, for {now - since:g} s so far." for (process, name), since in slow]
            lines += [f"The {name} is {mark}." for name, mark in self._marked()]
        return lines

    def _marked(self) -> list[tuple[str, str]]:
        """What has come of processes: objects and their marks."""
        slow = self.terms.scene.slow
        return [(name, mark) for name, item in self.world.objects.items() for mark in sorted(item.marks & slow)]


def _sentence(process: Process, name: str) -> str:
    text = process.text.format(name)
    return text[0].upper() + text[1:]
