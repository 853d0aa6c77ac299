"""One episode that a person plays, from the kitchen to the record."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from remac_agents.prompting.wording import report
from remac_agents.roles import Report
from remac_bench.entries import EndpointError
from remac_bench.errors import UsageError
from remac_bench.live.person import Watched
from remac_bench.playing import agents
from remac_bench.playing.deadline import ASKING_SECONDS, Deadline
from remac_bench.playing.episodes import play_episode
from remac_bench.playing.job_lists import make_jobs
from remac_bench.playing.jobs import Job
from remac_bench.playing.lock import locked
from remac_bench.playing.recording import Recorder
from remac_bench.records import Record
from remac_bench.store import Store, finished_jobs
from remac_env.envs.event_parallel import CONTINUE
from remac_env.errors import RemacError
from remac_env.files import prepare_file, prepare_folder

Tell = Callable[[Any, Mapping[str, Any], Mapping[str, str]], None]
"""Is given the environment, the infos at the start and after each round, and the subtasks that led there."""

Told = tuple[tuple[str, str, bool], ...]
"""Of a round: robot, what became of its subtask as planners hear it, and whether it is known to have failed."""


class EpisodeError(RemacError, RuntimeError):
    """An episode that broke off through nobody's fault who plays: it is not recorded."""


def person_job(task: str, *, seed: int, robots: int, kitchen: Mapping[str, Any]) -> Job:
    """The job of a person; UnknownNameError, OptionError for what is not valid."""
    (job,) = make_jobs(
        tasks=[task], methods=[agents.PERSON], seeds=[seed], kitchen=kitchen, agent={}, robots=robots
    )
    return job


def refuse_played(job: Job, folder: str | Path) -> None:
    """Refuse an episode that has been played: the first try counts, and it taught how the kitchen is.

    Raises:
        UsageError: where the folder holds it.
        OptionError, RecordFileError: where the folder cannot be written, or its records not be read.
    """
    prepare_folder(folder, "--out")
    prepare_file(Store(folder).path, "--out")
    if job.key in finished_jobs(Store(folder).read()):
        raise UsageError(
            f"{str(folder)!r} holds this episode already, and the first try counts; give another --seed, or --out"
        )


def play(job: Job, folder: str | Path, planner: Any, *, tell: Tell, video: bool) -> Record | None:
    """Play it, in this thread, and write its record; None, and no record, where the person left before the end.

    Args:
        planner: who is asked.
        tell: is told of each round.
        video: whether it is filmed.
    """
    import remac_agents
    import remac_env

    store = Store(folder)
    env = remac_env.parallel_env(job.task, **asdict(job.options))
    try:
        with locked(store.folder):
            store.claim(None)
            store.repair()
            agent = remac_agents.make(job.method, planner=planner, iterations=job.iterations)
            name = f"{job.task}-{job.label}-seed{job.seed}-iteration0-{job.key}"
            recorder = Recorder(env, folder, name, "last" if video else "none", last=True)
            begun: dict[str, str] = {}
            watched: Any = Watched(agent, lambda infos, tokens: tell(env, infos, _texts(env, tokens, begun)))
            record = play_episode(env, watched, job, 0, recorder, Deadline.within(ASKING_SECONDS))
            if not record.infrastructure_error:
                store.append([record])
            elif record.error is not None and record.error.type != EndpointError.__name__:
                raise EpisodeError(f"{record.error.type}: {record.error.message}")
            return None if record.infrastructure_error else record
    finally:
        env.close()


def _texts(env: Any, tokens: Mapping[str, int], begun: dict[str, str]) -> dict[str, str]:
    """Robot -> its subtask: by the event clock, which it has `begun` and goes on with."""
    texts = {robot: str(env.vocabulary.decode(int(token))) for robot, token in tokens.items()}
    begun.update({robot: text for robot, text in texts.items() if text != CONTINUE})
    return {robot: begun.get(robot, text) for robot, text in texts.items()}


def told(infos: Mapping[str, Any], sent: Mapping[str, str]) -> Told:
    """What became of a round, as planners hear it. `sent`: robot -> its subtask; empty at the start."""
    found = []
    for robot, subtask in sent.items():
        outcome = infos[robot]["outcome"]
        if not outcome:  # by the event clock: it has not ended when somebody else's has
            found.append((robot, f"{subtask}: still at it", False))
            continue
        why = (outcome["reason"] or None) if infos[robot]["feedback"] == "reason" else None
        words = report(Report(str(outcome["status"]), why, subtask))
        found.append((robot, words, outcome["status"] == "failure"))
    return tuple(found)
