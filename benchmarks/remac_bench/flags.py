"""The flags that commands share: one for every keyword of `parallel_env` and of `remac_agents.make`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Annotated, Any

import typer

from remac_agents.text.options import MOST_SPENT
from remac_bench import agents
from remac_bench.command import real, whole
from remac_env.options import FOR_LEARNERS, MAX_ROBOTS, Options
from remac_env.seeding import SEED_MAX

_KITCHEN, _AGENT, _RUN = "The kitchen", "The agent", "The run"


def _kitchen(text: str, **more: Any) -> Any:
    return typer.Option(help=text, rich_help_panel=_KITCHEN, **more)


def _agent(text: str, **more: Any) -> Any:
    return typer.Option(help=text, rich_help_panel=_AGENT, **more)


def _run(text: str, *names: str, **more: Any) -> Any:
    return typer.Option(*names, help=text, rich_help_panel=_RUN, **more)


Backend = Annotated[str, _kitchen("physics (MuJoCo decides) or symbolic (the skill table).")]
Style = Annotated[str | None, _kitchen("Name of a look; by default the seed picks.")]
Layout = Annotated[str | None, _kitchen("Name of a floor plan; by default the seed picks.")]
Starts = Annotated[str, _kitchen("paper (doors closed, all off) or mixed.")]
Observations = Annotated[str, _kitchen("state or state+images; with pictures where a role looks at them.")]
Text = Annotated[str, _kitchen("What planners are told: plain (names) or states.")]
Feedback = Annotated[str, _kitchen("What planners hear of a failure: status or reason.")]
Wording = Annotated[int, _kitchen("Goal sentence 1, 2 or 3 (the simplest).", **whole(1, 3))]
Naming = Annotated[str, _kitchen("How objects are called: role.")]
PerceptionNoise = Annotated[float, _kitchen("Error of the poses that controllers see, m (physics).", **real(0.0, 0.1))]
FailureRate = Annotated[float, _kitchen("Probability that a subtask slips (symbolic).", **real(0.0, 1.0))]
ImageSize = Annotated[
    int, _kitchen("Pixels of a side of observation images; 512 where a role looks at them.", **whole(16, 1024))
]
RenderMode = Annotated[str | None, _kitchen("human: watch the episodes; rgb_array.")]
MaxRounds = Annotated[int, _kitchen("Rounds after which an episode is truncated.", **whole(1, 100_000))]
Reward = Annotated[str, _kitchen("sparse or progress.")]
Robots = Annotated[
    int | None, _kitchen("1 or 2; by default the method's own: REMAC and SMART-LLM 2, others 1.", **whole(1, 2))
]

Planner = Annotated[
    str | None, _agent(
        "A name, package.module:Name, path/file.py:Name, http://HOST:PORT/PATH or answers:FILE.json; "
        "options as name,option=value."
    ),
]
Conditions = Annotated[str | None, _agent("Who says what should be true before and after a subtask.")]
Checker = Annotated[str | None, _agent("Who judges it.")]
Adjuster = Annotated[str | None, _agent("Who mends a plan.")]
Reflector = Annotated[str | None, _agent("Who says what was learnt.")]
Handover = Annotated[str | None, _agent("How a second robot is given work.")]
Summariser = Annotated[str | None, _agent("Who tells what happened and why it failed (REFLECT).")]
Retries = Annotated[int | None, _agent("How often a subtask whose post-conditions fail is tried again.", **whole())]
MaxAdjustments = Annotated[int | None, _agent("How often a plan is changed at most.", **whole())]
AgentMaxRounds = Annotated[int | None, _agent("Rounds after which a method stops by itself.", **whole())]
Lead = Annotated[str | None, _agent("The robot that works alone or leads; by default the first by name.")]
Helper = Annotated[str | None, _agent("The second robot of a team.")]
Iterations = Annotated[
    int | None,
    _agent("Number of the last iteration: 2 plays 0, 1, 2 (methods that learn, and best-of controls).", **whole()),
]

_MODELS = "Language models"


def _models(text: str, *names: str, **more: Any) -> Any:
    return typer.Option(*names, help=text, rich_help_panel=_MODELS, **more)


Models = Annotated[
    list[str] | None,
    _models(
        "provider:model or provider:model,option=value: an entry that fills every role that speaks; may be repeated.",
        "--model",
    ),
]
AskedModels = Annotated[
    list[str] | None, _models("provider:model to ask one tiny question; may be repeated.", "--model")
]
BaseUrl = Annotated[str | None, _models("Address of custom:<model>, such as http://127.0.0.1:8000/v1.")]
Providers = Annotated[
    str | None, _models("FILE.toml that adds to the providers that are built in, or overrides them.", "--providers")
]
Via = Annotated[
    str | None, _models("Provider by which models are reached, or auto: the first route whose key is set.", "--via")
]
Cassette = Annotated[str | None, _models("File of exchanges: plays what it holds, asks for the rest and records it.")]
Replay = Annotated[bool, _models("Ask nobody: what the cassette does not hold ends an episode unscored.", "--replay")]
Preflight = Annotated[
    bool,
    _models("Ask each model one tiny question first, and say what the run may cost.", "--preflight/--no-preflight"),
]
MaxCalls = Annotated[int | None, _models("Requests of a job at most.", **whole(0, int(MOST_SPENT)))]
MaxTokens = Annotated[int | None, _models("Tokens of a job at most.", **whole(0, int(MOST_SPENT)))]
MaxMoney = Annotated[float | None, _models("US dollars of a job at most.", **real(0.0, MOST_SPENT))]
MaxSeconds = Annotated[float | None, _models("Seconds of a job in requests at most.", **real(0.0, MOST_SPENT))]

Out = Annotated[
    str | None, _run("Folder for records and videos; what it holds is not run again. Default: results/SUITE.")
]
Tasks = Annotated[
    list[str] | None, _run("Names with commas between them; may be repeated. By default all.", "--tasks")
]
Methods = Annotated[list[str] | None, _run("Names with commas between them; may be repeated.", "--methods")]
Seeds = Annotated[list[str] | None, _run("0:10 (0 to 9), 3, or 0,4,7; may be repeated.", "--seeds")]
Seed = Annotated[int, typer.Option(help="The episode's seed.", **whole(0, SEED_MAX))]
Crew = Annotated[int, typer.Option(help="1 or 2.", **whole(1, MAX_ROBOTS))]
Suite = Annotated[str | None, _run("A frozen list of jobs and agents: a name, or a FILE.toml.")]
EngineName = Annotated[
    str, _run("auto (threads where models are asked, else processes), processes, threads or ray.", "--engine")
]
Address = Annotated[str | None, _run("Of a Ray cluster; by default one on this machine.")]
Jobs = Annotated[
    int | None,
    _run("Jobs at the same time; 0: one by one, here. Default: one a core, 16 threads.", "--jobs", "-j",
         **whole(valid="a whole number, 0 (in this process) or more")),
]
Video = Annotated[str, _run("none, failed, all, or first: the first seed's scored episode.")]
Optimum = Annotated[bool, _run("Also search each episode's shortest plan.", "--optimum/--no-optimum")]
Isolation = Annotated[
    bool,
    _run("Code from outside runs in processes of its own; tables name it where not.", "--isolation/--no-isolation"),
]
JobSeconds = Annotated[
    float | None,
    _run(
        "Wall time of a job at most; then it has failed. Default: 3600, or 86400 where models or people are asked.",
        **real(0.001, 1e9),
    ),
]
Extensions = Annotated[
    list[str] | None, _run("Module or file.py that registers tasks; may be repeated.", "--import")
]

AGENT = {
    **{name: name for name in agents.OPTIONS if name != "model"},
    "max_rounds": "agent_max_rounds",
}
"""Keyword of `remac_agents.make` -> the flag, which differs where the kitchen has a keyword of that name. `model` is
apart: each makes an entry."""

KITCHEN = {field.name: field.name for field in fields(Options) if field.name not in ("robots", *FOR_LEARNERS)}
"""Keyword of `parallel_env` -> the flag; `robots` is apart, its default is the method's."""


FROZEN = (
    *("tasks", "methods", "seeds", "robots", "iterations", "retries", "max_adjustments", "agent_max_rounds"),
    *(flag for flag in KITCHEN.values() if flag not in ("backend", "render_mode")),
)
"""Flags that do not go with a suite, which says these things itself."""


def pick(context: typer.Context, flags: Mapping[str, str]) -> dict[str, Any]:
    """Keyword -> the value of its flag, from the command line that typer has read."""
    return {keyword: context.params[flag] for keyword, flag in flags.items()}
