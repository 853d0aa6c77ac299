"""`remac bench run`, `verify`, `report`, `blame`, `submit`, `accept` and `board`."""

from __future__ import annotations

from typing import Annotated

import typer

from remac_bench import flags
from remac_bench.command import Command, whole
from remac_bench.commands import judge, submitting
from remac_bench.console import clean_errors
from remac_env.seeding import SEED_MAX

app = typer.Typer(no_args_is_help=True, help="Run agents in the kitchens and print their table.")


@app.command(cls=Command)
@clean_errors
def run(
    context: typer.Context,
    out: flags.Out = None,
    tasks: flags.Tasks = None,
    methods: flags.Methods = ["BASE,CC,RE,REMAC"],  # noqa: B006 - typer reads it, nobody writes to it
    seeds: flags.Seeds = ["0:10"],  # noqa: B006
    suite: flags.Suite = None,
    models: flags.Models = None,
    base_url: flags.BaseUrl = None,
    providers: flags.Providers = None,
    via: flags.Via = None,
    cassette: flags.Cassette = None,
    replay: flags.Replay = False,
    preflight: flags.Preflight = True,
    max_calls: flags.MaxCalls = None,
    max_tokens: flags.MaxTokens = None,
    max_money: flags.MaxMoney = None,
    max_seconds: flags.MaxSeconds = None,
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
    engine: flags.EngineName = "auto",
    address: flags.Address = None,
    jobs: flags.Jobs = None,
    job_seconds: flags.JobSeconds = None,
    isolation: flags.Isolation = True,
    optimum: flags.Optimum = False,
    extensions: flags.Extensions = None,
) -> None:
    """Play tasks with methods over seeds into OUT/records.jsonl; the same command goes on where it ended."""
    from remac_bench.commands.running import run_command

    run_command(context)


@app.command(cls=Command)
@clean_errors
def verify(
    folder: Annotated[str, typer.Argument(help="The --out of a run.")],
    sample: Annotated[int | None, typer.Option(help="How many jobs; by default all.", **whole(1))] = None,
    seed: Annotated[int, typer.Option(help="Which sample.", **whole(0, SEED_MAX))] = 0,
    cassette: flags.Cassette = None,
    providers: flags.Providers = None,
    extensions: flags.Extensions = None,
) -> None:
    """Play recorded jobs again and compare: re-execution is the proof. Exit code 1 where a record is contradicted."""
    from remac_bench.commands.running import verify_command

    files = {"cassette": cassette, "providers": providers}
    verify_command(folder, sample=sample, seed=seed, extensions=tuple(extensions or ()), **files)


app.command(cls=Command)(judge.report)
app.command(cls=Command)(judge.blame)
app.command(cls=Command)(submitting.submit)
app.command(cls=Command)(submitting.accept)
app.command(cls=Command)(submitting.board)
