"""Calibrates a network that judges pictures, on kitchens kept for that, and measures it on others."""

from __future__ import annotations

import itertools
from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from remac_agents.vision.network import ANSWERS, CAMERAS, Network, likely
from remac_agents.vision.questions import RARE, Question, kinds_of, opposed, predicates
from remac_agents.vision.weights import About
from remac_bench.learning.checker_files import Album, answers

Floats = NDArray[np.float64]

FALSE_ALARMS, MISSES = 0.01, 0.02
"""Shares of true and of false conditions that may be judged wrongly, by which the least probabilities are found.

Where a predicate has an opposite, which is asked by the same question, either answer may be a false alarm.

Of a kind of question with so few rows that one would be more than its share the wider kind's are taken: that none of
thirty was judged wrongly says little of the next hundred. But with SOME rows a kind has its own if none of them would
be judged wrongly by one that is lower by MARGIN. A false alarm repeats or changes what was right, again and again; what
is missed is met by the next check.
"""

SOME, MARGIN = 30, 0.1

LEAST_ALARM = 0.8
"""The probability from which on an answer that may be an alarm is given at least, whatever the pictures say.

In play nearly all that is asked is true: of 32 answers "false" that were less sure, 29 were wrong (48 episodes with
learned skills on seeds from 160,000 on).
"""

NEVER = 1.5
"""In place of a least probability: no answer of this kind is given."""

_LEVELS = (0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.93, 0.95, 0.97, 0.98, 0.99, 0.995, 0.998)
_WARMTHS = tuple(float(value) for value in np.geomspace(0.4, 5.0, 40))


@dataclass(frozen=True, eq=False)
class Judged:
    """Rows of an album with the network's logits (m, 3). `known`: whether it could be asked at all."""

    album: Album
    logits: Floats
    known: NDArray[np.bool_]

    def likely(self, temperature: float) -> Floats:
        """How likely true, false and hidden are, (m, 3)."""
        return likely(self.logits, temperature)


def judge(network: Network, album: Album) -> Judged:
    """Put every question of an album to a network."""
    rows, texts = album.rows, album.texts
    logits, known = np.zeros((len(rows), len(ANSWERS))), np.zeros(len(rows), bool)
    first = np.searchsorted(rows[:, 0], np.arange(len(album.station) + 1))
    for view in range(len(album.station)):
        span = range(first[view], first[view + 1])
        named = {row: tuple(texts[number] for number in rows[row, 2:4] if texts[number]) for row in span}
        asked = {row: Question(texts[rows[row, 1]], names) for row, names in named.items()}
        fine = [row for row, question in asked.items() if not network.words.unknown(question)]
        if fine:
            cells = network.look({camera: getattr(album, camera)[view] for camera in CAMERAS})
            held = texts[album.view_facts[view, 1]]
            logits[fine], known[fine] = network.answer(cells, [asked[row] for row in fine], held), True
    return Judged(album, logits, known)


def warmth(judged: Judged) -> float:
    """The temperature at which the probabilities fit what is right best; rare answers count more than they come."""
    right = answers(judged.album)
    weight = 1.0 / np.sqrt(np.bincount(_kinds(judged.album))[_kinds(judged.album)]) * judged.known

    def loss(temperature: float) -> float:
        chosen = judged.likely(temperature)[np.arange(len(right)), right]
        return float(-(weight * np.log(np.maximum(chosen, 1e-9))).sum() / weight.sum())

    return min(_WARMTHS, key=loss)


def least(judged: Judged, temperature: float, common: Collection[str]) -> dict[str, tuple[float, float]]:
    """Kind of question -> the probabilities from which on "true" and "false" is said, so that few are wrong.

    Every predicate has them, alone and with what was rarely met. A kind with few rows takes what the wider one has.
    """
    likely, true = judged.likely(temperature), judged.album.rows[:, 4] == 1
    told = judged.known & (judged.album.rows[:, 5] == 1)
    questions, which = _questions(judged.album)
    kinds = [kinds_of(question, common) for question in questions]

    def levels(predicate: str, own: NDArray[np.bool_], wider: tuple[float, float]) -> tuple[float, float]:
        alarm = predicate in opposed()
        wrong = [likely[own & (true == bool(answer)), answer] for answer in (0, 1)]
        yes = _level(wrong[0], FALSE_ALARMS if alarm else MISSES, wider[0])
        no = _level(wrong[1], FALSE_ALARMS, wider[1])
        return max(yes, LEAST_ALARM) if alarm else yes, max(no, LEAST_ALARM)

    def of(kind: str) -> NDArray[np.bool_]:
        return told & np.array([kind in each for each in kinds])[which]

    every = levels("", told, (NEVER, NEVER))
    names = predicates()
    found = {kind: levels(name, of(kind), every) for name in names for kind in (name, f"{name} {RARE}")}
    for question, each in zip(questions, kinds, strict=True):
        for kind, wider in reversed(list(itertools.pairwise(each))):
            found[kind] = found.get(kind) or levels(question.predicate, of(kind), found[wider])
    return found


def _level(wrong: Floats, bound: float, wider: float) -> float:
    """The least probability of an answer, from its probabilities (n,) where it is wrong; see FALSE_ALARMS.

    Args:
        bound: the share of them that may get it. wider: that of the wider kind.
    """
    if len(wrong) * bound >= 1.0:
        return next((level for level in _LEVELS if float((wrong >= level).mean()) <= bound), NEVER)
    if len(wrong) >= SOME:
        return min(wider, next((level for level in _LEVELS if float(wrong.max()) < level - MARGIN), NEVER))
    return wider


def measure(judged: Judged, about: About, *, asked_only: bool = False) -> dict[str, dict[str, float]]:
    """Predicate -> how it was judged: counts, by the names of the columns that `remac learn evaluate-checker` prints.

    Keys: "true", "false": conditions that the pictures tell, by truth; "right true", "right false": of these, judged
    so; "wrong true", "wrong false": judged true though false, and the other way round; "hidden": conditions that the
    pictures do not tell; "hidden told": of these, judged all the same; "hidden wrong": of these, wrongly.
    """
    rows, likely = judged.album.rows, judged.likely(about.temperature)
    asked = np.array(judged.album.texts)[rows[:, 1]]
    true, shown = rows[:, 4] == 1, rows[:, 5] == 1
    put = judged.known & ((rows[:, 6] == 1) | (not asked_only))
    questions, which = _questions(judged.album)
    level = np.array([about.levels(question) for question in questions])[which]
    yes = put & (likely[:, 0] >= np.maximum(level[:, 0], likely[:, 1]))
    no = put & ~yes & (likely[:, 1] >= level[:, 1])
    wanted = (rows[:, 6] == 1) | (not asked_only)
    found = {}
    for predicate in sorted(set(asked[wanted])):
        own = wanted & (asked == predicate)
        hidden, wrong = own & ~shown, (yes & ~true) | (no & true)
        parts = {
            "true": own & shown & true, "false": own & shown & ~true,
            "right true": own & shown & true & yes, "right false": own & shown & ~true & no,
            "wrong true": own & shown & ~true & yes, "wrong false": own & shown & true & no,
            "hidden": hidden, "hidden told": hidden & (yes | no), "hidden wrong": hidden & wrong,
        }  # fmt: skip
        found[str(predicate)] = {name: float(part.sum()) for name, part in parts.items()}
    return found


def _questions(album: Album) -> tuple[list[Question], NDArray[np.int64]]:
    """Every question of an album once, and which of them each row puts."""
    every, which = np.unique(album.rows[:, 1:4], axis=0, return_inverse=True)
    texts = [[album.texts[number] for number in row if album.texts[number]] for row in every]
    return [Question(predicate, tuple(names)) for predicate, *names in texts], which.ravel()


def _kinds(album: Album) -> NDArray[np.int64]:
    return np.asarray(album.rows[:, 1].astype(np.int64) * len(ANSWERS) + answers(album))
