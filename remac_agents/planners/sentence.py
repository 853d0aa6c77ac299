"""A goal sentence, clause by clause, as the steps that its words name - no more.

    open | close X (door)                     go to X, open or close its door
    pick up O (from ...)                      go to O, pick it up
    place O | it in | into | on | onto | to X  fetch O unless it is in hand, go to X, place it
    keep O out of X                           fetch O, go to an open surface other than X, place it
    turn on | off X, leave X off              go to X, turn it on or off
    season O (with S)                         fetch S, go to O, season it
    <goal verb> O in | on X                   place it there, then the commands that the verb implies
Instead of one object there may be several: "every spoon", "two forks". Of "the pantry or chest" the first is taken.
Clauses that read otherwise give nothing.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from remac_agents.plan import Commands
from remac_agents.planners.common_sense import members, places
from remac_env.rules.scene import PublicScene
from remac_env.rules.subtasks import Subtask
from remac_env.words import normalise

_BREAKS = re.compile(r"\s*(?:[,;.]\s*(?:and then\b|and\b|then\b)?|\band then\b|\band\b|\bthen\b)\s*")
_THING = r"(?:the |a |an |some )?(?P<thing>.+?)"
_PLACE = r"(?:the |a |an |some )?(?P<place>.+?)"
_INTO = r"(?:into|inside|in|onto|on|to)"
_PRONOUNS = ("it", "them", "that")
_AFTER_THAT = " after that"

_DOOR = re.compile(rf"^(?P<way>open|close) {_PLACE}(?: door)?$")
_TAKE = re.compile(rf"^(?:pick up|take|grab|fetch) {_THING}(?: (?:from|off|out of) .+)?$")
_PUT = re.compile(rf"^(?:place|put) {_THING}(?: from .+?)? {_INTO} {_PLACE}$")
_OUT = re.compile(rf"^keep {_THING} out of {_PLACE}$")
_SWITCH = re.compile(rf"^(?:turn|switch) (?P<way>on|off) {_PLACE}$")
_OFF = re.compile(rf"^leave {_PLACE} off$")
_SEASON = re.compile(rf"^season {_THING}(?: with {_PLACE})?$")


class SentenceReader:
    """Turns one sentence into steps. `verbs`: goal verb -> commands that it implies."""

    def __init__(self, facts: PublicScene, commands: Commands, verbs: Mapping[str, tuple[str, ...]]) -> None:
        self._facts, self._commands, self._verbs = facts, commands, verbs
        self._steps: list[Subtask] = []
        self._held: str | None = None
        self._last: tuple[str, ...] = ()

    def read(self, sentence: str) -> list[Subtask]:
        """The steps in word order; those that this kitchen has no command for are left out."""
        self._steps, self._held, self._last = [], None, ()
        for clause in _BREAKS.split(normalise(sentence)):
            self._clause(clause.strip().removesuffix(_AFTER_THAT))
        return [step for step in self._steps if self._commands.allows(step)]

    def _clause(self, clause: str) -> None:
        if match := _DOOR.match(clause):
            self._work(f"{match['way']} door", self._noun(match["place"]))
        elif match := _TAKE.match(clause):
            for thing in self._nouns(match["thing"]):
                self._fetch(thing)
        elif match := _PUT.match(clause):
            self._put(self._nouns(match["thing"]), self._noun(match["place"]))
        elif match := _OUT.match(clause):
            self._put(self._nouns(match["thing"]), self._surface(but=self._noun(match["place"])))
        elif match := _SWITCH.match(clause):
            self._work(f"turn {match['way']}", self._noun(match["place"]))
        elif match := _OFF.match(clause):
            self._work("turn off", self._noun(match["place"]))
        elif match := _SEASON.match(clause):
            self._fetch(self._noun(match["place"] or ""), mention=False)
            for thing in self._nouns(match["thing"]):
                self._work("season", thing)
        else:
            self._goal_verb(clause)

    def _goal_verb(self, clause: str) -> None:
        for verb, implied in {**{verb: after for verb, (_, after) in places().items()}, **self._verbs}.items():
            match = re.match(rf"^{re.escape(verb.lower())} {_THING}(?: {_INTO} {_PLACE})?$", clause)
            if match is None:
                continue
            things = self._nouns(match["thing"])
            several = len(things) > 1 or bool(members(match["thing"], self._facts))
            place = self._noun(match["place"] or "")
            if place is None and (several or verb in places()):
                place = self._where(verb, implied)
            for thing in things or (None,):
                self._put((thing,) if thing else (), place)
                for text in implied:
                    step = self._commands.parse(text)
                    if step is not None:
                        self._work(step.skill, step.target)
            self._last = things or self._last
            return

    def _where(self, verb: str, implied: Sequence[str]) -> str | None:
        """Where a verb is done that names no place: as common sense has it, or where its switch is used."""
        if verb in places():
            return places()[verb][0]
        for text in implied:
            step = self._commands.parse(text)
            if step is None or step.target not in self._facts.fixtures:
                continue
            at = self._facts.stations_of(step.target)
            near = [step.target, *(name for station in at for name in self._facts.used_from(station))]
            return next((name for name in near if self._facts.fixtures[name].room), None)
        return None

    def _surface(self, *, but: str | None) -> str | None:
        """An open surface other than this one."""
        facts = self._facts.fixtures
        options = (n for n, f in facts.items() if f.room and not f.door and not f.switch and n != but)
        return max(options, key=lambda name: facts[name].room, default=None)

    def _noun(self, words: str) -> str | None:
        """The fixture or object that words name, or the last one spoken of for a pronoun; of several the first."""
        return next(iter(self._nouns(words)), None)

    def _nouns(self, words: str) -> tuple[str, ...]:
        if words in _PRONOUNS:
            return self._last
        if words in self._facts.fixtures or words in self._facts.objects:
            return (words,)
        known = (self._nouns(part.removeprefix("the ")) for part in words.split(" or ")) if " or " in words else ()
        first = next((names for names in known if names), ())
        return first or members(words, self._facts)

    def _work(self, skill: str, target: str | None) -> None:
        if target is not None:
            self._steps += [Subtask("navigate to", target), Subtask(skill, target)]

    def _fetch(self, obj: str | None, *, mention: bool = True) -> None:
        if obj is None:
            return
        if self._held != obj:
            self._work("pick up", obj)
        self._held = obj
        self._last = (obj,) if mention else self._last

    def _put(self, objects: Sequence[str], place: str | None) -> None:
        if place is None:
            return
        for obj in objects:
            self._fetch(obj)
            self._work("place to", place)
            self._held = None
        self._last = tuple(objects) or self._last
