"""What `remac bench run`, `verify` and `replay` do with their flags."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import typer

from remac_bench import flags
from remac_bench.command import joined
from remac_bench.commands.progress import run_and_report
from remac_bench.console import FAILED, plain, say
from remac_bench.errors import UsageError
from remac_bench.judging.endings import ending
from remac_bench.playing import agents, suites
from remac_bench.playing.agents import Access
from remac_bench.playing.extensions import load_named
from remac_bench.playing.job_lists import make_jobs, parse_names, parse_seeds
from remac_bench.playing.jobs import Job
from remac_bench.playing.settings import Settings
from remac_env.files import prepare_folder
from remac_env.option_rows import rows

SHOWN = 20
"""Contradictions that are printed; all are counted."""


def run_command(context: typer.Context) -> None:
    """Play what the flags ask for.

    Raises:
        UsageError, UnknownNameError, OptionError: for flags that are not valid, or do not go together.
    """
    given = context.params
    load_named(given["extensions"])
    if given["out"] is None and given["suite"] is None:
        raise UsageError("--out is missing: a folder for the records; only a suite has one of its own")
    access = Access(**{name: given[name] for name in rows(Access)})
    if access.replay and access.cassette is None:
        raise UsageError("--replay needs --cassette FILE")
    entries = _entries(context)
    if given["suite"] is None:
        jobs = [job for entry in entries for job in _jobs(context, entry, access)]
        prepare_folder(given["out"], "--out")
        run_and_report(jobs, given["out"], _settings(given))
        return
    suite = suites.load(given["suite"])
    _check_frozen(context, suite.name)
    jobs = suite.jobs(entries, backend=_explicit(context, "backend"), access=access)
    folder = given["out"] or f"results/{suite.name}"
    prepare_folder(folder, "--out")
    if why := _never_accepted(jobs, access):
        typer.echo(f"note: others cannot accept this run as a submission: {plain(why)}", err=True)
    run_and_report(jobs, folder, _settings(given))


def _never_accepted(jobs: list[Job], access: Access) -> str:
    """Why a run of a suite cannot be submitted, to be told before it is paid for; "" where it can."""
    from remac_bench.proof.submission import refused

    agent_of = [job.agent for job in jobs]
    if why := next(refused(agent_of, access.providers), ""):
        return why
    asked = any(agents.asked_models(agent, providers=access.providers) for agent in agent_of)
    return "the models' answers are kept nowhere; give --cassette FILE" if asked and access.cassette is None else ""


def verify_command(
    folder: str,
    *,
    sample: int | None,
    seed: int,
    extensions: list[str] | None = None,
    bodies: list[str] | None = None,
    cassette: str | None = None,
    providers: str | None = None,
    suite: str | None = None,
) -> None:
    """Print what re-execution found.

    Raises:
        typer.Exit: 1 where a record is contradicted.
        UsageError: where there is nothing to verify.
    """
    from remac_bench.proof.verify import verify

    load_named(extensions, bodies)
    if suite is not None:
        suites.add(suite)
    verdict = verify(folder, sample=sample, seed=seed, cassette=cassette, providers=providers)
    if not (verdict.jobs or verdict.findings):
        raise UsageError(f"no finished jobs in {folder!r}; give the --out of a `remac bench run`")
    for strange in verdict.strange:
        say(f"made with {strange}: differences in physics then prove nothing")
    for finding in verdict.findings[:SHOWN]:
        say(plain(f"job {finding.job or '-'}: {finding.told}"))
    wrong = len({finding.job for finding in verdict.findings})
    replayed = f", {verdict.replayed} of them by their subtasks alone" if verdict.replayed else ""
    say(
        f"{verdict.jobs} jobs with {verdict.records} records played again{replayed}: "
        + (f"{wrong} contradicted" if wrong else "all as recorded")
    )
    if wrong:
        raise typer.Exit(FAILED)


def replay_command(
    folder: str, job: str, *, iteration: int | None, video: Path | None, extensions: list[str] | None = None,
    bodies: list[str] | None = None,
) -> None:
    """Print the rounds of one episode as they are played again.

    Raises:
        typer.Exit: 1 where they differ from the record.
        UsageError: where there is no such episode.
    """
    from remac_bench.proof.replay import find, replay

    load_named(extensions, bodies)
    record = find(folder, job, iteration)
    told = replay(record, video=video)
    title = f"{record.task}, {record.agent}, seed {record.seed}, iteration {record.iteration}"
    for line in (title, *told.lines):
        say(plain(line))
    if video is not None:
        say(f"video: {plain(str(video))}")
    for line in told.differences[:SHOWN]:
        say(plain(line))
    say("not as recorded" if told.differences else f"as recorded: {ending(record)}")
    if told.differences:
        raise typer.Exit(FAILED)


def _entries(context: typer.Context) -> list[dict[str, Any]]:
    """An entry for each --model, or one without; each with the agent's flags. Models go by their routes; the same model
    with other options is another entry."""
    given = context.params
    agents.check_reach(via=given["via"], providers=given["providers"])

    def routed(text: str) -> str:
        return agents.by_route(text, via=given["via"], providers=given["providers"])

    said = flags.pick(given, "agent")
    models = said.pop("model")
    agent = {name: value for name, value in said.items() if name in agents.OPTIONS and value is not None}
    agent |= {name: routed(agent[name]) for name in agents.ROLES if name in agent}
    if not models:
        return [agent]
    from remac_agents.llm.settings import plain_model_name  # only here: no offline run needs the client

    return [{"model": model, **agent} for model in dict.fromkeys(plain_model_name(routed(m)) for m in models)]


def _jobs(context: typer.Context, entry: dict[str, Any], access: Access) -> list[Job]:
    import remac_env

    given = context.params
    return make_jobs(
        tasks=parse_names(tasks, "tasks") if (tasks := joined(given["tasks"], "tasks")) else remac_env.tasks(),
        methods=parse_names(joined(given["methods"], "methods") or "", "methods"),
        seeds=parse_seeds(joined(given["seeds"], "seeds") or ""),
        kitchen=_kitchen(context),
        agent=entry,
        robots=given["robots"],
        iterations=given["iterations"],
        access=access,
    )


def _kitchen(context: typer.Context) -> dict[str, Any]:
    """The kitchen's flags; those about pictures only where they are given, else they follow from the roles."""
    follow = ("obs", "image_size", "cameras")
    given = flags.pick(context.params, "kitchen")
    del given["robots"]  # by default the method's
    return {name: v for name, v in given.items() if name not in follow or _explicit(context, name) is not None}


def _settings(given: dict[str, Any]) -> Settings:
    said = flags.pick(given, "settings")
    return Settings(**{**said, "extensions": tuple(said["extensions"] or ())})


def _check_frozen(context: typer.Context, suite: str) -> None:
    for name in flags.FROZEN:
        if _explicit(context, name) is not None:
            raise UsageError(f"{flags.TABLE[name].written} does not go with suite {suite!r}, which says that itself")


def _explicit(context: typer.Context, name: str) -> Any:
    """The value of a flag that was given on the command line; None where it was not."""
    parameter = flags.TABLE[name].parameter
    source = context.get_parameter_source(parameter)
    # By its name: typer brings a click of its own, whose enumeration is not the one of the package click.
    return context.params[parameter] if source is not None and source.name == "COMMANDLINE" else None
