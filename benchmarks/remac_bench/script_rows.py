"""Options of the scripts beside this package, one row each, as SCRIPT.PARAMETER; `script` is shared."""

from __future__ import annotations

from remac_env.option_rows import File, Real, Row, Switch, Whole, rows
from remac_env.options import Options

_COUNT = Whole(1)
_ALL = Row(help="Comma-separated names; by default all.")
_SEEDS = Row(help="0:50 (0 to 49), 3 or 0,4,7: starts per task.", default="0:50")
_ONLY = Row(help="Only those whose name contains this.", default="")
_PHYSICS = Row(help="In physics, which takes minutes.", default=False, values=Switch(), flag="--physics")
_FIRST = Row(help="Seeds are first_seed, first_seed + 1, ...", default=0, values=Whole())

ROWS: dict[str, Row] = {
    "script.tasks": _ALL,
    "script.methods": _ALL,
    "script.seeds": _SEEDS,
    "script.only": _ONLY,
    "script.first_seed": _FIRST,
    "script.body": rows(Options)["body"],
    "script.processes": Row(help="Worker processes.", default=2, values=_COUNT),
    "script.physics": _PHYSICS,
    "script.file": Row(help="Also write every figure to this file.", values=File(), flag="--json"),
    "calls.calls": Row(help="Concurrent calls.", default=32, values=_COUNT),
    "calls.waves": Row(help="How many waves of calls.", default=3, values=_COUNT),
    "calls.latency": Row(help="Latency of the server, seconds.", default=2.0, values=Real()),
    "certify_modules.only": Row(help="Certify these again, kinds or kind.variant; empty for all.", default=""),
    "certify_modules.rounds": Row(help="Runs of each trial, each from another seed.", default=2, values=_COUNT),
    "certify_modules.check": Row(
        help="Run this many trials again and compare; writes nothing.", default=0, values=Whole()
    ),
    "certify_modules.first_seed": _FIRST.but(
        help="Seed of a variant's first trial, and of what --check picks.", default=44000
    ),
    "certify_objects.trials": Row(help="Seeds of each category.", default=3, values=_COUNT),
    "certify_objects.only": Row(help="Categories, separated by commas; empty for all.", default=""),
    "fit_memorised.seeds": _SEEDS.but(help="Starts to fit on.", default="40000:40200"),
    "fit_generated.seeds": _SEEDS.but(help="Tasks of each grade to fit on.", default="41000:41040"),
    "forces.trials": Row(help="Runs of each chain.", default=5, values=_COUNT),
    "littered.trials": Row(help="Staged starts with each number of robots.", default=18, values=_COUNT),
    "makespans.robots": rows(Options)["robots"].but(default=1, help="How many."),
    "makespans.by": Row(
        help="A planner's command line, with {domain} and {problem} for its files, {target} for our seconds.",
        default="kairos {domain} {problem} --timeout 5 --threads 1 --format popf --target-cost {target}",
    ),
    "makespans.validate": Row(
        help="A validator's command line, with {domain}, {problem} and {plan} for its files, asked of our plan.",
        default="",
    ),
    "makespans.layout": Row(help="Name of a floor plan.", default="one_wall_large"),
    "makespans.states": Row(help="Moments at which our search gives up.", default=20_000, values=_COUNT),
    "model_costs.seeds": _SEEDS.but(default="0:5"),
    "model_costs.write": Row(help="Rewrite model_costs.toml.", default=False, values=Switch(), flag="--write"),
    "model_costs.show": Row(
        help="Measure nothing: show the table as it is.", default=False, values=Switch(), flag="--show"
    ),
    "model_costs.into": Row(help="A document: the Markdown replaces what stands between its marks.", values=File()),
    "offline_tables.seeds": Row(help="Starts per task; 50, for outsiders 20.", values=_COUNT),
    "oracle_physics.layouts": Row(help="Comma-separated names, each with every seed; by default drawn at random."),
    "oracle_physics.by": Row(help="A row for each task, layout or style, and number of robots.", default="task"),
    "oracle_physics.grades": Row(
        help="Comma-separated grades of generated tasks, to be played in place of the suite's.", default=""
    ),
    "oracle_physics.robots": Row(help="How many robots, separated by commas.", default="1,2"),
    "oracle_physics.together": Row(
        help="Generated tasks: the shortest plan that is found for all robots at once.", default=False, values=Switch(),
        flag="--together",
    ),
    "oracle_physics.replans": Row(
        help="Maximum number of replans after failed rounds.", default=2, values=Whole()
    ),
    "planted_failures.seeds": Row(help="How many seeds.", default=20, values=_COUNT),
    "quirk_sheet.only": _ONLY,
    "quirk_sheet.picture": Row(help="Write the contact sheet to this file, a PNG or JPEG.", values=File()),
    "skills.trials": Row(help="Runs of each chain.", default=100, values=_COUNT),
    "skills.perception_noise": Row(
        help="m, of the poses that controllers perceive; several separated by commas.", default="0"
    ),
    "solids.trials": Row(help="Runs of each chain; 0: staged measurements only.", default=5, values=Whole()),
    "solids.staged": Row(help="Whether to measure the staged falls and doors.", default=True, values=Switch()),
    "teams.methods": Row(help="Comma-separated names.", default="SMART-LLM,BASE,CC,RE,REMAC"),
    "teams.starts": Row(help="paper, mixed, or both separated by a comma.", default="paper,mixed"),
    "teams.errors": Row(help="Rates of false alarms and misses: only REMAC, by rate.", default=""),
    "thinking.methods": _ALL.but(help="Comma-separated names.", default="CC,REACT"),
    "thinking.seeds": _SEEDS.but(default="0:2"),
    "timed_physics.states": Row(
        help="Play the plans with the shortest makespan; each search gives up at so many moments. 0: the data file's.",
        default=0, values=Whole(), flag="--shortest",
    ),
    "timed_physics.robots": rows(Options)["robots"].but(default=2, help="How many; with --shortest."),
    "twin.seeds": _SEEDS.but(default="70000:70020"),
    "twin.grades": Row(help="Comma-separated grades of generated tasks, in place of tasks.", default=""),
    "twin.rounds": rows(Options)["max_rounds"].but(help="Maximum rounds of an episode."),
}
