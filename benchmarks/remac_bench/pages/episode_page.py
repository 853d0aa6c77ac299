"""What an episode's page shows, taken from its record."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from remac_bench.asked import Asked
from remac_bench.blame.labels import Blame
from remac_bench.judging.endings import ending
from remac_bench.pages.gantt import Gantt, draw
from remac_bench.pages.rendering import TEXT_MAX, render
from remac_bench.pages.text import slug
from remac_bench.records import CheckEntry, ExchangeEntry, OutcomeEntry, Record
from remac_bench.sight import checked_by
from remac_bench.store import PICTURES, VIDEOS

PAGE_MAX = 9_000_000
"""Bytes of a page: mail and browsers take it; pages stay below 10 MB."""

SCRIPTS = ("tables.js", "timeline.js")

LIST_MAX = 400
"""Entries of one list on a page; how many more there are is said."""

_VIDEO = re.compile(rf"{VIDEOS}/[A-Za-z0-9_.-]+\.webm")
_DIGEST = re.compile(r"[A-Za-z0-9]{1,128}")


@dataclass(frozen=True, kw_only=True)
class ShownCheck:
    """A verdict beside the truth. `wrong`: they differ."""

    entry: CheckEntry
    when: str

    @property
    def wrong(self) -> bool:
        """Whether the verdict is not the truth; not where either is not known."""
        known = self.entry.truth is not None and self.entry.verdict is not None
        return known and self.entry.truth != self.entry.verdict


@dataclass(frozen=True, kw_only=True)
class ShownExchange:
    """A question to a model with its answer, and the pictures that went with it: links, None for one that is lost."""

    entry: ExchangeEntry
    pictures: tuple[str | None, ...]


@dataclass(frozen=True, kw_only=True)
class ShownRound:
    """All that happened in a round; `number` counts from 0 and is the index of the record's outcomes.

    People count from 1: `ordinal`.
    """

    number: int
    start: float
    end: float
    outcomes: Mapping[str, OutcomeEntry]
    changes: tuple[tuple[str, str, str], ...]
    checks: tuple[ShownCheck, ...]
    exchanges: tuple[ShownExchange, ...]

    @property
    def ordinal(self) -> int:
        """The round's number for people, from 1, as in prompts."""
        return self.number + 1

    @property
    def failed(self) -> bool:
        """Whether a subtask did."""
        return any(outcome.status != "success" for outcome in self.outcomes.values())

    @property
    def wrong(self) -> int:
        """How many verdicts are not the truth."""
        return sum(check.wrong for check in self.checks)


@dataclass(frozen=True, kw_only=True)
class Neighbours:
    """The records of the same job, and the failed episodes before and behind one in the list of episodes."""

    siblings: tuple[Record, ...] = ()
    failed_before: Record | None = None
    failed_behind: Record | None = None


@dataclass(frozen=True, kw_only=True)
class EpisodePage:
    """A page: the record and what is computed from it.

    Attributes:
        siblings: the job's iterations, number and link.
        failed: the failed episodes before and behind it, their title and link.
        again: the command that plays it again.
    """

    record: Record
    rounds: tuple[ShownRound, ...]
    after: ShownRound | None
    gantt: Gantt
    video: str | None
    siblings: tuple[tuple[int, str], ...]
    failed: tuple[tuple[str, str, str], ...]
    again: str
    blame: Blame | None
    options: str

    @property
    def result(self) -> str:
        """How it ended, in words."""
        return ending(self.record)

    @property
    def checker(self) -> str:
        """Who judged the conditions; "" where nobody did."""
        return checked_by(self.record)

    @property
    def unusable(self) -> tuple[str, ...]:
        """What was wrong with answers that could not be used, whichever role gave them."""
        return tuple(text for text in self.record.planner_errors if text not in self.unanswered)

    @property
    def unanswered(self) -> tuple[str, ...]:
        """Why questions to models were not answered."""
        failed = tuple(f"{each.role}: {each.error}: " for each in self.record.exchanges if each.error)
        return tuple(text for text in self.record.planner_errors if failed and text.startswith(failed))

    @property
    def asked(self) -> str:
        """What was asked of models, in words."""
        return Asked.of(self.record.usage, self.record.exchanges).counted

    @property
    def tokens(self) -> int:
        """Of prompts and answers."""
        return self.record.usage.prompt_tokens + self.record.usage.completion_tokens


def page_name(record: Record) -> str:
    """The file name of an episode's page."""
    return f"{slug(record.job)}-{record.iteration}.html"


def page(
    record: Record,
    *,
    folder: Path,
    neighbours: Neighbours | None = None,
    blame: Blame | None = None,
    home: str = "DIR",
) -> str:
    """The page of an episode, below 10 MB: where its texts are too long for that, they lose their middle.

    Args:
        folder: where videos and pictures are looked up.
        neighbours: what else is linked to.
        home: the folder of the record, as the command names it that plays it again.
    """
    limit, view = _fitting(record), _view(record, folder, neighbours or Neighbours(), blame, home)
    while True:
        html = render("episode.html", limit=limit, scripts=SCRIPTS, view=view, record=record, most=LIST_MAX)
        if limit < 100 or len(html.encode("utf-8", "replace")) <= PAGE_MAX:
            return html
        limit //= 4


def _fitting(record: Record) -> int:
    """The longest limit with which the exchanges alone may fit; escaped, they may still be longer."""
    texts = [text for each in record.exchanges for _, text in each.messages]
    lengths = [len(text) for text in (*texts, *(t for each in record.exchanges for t in (each.reply, each.reasoning)))]
    limit = TEXT_MAX
    while limit >= 100 and sum(min(length, limit) for length in lengths) > PAGE_MAX:
        limit //= 4
    return limit


def _view(record: Record, folder: Path, neighbours: Neighbours, blame: Blame | None, home: str) -> EpisodePage:
    spans = round_spans(record)
    rounds = tuple(_round(record, number, span, folder) for number, span in enumerate(spans))
    end = spans[-1][1] if spans else 0.0
    after = _round(record, len(spans), (end, end), folder)
    return EpisodePage(
        record=record,
        rounds=rounds,
        after=after if after.checks or after.exchanges else None,
        gantt=draw(record, spans, alarms=_alarms(rounds)),
        video=_video(record, folder),
        siblings=tuple(sorted((each.iteration, page_name(each)) for each in neighbours.siblings)),
        failed=tuple(
            (word, f"{each.task}, {each.agent}, seed {each.seed}", page_name(each))
            for word, each in (("Previous", neighbours.failed_before), ("Next", neighbours.failed_behind))
            if each is not None
        ),
        again=shlex.join(["remac", "bench", "replay", home, record.job, "--iteration", str(record.iteration)]),
        blame=blame,
        options=json.dumps({"options": record.options, "versions": record.versions}, indent=1, ensure_ascii=False),
    )


def round_spans(record: Record) -> list[tuple[float, float]]:
    """When each round begins and ends, simulated seconds: it is as long as its slowest robot."""
    spans, now = [], 0.0
    for outcomes in record.outcomes:
        begun, now = now, now + max((outcome.seconds for outcome in outcomes.values()), default=0.0)
        spans.append((begun, now))
    return spans


def _round(record: Record, number: int, span: tuple[float, float], folder: Path) -> ShownRound:
    # The checks after a round count it as played; those before it do not.
    before = [ShownCheck(entry=each, when="before") for each in record.pre_checks if each.round == number]
    after = [ShownCheck(entry=each, when="after") for each in record.post_checks if each.round == number + 1]
    worlds = record.worlds[number : number + 2]
    return ShownRound(
        number=number,
        start=span[0],
        end=span[1],
        outcomes=record.outcomes[number] if number < len(record.outcomes) else {},
        changes=tuple(changes(*worlds)) if len(worlds) == 2 else (),
        checks=(*before, *after),
        exchanges=tuple(
            ShownExchange(entry=each, pictures=tuple(_picture(digest, folder) for digest in each.pictures))
            for each in record.exchanges
            if each.round == number
        ),
    )


def _alarms(rounds: Iterable[ShownRound]) -> dict[tuple[int, str], bool]:
    """Round and robot -> whether one of the verdicts that called a condition false there was wrong."""
    alarms: dict[tuple[int, str], bool] = {}
    for each in rounds:
        for check in each.checks:
            if check.entry.verdict is False:
                spot = (each.number, check.entry.robot)
                alarms[spot] = alarms.get(spot, False) or check.wrong
    return alarms


def changes(before: Any, after: Any) -> list[tuple[str, str, str]]:
    """What differs between two worlds as plain values: ("vegetable place", "on counter.5", "held by robot_0")."""
    old, new = dict(_leaves(before)), dict(_leaves(after))
    return [
        (" ".join(path[1:]) or "world", _worded(old.get(path)), _worded(new.get(path)))
        for path in dict.fromkeys([*old, *new])
        if old.get(path) != new.get(path)
    ]


def _leaves(value: Any, path: tuple[str, ...] = ()) -> Iterable[tuple[tuple[str, ...], Any]]:
    if isinstance(value, Mapping) and len(path) < 3:
        for key, inner in value.items():
            yield from _leaves(inner, (*path, str(key)))
    else:
        yield path, value


def _worded(value: Any) -> str:
    if value is None or value == []:
        return "\u2013"
    if isinstance(value, list):
        return " ".join(str(part) for part in value)
    return str(value)


def _video(record: Record, folder: Path) -> str | None:
    """Where the video lies as seen from the page; a record that names a place of its own choosing has none."""
    path = record.video.path if record.video else None
    if path is None or not _VIDEO.fullmatch(path) or not (folder / path).is_file():
        return None
    return f"../{path}"


def _picture(digest: str, folder: Path) -> str | None:
    known = _DIGEST.fullmatch(digest) and (folder / PICTURES / f"{digest}.png").is_file()
    return f"../{PICTURES}/{digest}.png" if known else None
