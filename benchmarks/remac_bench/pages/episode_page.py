"""What an episode's page shows, taken from its record."""

from __future__ import annotations

import json
import shlex
from dataclasses import dataclass
from pathlib import Path

from remac_bench.asked import Asked
from remac_bench.blame.labels import Blame
from remac_bench.judging.endings import ending
from remac_bench.judging.grades import made_from
from remac_bench.pages.gantt import Gantt, draw
from remac_bench.pages.gantt_events import draw_events
from remac_bench.pages.rendering import TEXT_MAX, render
from remac_bench.pages.rounds import ShownRound, alarms_of, round_spans, shown_rounds
from remac_bench.pages.text import slug
from remac_bench.playing.sight import checked_by
from remac_bench.records import Record
from remac_bench.store import VIDEO_PATH

PAGE_MAX = 9_000_000
"""Bytes of a page: mail and browsers take it; pages stay below 10 MB."""

SCRIPTS = ("tables.js", "timeline.js")

LIST_MAX = 400
"""Entries of one list on a page; how many more there are is said."""


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
    def timed(self) -> bool:
        """Whether it was played by the event clock."""
        return self.record.clock == "events"

    @property
    def unit(self) -> str:
        """What `rounds` are."""
        return "Decision" if self.timed else "Round"

    @property
    def result(self) -> str:
        """How it ended, in words."""
        return ending(self.record)

    @property
    def made_from(self) -> str:
        """What a generated task was made from; "" of any other."""
        return made_from(self.record)

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
    *rounds, after = shown_rounds(record, spans, folder)
    drawn = draw_events if record.clock == "events" else draw
    return EpisodePage(
        record=record,
        rounds=tuple(rounds),
        after=after if after.checks or after.exchanges else None,
        gantt=drawn(record, spans, alarms=alarms_of(rounds)),
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


def _video(record: Record, folder: Path) -> str | None:
    """Where the video lies as seen from the page; a record that names a place of its own choosing has none."""
    path = record.video.path if record.video else None
    if path is None or not VIDEO_PATH.fullmatch(path) or not (folder / path).is_file():
        return None
    return f"../{path}"
