"""`remac play`: a person plays an episode, in the browser or typing, and stands on the leaderboard with it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import typer

from remac_bench.flags import takes

if TYPE_CHECKING:
    from remac_bench.playing.jobs import Job


@takes(
    *("episode.task", "play.robots", "episode.seed", "backend", "body", "starts", "style", "layout"),
    *("naming", "feedback", "max_rounds", "clock", "grade", "template", "quirks", "knowledge"),
    *("play.out", "play.terminal", "play.video", "serving.port", "extensions"),
)
def play(
    *, task: str, robots: int, seed: int, out: str, terminal: bool, video: bool, port: int,
    extensions: list[str] | None, **kitchen: Any,
) -> None:  # fmt: skip
    """Play an episode yourself, and write its record into OUT like any agent's (agent: human)."""
    from remac_bench.live.episode import person_job, refuse_played
    from remac_bench.playing.extensions import load_named

    load_named(extensions)
    job = person_job(task, seed=seed, robots=robots, kitchen={**kitchen, "render_mode": "rgb_array"})
    refuse_played(job, out)
    if terminal:
        _typed(job, out, video=video)
    else:
        _in_browser(job, out, video=video, port=port)


def _typed(job: Job, out: str, *, video: bool) -> None:
    from remac_bench.console import say
    from remac_bench.live.episode import play as play_episode
    from remac_bench.live.terminal import planner, teller

    tell = teller(say)
    try:
        record = play_episode(job, out, planner(), tell=tell, video=video)
    except KeyboardInterrupt:
        record = None
    _conclude(record, out)


def _in_browser(job: Job, out: str, *, video: bool, port: int) -> None:
    from remac_bench.live.play_app import Play
    from remac_bench.live.serving import Server

    game = Play(job, out, video=video)
    server = Server(game.app, port=port)
    typer.echo(f"{server.address}\nCtrl-C ends it.")
    game.start()
    server.run()
    game.leave()
    _conclude(game.record, out)


def _conclude(record: Any, out: str) -> None:
    from remac_bench.console import FAILED, plain
    from remac_bench.judging.endings import ending

    if record is None:
        typer.echo("The episode was left before its end, and is not recorded.", err=True)
        raise typer.Exit(FAILED)
    typer.echo(plain(f"{ending(record)} in {record.rounds} rounds, recorded in {out}; remac bench report {out}"))
