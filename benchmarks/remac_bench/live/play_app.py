"""`remac play` in the browser: the page, what is on the table, and the orders that come back."""

from __future__ import annotations

import json
import threading
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Mount, Route

from remac_bench.errors import UsageError
from remac_bench.judging.endings import ending
from remac_bench.live.episode import play, told
from remac_bench.live.guard import NUMBER
from remac_bench.live.person import PersonPlanner, Table
from remac_bench.live.viewing import View
from remac_bench.pages.episode_page import page_name
from remac_bench.pages.rendering import render
from remac_bench.pages.text import visible
from remac_bench.playing.jobs import Job
from remac_bench.records import Record
from remac_env.errors import RemacError

_HEADERS = {"content-security-policy": "default-src 'none'"}


class Play:
    """One episode, which a thread of its own plays, and the pages around it."""

    def __init__(self, job: Job, folder: str | Path, *, video: bool) -> None:
        self._job, self._folder, self._video = job, folder, video
        self.table = Table()
        self.record: Record | None = None
        self._thread = threading.Thread(target=self._run, name="remac-episode", daemon=True)

    @property
    def app(self) -> Starlette:
        """The application; behind it, the pages of the folder."""
        routes = [
            Route("/", self.page),
            Route("/state", self.state),
            Route("/picture/{number}", self.picture),
            Route("/orders", self.orders, methods=["POST"]),
            Mount("/", app=View(self._folder).app),
        ]
        return Starlette(routes=routes)

    def start(self) -> None:
        """Begin the episode."""
        self._thread.start()

    def leave(self) -> None:
        """Nobody plays any more; waits until the episode has been closed."""
        self.table.leave()
        self._thread.join()

    def page(self, request: Request) -> Response:
        """What a person plays on."""
        job = self._job
        facts: dict[str, Any] = {"task": job.task, "seed": job.seed, "backend": job.options.backend}
        return HTMLResponse(render("play.html", scripts=("play.js",), asks=True, robots=job.options.robots, **facts))

    def state(self, request: Request) -> Response:
        """What is on the table; nothing where the asker has seen it."""
        seen = self.table.seen
        if request.query_params.get("after") == str(seen.version):
            return Response(status_code=204)
        return JSONResponse(_clean(asdict(seen)))

    def picture(self, request: Request) -> Response:
        """The kitchen after a round."""
        number = request.path_params["number"]
        data = self.table.picture(int(number)) if NUMBER.fullmatch(number) else None
        if data is None:
            return PlainTextResponse("not here\n", status_code=404)
        return Response(data, media_type="image/jpeg", headers=_HEADERS)

    async def orders(self, request: Request) -> Response:
        """Subtasks that the person sends."""
        try:
            sent = json.loads(await request.body())
            self.table.order(sent.get("rows") if isinstance(sent, dict) else None)
        except UsageError as error:
            return JSONResponse({"problem": visible(str(error))}, status_code=400)
        except (ValueError, RecursionError):
            return JSONResponse({"problem": "that is no JSON"}, status_code=400)
        return JSONResponse({"problem": ""})

    # -- inside ----------------------------------------------------------------------------------------------

    def _run(self) -> None:
        try:
            record = play(self._job, self._folder, PersonPlanner(self.table), tell=self._tell, video=self._video)
        except RemacError as error:
            self.table.show(phase="broken", problem=str(error))
            return
        if record is None:
            self.table.show(phase="broken", problem="The episode was left before its end, and is not recorded.")
            return
        self.record = record
        self.table.show(phase="ended", result=ending(record), page=f"episodes/{page_name(record)}")

    def _tell(self, env: Any, infos: Mapping[str, Any], sent: Mapping[str, str]) -> None:
        shared, now = next(iter(infos.values())), told(infos, sent)
        if not sent:
            commands = {robot: tuple(info["commands"]) for robot, info in infos.items()}
            self.table.show(robots=tuple(infos), commands=commands, goal=str(shared["goal"]))
        self.table.show(
            scene=str(shared["text"]), rounds=(*self.table.seen.rounds, *([now] if now else [])),
            phase="recording" if shared["end"] else self.table.seen.phase,
        )  # fmt: skip
        if self._job.options.render_mode is None:
            return
        try:
            self.table.add_picture(_jpeg(env.render_work(whole=True)))
        except RemacError as error:
            self.table.show(blind=f"No picture: {error}")


def _jpeg(picture: Any) -> bytes:
    import cv2

    _, data = cv2.imencode(".jpg", picture[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 88])
    return bytes(data)


def _clean(value: Any) -> Any:
    """Texts made visible: a task's, a kitchen's and a person's are all somebody else's."""
    if isinstance(value, str):
        return visible(value)
    if isinstance(value, dict):
        return {visible(key): _clean(each) for key, each in value.items()}
    return [_clean(each) for each in value] if isinstance(value, list | tuple) else value
