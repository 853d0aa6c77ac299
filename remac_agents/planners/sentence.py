"""A goal sentence, clause by clause, as the steps that its words name - no more.

    open | close X (door)                     go to X, open or close its door
    pick up O (from ...)                      go to O, pick it up
    place O | it in | into | on | onto | to X  fetch O unless it is in hand, go to X, place it
    turn on | off X                           go to X, turn it on or off
    season O (with S)                         fetch S, go to O, season it
    <goal verb> O in | on X                   place it there, then the commands that the verb implies
Clauses that read otherwise give nothing.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from remac_agents.plan import Commands
from remac_env.rules.scene import PublicScene
from remac_env.rules.subtasks import Subtask
from remac_env.words import normalise

_BREAKS = re.compile(r"\s*(?:[,;.]\s*(?:and then\b|and\b|then\b)?|\band then\b|\band\b|\bthen\b)\s*")
_THING = r"(?:the |a |an |some )?(?P<thing>.+?)"
_PLACE = r"(?:the |a |an |some )?(?P<place>.+?)"
_INTO = r"(?:into|inside|in|onto|on|to)"
_PRONOUNS = ("it", "them", "that")

_DOOR = re.compile(rf"^(?P<way>open|close) {_PLACE}(?: door)?$")
_TAKE = re.compile(rf"^(?:pick up|take|grab|fetch) {_THING}(?: (?:from|off|out of) .+)?$")
_PUT = re.compile(rf"^(?:place|put) {_THING}(?: from .+?)? {_INTO} {_PLACE}$")
_SWITCH = re.compile(rf"^(?:turn|switch) (?P<way>on|off) {_PLACE}$")
_SEASON = re.compile(rf"^season {_THING}(?: with {_PLACE})?$")


class SentenceReader:
    """Turns one sentence into steps. `verbs`: goal verb -> commands that it implies."""

    def __init__(self, facts: PublicScene, commands: Commands, verbs: Mapping[str, tuple[str, ...]]) -> None:
        self._facts, self._commands, self._verbs = facts, commands, verbs
        self._steps: list[Subtask] = []
        self._held: str | None = None
        self._last: str | None = None

    def read(self, sentence: str) -> list[Subtask]:
        """The steps in word order; those that this kitchen has no command for are left out."""
        self._steps, self._held, self._last = [], None, None
        for clause in _BREAKS.split(normalise(sentence)):
            self._clause(clause.strip())
        return [step for step in self._steps if self._commands.allows(step)]

    def _clause(self, clause: str) -> None:
        if match := _DOOR.match(clause):
            self._work(f"{match['way']} door", self._noun(match["place"]))
        elif match := _TAKE.match(clause):
            self._fetch(self._noun(match["thing"]))
        elif match := _PUT.match(clause):
            self._put(self._noun(match["thing"]), self._noun(match["place"]))
        elif match := _SWITCH.match(clause):
            self._work(f"turn {match['way']}", self._noun(match["place"]))
        elif match := _SEASON.match(clause):
            self._fetch(self._noun(match["place"] or ""), mention=False)
            self._work("season", self._noun(match["thing"]))
        else:
            self._goal_verb(clause)

    def _goal_verb(self, clause: str) -> None:
        for verb, implied in self._verbs.items():
            match = re.match(rf"^{re.escape(verb.lower())} {_THING}(?: {_INTO} {_PLACE})?$", clause)
            if match is None:
                continue
            self._put(self._noun(match["thing"]), self._noun(match["place"] or ""))
            for text in implied:
                step = self._commands.parse(text)
                if step is not None:
                    self._work(step.skill, step.target)
            return

    def _noun(self, words: str) -> str | None:
        """The fixture or object that words name, or the last one spoken of for a pronoun."""
        if words in _PRONOUNS:
            return self._last
        return words if words in self._facts.fixtures or words in self._facts.objects else None

    def _work(self, skill: str, target: str | None) -> None:
        if target is not None:
            self._steps += [Subtask("navigate to", target), Subtask(skill, target)]

    def _fetch(self, obj: str | None, *, mention: bool = True) -> None:
        if obj is None:
            return
        if self._held != obj:
            self._work("pick up", obj)
        self._held = obj
        self._last = obj if mention else self._last

    def _put(self, obj: str | None, place: str | None) -> None:
        if obj is None or place is None:
            return
        self._fetch(obj)
        self._work("place to", place)
        self._held = None
