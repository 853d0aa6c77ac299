"""Plays one episode and writes down what happened. The agent's faults are told from the infrastructure's."""

from __future__ import annotations

import os
import time
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Literal

from remac_agents.isolation.remote import RemoteError
from remac_agents.running.pace import timed
from remac_agents.text.printable import printable, type_name, words
from remac_bench.entries import MESSAGE_MAX, EndpointError, report_fields, save_pictures
from remac_bench.errors import JobTimeoutError
from remac_bench.playing.deadline import Deadline
from remac_bench.playing.interrupts import is_stop
from remac_bench.playing.jobs import Job
from remac_bench.playing.machine import machine, versions
from remac_bench.playing.recording import Recorder
from remac_bench.playing.shared import Agent
from remac_bench.playing.timing import StepBook, shortest, timeline
from remac_bench.playing.worlds import as_values, fallen
from remac_bench.records import ErrorEntry, OutcomeEntry, Record, SpanEntry, VideoEntry
from remac_bench.redaction import printable_values, redact
from remac_env.errors import ActionError
from remac_env.oracle import Certificate, certify, problem_id
from remac_env.robots import bodies

FRAMES_MAX = 12
"""Frames of an exception's traceback in a record."""

Kind = Literal["agent", "infrastructure"]


class BlamedError(Exception):
    """An exception, and whose it is."""

    def __init__(self, kind: Kind, error: BaseException) -> None:
        super().__init__(words(error))
        self.kind, self.error = kind, error

    def entry(self) -> ErrorEntry:
        """The exception for the record: places without folders, and no value of a key that is set here."""
        frames = [(frame.f_code, line) for frame, line in traceback.walk_tb(self.error.__traceback__)][-FRAMES_MAX:]
        places = [printable(f"{os.path.basename(c.co_filename)}:{line} in {c.co_name}") for c, line in frames]
        places += self.error.where if isinstance(self.error, RemoteError) else []
        return ErrorEntry(
            kind=self.kind,
            type=type_name(self.error),
            message=redact(words(self.error))[:MESSAGE_MAX],
            where=places[-FRAMES_MAX:],
        )


@contextmanager
def blaming(kind: Kind) -> Iterator[None]:
    """Turn any exception inside into a BlamedError of this kind, but for someone's wish to stop the run.

    A planner that exits, or raises what only a keyboard should, has crashed: it has not stopped us.
    """
    try:
        yield
    except BlamedError:
        raise
    except BaseException as error:  # noqa: BLE001 - planners and simulators may raise anything; it is recorded
        if is_stop(error):
            raise
        if isinstance(error, JobTimeoutError):
            kind = "agent"
        raise BlamedError(kind, error) from error


@dataclass
class Course:
    """What is known of an episode so far. `started`: when it was; `joined`: the agent has begun it, and reports."""

    started: str | None = None
    infos: Mapping[str, Any] = field(default_factory=dict)
    outcomes: list[dict[str, OutcomeEntry]] = field(default_factory=list)
    worlds: list[dict[str, Any]] = field(default_factory=list)
    progress: float = 0.0
    certificate: Certificate | None = None
    problem: str | None = None
    made: Mapping[str, Any] = field(default_factory=dict)
    joined: bool = False
    shortest: dict[str, Any] = field(default_factory=dict)
    book: StepBook = field(default_factory=StepBook)
    timeline: list[SpanEntry] = field(default_factory=list)
    skills: Mapping[str, str] = field(default_factory=dict)
    skill_cases: Mapping[str, list[str]] = field(default_factory=dict)
    body: Mapping[str, Any] = field(default_factory=dict)

    @property
    def shared(self) -> Mapping[str, Any]:
        """The part of the last infos that is the same for all robots; empty before the first reset."""
        return next(iter(self.infos.values()), {})


def now() -> str:
    """The time, UTC, ISO 8601 to the second."""
    return datetime.now(UTC).isoformat(timespec="seconds")


def play_episode(
    env: Any, agent: Agent, job: Job, iteration: int, recorder: Recorder, deadline: Deadline, *, optimum: bool = False
) -> Record:
    """Play the job's episode once, whatever happens.

    Args:
        env: a KitchenParallelEnv made for the job.
        deadline: the job's; looked at before each round.
        optimum: also search the shortest plan.
    """
    began = time.perf_counter()
    course, fault, report = Course(started=now()), None, None
    try:
        with blaming("infrastructure"):
            recorder.start()
            _play(env, agent, job, course, deadline, optimum=optimum)
    except BlamedError as caught:
        fault = caught
    try:
        if course.joined:
            report = _report(agent, recorder.folder)
    except BlamedError as caught:
        fault = fault or caught
    if fault is None and report is not None and report.broken:
        fault = BlamedError("infrastructure", EndpointError(report.broken))
    if fault is not None and course.joined:
        with suppress(BlamedError), blaming("agent"):
            agent.close_episode({}, {})  # now, so that what fails in it is not taken for the next episode's
    wall = round(time.perf_counter() - began, 3)
    broken = fault is not None and fault.kind == "infrastructure"
    video = None if broken else recorder.finish(success=fault is None and course.shared.get("end") == "success")
    try:
        with blaming("agent"):
            fields = {} if report is None else report.fields
            record = make_record(
                job, iteration, course=course, report=fields, fault=fault, wall_seconds=wall, video=video
            )
            record.line()
            return record
    except BlamedError as caught:  # the report holds what cannot be written
        fault = fault or caught
    return make_record(job, iteration, course=course, report={}, fault=fault, wall_seconds=wall, video=video)


@dataclass(frozen=True)
class _Report:
    """The fields of the agent's report, and why the episode counts for nothing, None where it counts."""

    fields: Mapping[str, Any]
    broken: str | None


def _report(agent: Agent, folder: Path) -> _Report:
    with blaming("agent"):
        told = agent.report()
        fields = report_fields(told)
    with blaming("infrastructure"):
        save_pictures(folder, told.pictures)
    return _Report(fields, told.infrastructure)


def _play(env: Any, agent: Agent, job: Job, course: Course, deadline: Deadline, *, optimum: bool) -> None:
    observations, course.infos = env.reset(seed=job.seed)
    course.skills, course.skill_cases = getattr(env, "skills", {}), getattr(env, "skill_cases", {})
    course.body = bodies.described(job.options.body)
    course.progress = env.progress
    course.worlds.append(as_values(env.world))
    course.problem = problem_id(env.start.scene, env.world, env.goal)
    course.made = made_from(env, job.seed)
    if optimum and job.options.clock == "events":
        course.shortest = shortest(env)
    elif optimum:
        course.certificate = certify(env.start.scene, env.world, env.goal)
    with blaming("agent"):
        agent.reset(observations, course.infos)
        course.joined = True
    while env.agents:
        with blaming("agent"):
            deadline.check()
            actions = agent.act(observations, course.infos)
            thoughts = agent.thoughts() if timed(course.infos) else {}
            course.book.order(env, actions, course.infos, thoughts)
        try:
            observations, _, _, _, course.infos = env.step(actions)
        except ActionError as error:
            raise BlamedError("agent", error) from error
        course.outcomes.append(course.book.ended(env, actions, course.infos))
        course.progress = env.progress
        course.worlds.append(as_values(env.world))
        course.timeline = timeline(env)
        if job.options.render_mode == "human":
            env.render()
    with blaming("agent"):
        agent.close_episode(observations, course.infos)


def made_from(env: Any, seed: int) -> dict[str, Any]:
    """The fields of a record that say what the task of a seed was generated from; none where it was not."""
    told = env.worlds.of(seed).spec.generated
    return {"template": told["template"], "known_rounds": told["upper"]} if told else {}


def proven(certificate: Certificate | None) -> dict[str, Any]:
    """The fields of a record that a certificate fills; none where nothing was searched."""
    if certificate is None:
        return {}
    return {
        "optimum_rounds": certificate.optimum,
        "optimum_lower": certificate.lower,
        "optimum_proof": certificate.proof,
    }


def make_record(
    job: Job, iteration: int, *, course: Course, report: Mapping[str, Any], fault: BlamedError | None,
    wall_seconds: float = 0.0, video: VideoEntry | None = None,
) -> Record:
    """The record of one episode, or of one that an error kept from beginning."""
    shared = course.shared
    episode = shared.get("episode", {})
    broken = fault is not None and fault.kind == "infrastructure"
    return Record(
        job=job.key,
        agent=printable(job.label),
        method=job.method,
        task=job.task,
        style=episode.get("style", job.options.style),
        layout=episode.get("layout", job.options.layout),
        starts=job.options.starts,
        seed=job.seed,
        goal=shared.get("goal", ""),
        digest=episode.get("digest"),
        robots=job.options.robots,
        backend=job.options.backend,
        iteration=iteration,
        scored=iteration == job.iterations and not broken,
        success=fault is None and shared.get("end") == "success",
        end=shared.get("end") or None,
        progress=round(course.progress, 6),
        phases=dict(shared.get("phases", {})),
        rounds=len(course.outcomes),
        sim_seconds=round(float(shared.get("seconds", 0.0)), 6),
        wall_seconds=wall_seconds,
        outcomes=course.outcomes,
        worlds=course.worlds,
        clock=job.options.clock,
        orders=course.book.orders,
        timeline=course.timeline,
        robot_contacts=int(shared.get("robot_contacts", 0)),
        near_misses=int(shared.get("near_misses", 0)),
        physics_steps=int(shared.get("physics_steps", 0)),
        problem=course.problem,
        **course.made,
        littered=fallen(course.worlds),
        **proven(course.certificate),
        **course.shortest,
        video=video,
        error=None if fault is None else fault.entry(),
        options=printable_values(job.facts),
        versions=versions(),
        skills=dict(course.skills),
        skill_cases=dict(course.skill_cases),
        **course.body,
        started=course.started,
        machine=machine(),
        **({} if job.suite is None else job.suite.fields),
        **report,
    )
