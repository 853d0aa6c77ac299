"""Re-execution as the proof of records: jobs are played again, and everything that can be compared is."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from remac_bench import agents
from remac_bench.agents import Access
from remac_bench.episode import read_outcomes
from remac_bench.jobs import Job
from remac_bench.machine import versions
from remac_bench.records import Record
from remac_bench.store import Store
from remac_bench.worker import Work, play_job
from remac_bench.worlds import as_values
from remac_env.errors import RemacError
from remac_env.options import Options
from remac_env.seeding import generator

REPEATS: tuple[str, ...] = (
    *("task", "method", "agent", "robots", "backend", "starts", "style", "layout", "seed", "digest", "scored"),
    *("success", "end", "progress", "phases", "rounds", "outcomes", "worlds", "sim_seconds"),
    *("robot_contacts", "near_misses", "physics_steps"),
    *("initial_plan", "final_plan", "initial_plan_length", "final_plan_length", "subtasks_done"),
    *("pre_checks", "post_checks", "adjusted", "retries", "reflections", "truth_readers"),
)
"""Fields that come out the same when the whole job is played again."""

PLAYED: tuple[str, ...] = (
    *("style", "layout", "digest", "success", "end", "progress", "phases", "rounds", "outcomes", "worlds"),
    *("sim_seconds", "robot_contacts", "near_misses", "physics_steps"),
)
"""Fields that come out the same when the recorded subtasks are played again, whoever chose them."""


@dataclass(frozen=True)
class Finding:
    """A record that re-execution contradicts: the job, its iteration, and the field with both values, cut short."""

    job: str
    told: str


@dataclass(frozen=True)
class Verdict:
    """What re-execution found.

    Attributes:
        jobs, records: how many were looked at. `replayed`: jobs whose subtasks alone were played again, because who
            chose them cannot be asked again.
        findings: contradictions.
        strange: versions other than those here on which records were made; there differences in physics prove nothing.
    """

    jobs: int
    records: int
    replayed: int
    findings: tuple[Finding, ...]
    strange: tuple[str, ...]


def verify(folder: str | Path, *, sample: int | None = None, seed: int = 0) -> Verdict:
    """Play a sample of a folder's finished jobs again and compare.

    An offline agent is run again from its record's options. A job of a language model, or of a planner from outside
    that may answer otherwise, has its recorded subtasks played again instead: digest, worlds, outcomes and success are
    then compared, not who chose what.

    Args:
        sample: number of jobs; None: all.
        seed: of the sample.

    Raises:
        RecordFileError: if the records cannot be read.
    """
    groups: dict[str, list[Record]] = {}
    for record in Store(folder).read():
        groups.setdefault(record.job, []).append(record)
    finished = [rows for rows in groups.values() if any(row.scored for row in rows)]
    if sample is not None and sample < len(finished):
        picked = generator(seed, "sample of jobs to verify").permutation(len(finished))[:sample]
        finished = [finished[index] for index in sorted(picked)]
    findings: list[Finding] = []
    replayed = 0
    for rows in finished:
        again = _repeatable(rows[0])
        replayed += not again
        findings += [Finding(rows[0].job, told) for told in (_check_job(rows) if again else _check_rounds(rows))]
    here = versions()
    others = {(n, v) for rows in finished for n, v in rows[0].versions.items() if here.get(n) != v}
    strange = [f"{name} {version} (here {here.get(name)})" for name, version in others]
    return Verdict(len(finished), sum(map(len, finished)), replayed, tuple(findings), tuple(sorted(strange)))


def read_job(record: Record) -> Job:
    """The job that a record belongs to, by the options that the record holds.

    Raises:
        RemacError, TypeError, KeyError: for options that no version knows.
    """
    known = {f.name for f in fields(Options)}
    kitchen = {name: value for name, value in record.options["kitchen"].items() if name in known}
    told = record.options.get("access", {})
    return Job(
        method=record.method,
        task=record.task,
        seed=record.seed,
        options=Options(**kitchen),
        agent=dict(record.options["agent"]),
        iterations=int(record.options["iterations"]),
        access=Access.recorded(told),
    )


def _repeatable(record: Record) -> bool:
    """Whether the agent answers the same when it is asked again: all of its roles are our own offline ones."""
    from remac_agents.catalogue import ROLES

    agent: Mapping[str, Any] = record.options.get("agent", {})
    names = {role: str(agent[role]).partition(",")[0] for role in agents.ROLES if role in agent}
    own = all(name in ROLES[role] and name != "human" for role, name in names.items())
    return own and not agents.asked_models(agent)


def _check_job(rows: Sequence[Record]) -> Iterator[str]:
    """Play the whole job again."""
    try:
        job = read_job(rows[0])
    except (RemacError, TypeError, KeyError, ValueError) as error:
        yield f"its options make no job: {error}"
        return
    yield from _check_key(rows[0], job)
    again = {record.iteration: record for record in play_job(Work(job=job, folder="", video="none"))}
    if set(again) != {row.iteration for row in rows}:
        yield f"iterations: recorded {sorted(row.iteration for row in rows)}, played again {sorted(again)}"
    for row in rows:
        if row.iteration in again:
            yield from _compare(row, again[row.iteration].model_dump(), REPEATS, skip_agent_label=row.suite is not None)


def _check_rounds(rows: Sequence[Record]) -> Iterator[str]:
    """Play the recorded subtasks again."""
    import remac_env

    for row in rows:
        if row.infrastructure_error or row.digest is None:
            continue
        try:
            job = read_job(row)
            yield from _check_key(row, job)
            env = remac_env.parallel_env(row.task, **asdict(job.options))
        except (RemacError, TypeError, KeyError, ValueError) as error:
            yield f"its options make no job: {error}"
            return
        try:
            yield from _compare(row, _replay(env, row), PLAYED)
        except (RemacError, KeyError, ValueError) as error:
            yield f"iteration {row.iteration}: its subtasks cannot be played: {error}"
        finally:
            env.close()


def _replay(env: Any, row: Record) -> dict[str, Any]:
    """The fields PLAYED, from the recorded subtasks."""
    _, infos = env.reset(seed=row.seed)
    outcomes: list[dict[str, Any]] = []
    worlds = [as_values(env.world)]
    for entry in row.outcomes:
        if not env.agents:
            raise ValueError(f"{len(row.outcomes)} rounds recorded, the episode ended after {len(outcomes)}")
        tokens = {robot: _token(env, outcome.subtask) for robot, outcome in entry.items()}
        _, _, _, _, infos = env.step(tokens)
        outcomes.append({n: each.model_dump() for n, each in read_outcomes(env, tokens, infos).items()})
        worlds.append(as_values(env.world))
    shared = next(iter(infos.values()))
    episode = shared["episode"]
    return {
        "style": episode["style"],
        "layout": episode["layout"],
        "digest": episode["digest"],
        "success": shared["end"] == "success" and row.error is None,
        "end": shared["end"] or None,
        "progress": round(env.progress, 6),
        "phases": dict(shared["phases"]),
        "rounds": len(outcomes),
        "outcomes": outcomes,
        "worlds": worlds,
        "sim_seconds": round(float(shared["seconds"]), 6),
        **{name: int(shared[name]) for name in ("robot_contacts", "near_misses", "physics_steps")},
    }


def _token(env: Any, text: str) -> int:
    """The token of a subtask as the records have it: its text, or "token N" for one that names nothing."""
    word, _, number = text.partition(" ")
    return int(number) if word == "token" and number.lstrip("-").isdigit() else int(env.vocabulary.encode(text))


def _check_key(row: Record, job: Job) -> Iterator[str]:
    if job.key != row.job:
        yield f"job: its options make job {job.key}, it says {row.job}"


def _compare(
    row: Record, again: Mapping[str, Any], names: Sequence[str], *, skip_agent_label: bool = False
) -> Iterator[str]:
    recorded = row.model_dump()
    for name in names:
        if name == "agent" and skip_agent_label:
            continue  # a suite's label leaves out what the suite gives; the key has told already
        if recorded[name] != again[name]:
            yield f"iteration {row.iteration}, {name}: recorded {_short(recorded[name])}, again {_short(again[name])}"


def _short(value: object) -> str:
    text = str(value)
    return text if len(text) <= 120 else f"{text[:117]}..."
