"""`remac view`: the pages of a folder, made from its records when they are asked for, while a run goes on or after."""

from __future__ import annotations

import re
import shlex
import threading
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Route

from remac_bench import judging
from remac_bench.blame.sheet import read_blames
from remac_bench.board import Board
from remac_bench.errors import RecordFileError
from remac_bench.judging.endings import ending
from remac_bench.live.tail import Tail
from remac_bench.pages.episode_page import page_name
from remac_bench.pages.leaderboard import leaderboard
from remac_bench.pages.pictures import png, svg
from remac_bench.pages.rendering import render
from remac_bench.pages.text import visible
from remac_bench.pages.writing import EpisodePages
from remac_bench.records import Record
from remac_bench.store import PICTURES, VIDEOS

_FILES = {VIDEOS: re.compile(r"[A-Za-z0-9_.-]+\.webm"), PICTURES: re.compile(r"[A-Za-z0-9]+\.png")}
"""What is served from the folder: names as the runner makes them, and nothing else."""


@dataclass(frozen=True)
class Made:
    """What was made of the records at one moment."""

    board: Board
    leaderboard: str
    episodes: EpisodePages


class View:
    """The pages of one folder. Nothing is written."""

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        self._tail, self._lock = Tail(folder), threading.Lock()
        self._made: Made | None = None
        self._stamp = ""

    @property
    def app(self) -> Starlette:
        """The application."""
        routes = [
            Route("/", self.leaderboard),
            Route("/leaderboard.html", self.leaderboard),
            Route("/progress", self.progress),
            Route("/favicon.ico", lambda request: Response(status_code=204)),
            Route("/episodes/{name}", self.episode),
            Route("/tables/{name}", self.table),
            Route("/{kind}/{name}", self.file),
        ]
        return Starlette(routes=routes, exception_handlers={RecordFileError: _unreadable})

    def leaderboard(self, request: Request) -> Response:
        """The leaderboard, or that there is nothing yet."""
        records = self._tail.records()
        if not records:
            return HTMLResponse(render("waiting.html", scripts=("live.js",), asks=True, folder=str(self.folder)))
        return HTMLResponse(self._now().leaderboard)

    def progress(self, request: Request) -> Response:
        """How far the run is: as the records say, and nothing else."""
        records = self._tail.records()
        scored = [record for record in records if record.scored]
        return JSONResponse(
            {
                "stamp": self._tail.stamp(),
                "episodes": len(records),
                "scored": len(scored),
                "solved": sum(record.success for record in scored),
                "broken": sum(record.infrastructure_error for record in records),
                "last": _told(records[-1]) if records else None,
            }
        )

    def episode(self, request: Request) -> Response:
        """One episode's page."""
        name, pages = request.path_params["name"], self._now().episodes
        return HTMLResponse(pages.html(name)) if name in pages.names else _missing()

    def table(self, request: Request) -> Response:
        """A table as a picture."""
        key, _, kind = request.path_params["name"].rpartition(".")
        sheets = {sheet.key: sheet for sheet in self._now().board.sheets}
        if key not in sheets or kind not in ("svg", "png"):
            return _missing()
        if kind == "svg":
            return Response(svg(sheets[key]), media_type="image/svg+xml")
        return Response(png(sheets[key]), media_type="image/png")

    def file(self, request: Request) -> Response:
        """A video or picture of the folder."""
        kind, name = request.path_params["kind"], request.path_params["name"]
        path = self.folder / kind / name
        if kind not in _FILES or not _FILES[kind].fullmatch(name) or not path.is_file():
            return _missing()
        return FileResponse(path)

    def _now(self) -> Made:
        """What the records say by now; made once for each state of them."""
        with self._lock:
            stamp = self._tail.stamp()
            if self._made is None or stamp != self._stamp:
                records, blames, folder = self._tail.records(), read_blames(self.folder), str(self.folder)
                board = judging.board(records, blames=blames, folder=shlex.quote(folder))
                homes = {(record.job, record.iteration): folder for record in records}
                self._made = Made(
                    board=board,
                    leaderboard=leaderboard(board, records, blames, live=True),
                    episodes=EpisodePages(records, blames, folder=self.folder, homes=homes),
                )
                self._stamp = stamp
            return self._made


def _told(record: Record) -> dict[str, Any]:
    """An episode in a few words."""
    return {
        "title": visible(f"{record.task}, {record.agent}, seed {record.seed}"),
        "result": visible(ending(record)),
        "page": page_name(record),
    }


def _missing() -> Response:
    return PlainTextResponse("not here\n", status_code=404)


def _unreadable(request: Request, error: Exception) -> Response:
    return PlainTextResponse(f"{visible(str(error))}\n", status_code=500)
