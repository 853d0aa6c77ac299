"""`remac bench run`; with it, in one group, what `commands/judge.py` offers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from remac_bench import flags
from remac_bench.commands import judge
from remac_bench.console import clean_errors
from remac_bench.errors import UsageError

if TYPE_CHECKING:
    from remac_bench.jobs import Job
    from remac_bench.runner import Settings

app = typer.Typer(no_args_is_help=True, help="Run agents in the kitchens and print their table.")


@app.command()
@clean_errors
def run(
    context: typer.Context,
    out: flags.Out,
    tasks: Annotated[str | None, typer.Option(help="Names with commas between them; all by default.")] = None,
    methods: Annotated[str, typer.Option(help="Names with commas between them.")] = "BASE,CC,RE,REMAC",
    seeds: Annotated[str, typer.Option(help="0:10 (0 to 9), 3, or 0,4,7.")] = "0:10",
    suite: Annotated[str | None, typer.Option(help="A frozen list of jobs and agents.", hidden=True)] = None,
    backend: flags.Backend = "physics",
    style: flags.Style = None,
    layout: flags.Layout = None,
    starts: flags.Starts = "paper",
    obs: flags.Observations = "state",
    text: flags.Text = "plain",
    feedback: flags.Feedback = "status",
    wording: flags.Wording = 3,
    naming: flags.Naming = "role",
    perception_noise: flags.PerceptionNoise = 0.0,
    failure_rate: flags.FailureRate = 0.0,
    image_size: flags.ImageSize = 128,
    render_mode: flags.RenderMode = None,
    max_rounds: flags.MaxRounds = 30,
    reward: flags.Reward = "sparse",
    robots: flags.Robots = None,
    planner: flags.Planner = None,
    conditions: flags.Conditions = None,
    checker: flags.Checker = None,
    adjuster: flags.Adjuster = None,
    reflector: flags.Reflector = None,
    handover: flags.Handover = None,
    summariser: flags.Summariser = None,
    retries: flags.Retries = None,
    max_adjustments: flags.MaxAdjustments = None,
    agent_max_rounds: flags.AgentMaxRounds = None,
    lead: flags.Lead = None,
    helper: flags.Helper = None,
    iterations: flags.Iterations = None,
    video: flags.Video = "none",
    jobs: flags.Jobs = None,
    optimum: flags.Optimum = False,
    extensions: flags.Extensions = None,
) -> None:
    """Play tasks with methods over seeds into OUT/records.jsonl; the same command goes on where it ended."""
    from remac_bench.commands.progress import run_and_report
    from remac_bench.extensions import find_local_modules, load_extensions

    if suite is not None:
        raise UsageError(f"suite {suite!r}: there are no suites yet; name --tasks, --methods and --seeds")
    find_local_modules()
    load_extensions(extensions or ())
    settings = _settings(context)
    run_and_report(_jobs(context, tasks, methods, seeds), out, settings)


app.command()(judge.report)
app.command()(judge.blame)


def _jobs(context: typer.Context, tasks: str | None, methods: str, seeds: str) -> list[Job]:
    """The jobs that the flags ask for; those of kitchen and agent are read from the context by name."""
    import remac_env
    from remac_bench.jobs import make_jobs, parse_names, parse_seeds

    return make_jobs(
        tasks=remac_env.tasks() if tasks is None else parse_names(tasks, "tasks"),
        methods=parse_names(methods, "methods"),
        seeds=parse_seeds(seeds),
        kitchen=flags.pick(context, flags.KITCHEN),
        agent=flags.pick(context, flags.AGENT),
        robots=context.params["robots"],
        iterations=context.params["iterations"],
    )


def _settings(context: typer.Context) -> Settings:
    from remac_bench.machine import cores
    from remac_bench.runner import Settings

    given = context.params
    return Settings(
        workers=cores() if given["jobs"] is None else given["jobs"],
        video=given["video"],
        optimum=given["optimum"],
        extensions=tuple(given["extensions"] or ()),
    )
