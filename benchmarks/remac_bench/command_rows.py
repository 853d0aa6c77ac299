"""Options of one command of `remac` alone, one row each, as COMMAND.PARAMETER; `episode` and `records` are shared."""

from __future__ import annotations

from remac_agents.memory import MAX_CHARACTERS, MAX_LESSONS
from remac_env.option_rows import NEEDED, Choice, File, Real, Row, Switch, Texts, Whole, rows
from remac_env.options import MAX_ROBOTS, Options
from remac_env.pddl.actions import LEVELS
from remac_env.seeding import SEED_MAX

MOST = 10_000
"""Starts a task of an experiment at most: more is a slip of the keyboard."""

_SEED, _COUNT = Whole(0, SEED_MAX), Whole(1)
_KITCHEN = rows(Options)
_KEPT = "File of JSON lines for plans as they arrive; what it holds is not asked for again."
_JSON = Row(help="As JSON.", default=False, values=Switch(), flag="--json")

ROWS: dict[str, Row] = {
    "remac.version": Row(help="Print the version and exit.", default=False, values=Switch(), flag="--version"),
    "run.out": Row(
        help="Folder for records and videos; what it holds is not run again. Default: results/SUITE.", group="run"
    ),
    "run.tasks": Row(
        help="Comma-separated names; may be repeated. By default all.", values=Texts(), group="run"
    ),
    "run.methods": Row(
        help="Comma-separated names; may be repeated.", default=("BASE,CC,RE,REMAC",), values=Texts(),
        group="run",
    ),
    "run.seeds": Row(
        help="0:10 (0 to 9), 3, or 0,4,7; may be repeated.", default=("0:10",), values=Texts(), group="run"
    ),
    "run.suite": Row(help="A frozen list of jobs and agents: a name, or a FILE.toml.", group="run"),
    "episode.task": Row(help="Name of a task.", default=NEEDED),
    "episode.robots": _KITCHEN["robots"].but(default=1, help=f"1 to {MAX_ROBOTS}."),
    "episode.seed": Row(help="The episode's seed.", default=0, values=_SEED),
    "oracle.max_rounds": _KITCHEN["max_rounds"].but(help="Rounds after which the search gives up."),
    "pddl.level": Row(
        help="strips (actions in a row, for classical planners) or durative (with seconds, for temporal ones).",
        default="strips", values=Choice(LEVELS),
    ),
    "pddl.out": Row(help="Folder for domain.pddl and problem.pddl.", default=NEEDED, values=File()),
    "pddl.plan": Row(help="What a planner made of these files, to be played.", values=File()),
    "plan.taught": Row(
        help="Tell it a first iteration's plan and reflections.", default=False, values=Switch(), flag="--reflections"
    ),
    "plan.by": Row(
        help="own: the planner's own first iteration; rule: a rule-based one.", default="rule",
        values=Choice(("own", "rule")), flag="--reflections-by",
    ),
    "plan.out": Row(help=_KEPT, values=File()),
    "experiment.planner": Row(
        help="As for `remac plan`; may be repeated. By default all offline.", values=Texts(), flag="--planner"
    ),
    "experiment.tasks": Row(
        help="Comma-separated names; may be repeated. By default the table's.", values=Texts()
    ),
    "experiment.count": Row(help="Starts per task: seeds 0, 1, ...", default=20, values=Whole(1, MOST), flag="--n"),
    "experiment.robots": Row(help="1, 2 or 1,2; by default 1.", values=Texts()),
    "experiment.starts": Row(help="paper, mixed or paper,mixed; by default paper.", values=Texts()),
    "experiment.reflections": Row(
        help="own: what each planner itself learns in a first iteration; rule: what the rules learn.", default="rule",
        values=Choice(("own", "rule")),
    ),
    "experiment.file": Row(
        help="Also write every trial and the cells; plans are kept in FILE.jsonl.", values=File(), flag="--json"
    ),
    "experiment.out": Row(help=_KEPT, values=File()),
    "demo.out": Row(help="Folder for records and videos.", default="demo_output"),
    "demo.seeds": Row(help="0:10 (0 to 9), 3, or 0,4,7; may be repeated.", default=("0:3",), values=Texts()),
    "demo.video": Row(help="One video of a REMAC episode per task.", default=True, values=Switch()),
    "demo.resume": Row(help="Resume an earlier demo instead of starting over.", default=False, values=Switch()),
    "doctor.models": Row(
        help="provider:model to ask one tiny question; may be repeated.", values=Texts(), flag="--model"
    ),
    "doctor.as_json": _JSON,
    "tasks.as_json": _JSON,
    "generate.grades": Row(help="Comma-separated grades, 1 to 5; may be repeated.", default=("1",), values=Texts()),
    "generate.seeds": Row(help="0:10 (0 to 9), 3, or 0,4,7; may be repeated.", default=("0",), values=Texts()),
    "generate.workers": Row(help="How many processes.", default=1, values=Whole(1, 1000)),
    "generate.as_json": Row(
        help="As a line of JSON each, with a plan that reaches the goal.", default=False, values=Switch(), flag="--json"
    ),
    "verify.sample": Row(help="How many jobs; by default all.", values=_COUNT),
    "verify.seed": Row(help="Which sample.", default=0, values=_SEED),
    "play.robots": _KITCHEN["robots"].but(default=1),
    "play.out": Row(help="Folder for the record.", default="runs/human"),
    "play.terminal": Row(help="Type in the terminal instead of the browser.", default=False, values=Switch()),
    "play.video": Row(help="Also film the episode.", default=True, values=Switch()),
    "serving.port": Row(help="Port on which it listens; by default a free one.", default=0, values=Whole(0, 65_535)),
    "replay.iteration": Row(help="Which iteration; by default the last.", values=Whole()),
    "replay.video": Row(help="Also write a video: a file that ends in .webm.", values=File()),
    "records.bodies": Row(
        help="A body of your own that the records name, path/file.py:Name or package.module:Name, so that it is "
        "imported; may be repeated.", values=Texts(), flag="--body",
    ),
    "records.suite": Row(help="FILE.toml of a suite of your own, for which the records were played.", flag="--suite"),
    "records.as_markdown": Row(help="As Markdown.", default=False, values=Switch(), flag="--markdown"),
    "report.everything": Row(
        help="Every table with every column, not only the main ones.", default=False, values=Switch(), flag="--all"
    ),
    "report.grade": Row(help="Only generated tasks of these grades: 3 or 3,4,5."),
    "report.template": Row(
        help="Only generated tasks of these templates: names or parts of them, separated by commas."
    ),
    "report.csv": Row(help="Write FILE.csv with the results, or every table into a folder."),
    "report.pages": Row(
        help="Also write FOLDER/leaderboard.html with one page per episode.", default=True, values=Switch()
    ),
    "report.out": Row(help="Folder for the pages; needed where several folders are reported together."),
    "blame.rescue": Row(
        help="Also test whether the oracle would have reached the goal from the bad round on.", default=True,
        values=Switch(),
    ),
    "submit.out": Row(help="A new folder for the submission.", default=NEEDED),
    "submit.name": Row(help="The name under which it is listed on boards.", default=NEEDED),
    "submit.contact": Row(help="Whom to contact.", default=""),
    "submit.kind": Row(
        help="standard, or custom: with your own providers.", default="standard",
        values=Choice(("standard", "custom")),
    ),
    "accept.reask": Row(help="Jobs whose models are asked again, with your keys.", default=0, values=Whole()),
    "accept.seed": Row(help="Which jobs are asked again.", default=0, values=_SEED),
    "board.out": Row(help="A new folder for the pages.", default=NEEDED),
    "memory.task": Row(help="Only this task."),
    "memory.most": Row(help="Maximum number of lessons.", default=MAX_LESSONS, values=_COUNT),
    "memory.characters": Row(help="Maximum characters of lessons.", default=MAX_CHARACTERS, values=_COUNT),
    "learn.skills": Row(
        help="OpenDoor, TurnOn ..., with commas; may be repeated. By default all.", values=Texts()
    ),
    "learn.episodes": Row(help="Episodes of each skill.", default=200, values=_COUNT),
    "learn.first_seed": Row(help="Seed of the first episode.", default=1000, values=_SEED),
    "learn.cells": Row(
        help="table (styles and layouts of the tasks' table) or all.", default="table", values=Choice(("table", "all"))
    ),
    "learn.held_out": Row(
        help="Layouts and styles that are not recorded, so that skills can be measured in them.",
        default=("galley,g_shaped_small,coastal,modern_2,transitional_1",), values=Texts(), flag="--hold-out",
    ),
    "learn.target": Row(help="What the skill is about; by default the seed picks."),
    "learn.case": Row(
        help="What is handled where, such as 'food on surface', 'vessel on burner' or 'food in vessel on basin'; "
        "by default the seed picks."
    ),
    "learn.led_by": Row(
        help="A folder of weights that begin each motion; what is recorded is how the scripted controller goes on from "
        "there (DAgger). For skills that pick up or put down.",
        values=File(),
    ),
    "learn.disturb": Row(help="How strongly servos are disturbed; 0: not at all.", default=1.0, values=Real(0.0, 10.0)),
    "learn.format": Row(
        help="hdf5 (robomimic's layout, files of 40 episodes) or lerobot (a dataset of version 3.0).", default="hdf5",
        values=Choice(("hdf5", "lerobot")),
    ),
    "learn.pictures": Row(
        help="none, images (front, side and wrist, in the files) or videos (lerobot alone).", default="none",
        values=Choice(("none", "images", "videos")),
    ),
    "learn.image_size": _KITCHEN["image_size"].but(help="Pixels of a picture, square."),
    "learn.wordless": Row(
        help="Leave out the columns of subtask, plan and memory, which lerobot before 0.6 cannot read.", default=False,
        values=Switch(), flag="--no-language",
    ),
    "learn.out": Row(help="Folder for demonstrations.", default=NEEDED, values=File()),
    "learn.demos": Row(help="Folder of demonstrations.", default=NEEDED, values=File()),
    "learn.weights": Row(help="Folder of weights, SKILL.npz each.", default=NEEDED, values=File()),
    "learn.together": Row(
        help="One network for all of the skills, which also reads the words of commands; otherwise one each.",
        default=False, values=Switch(),
    ),
    "learn.epochs": Row(help="Passes over the demonstrations.", default=60, values=_COUNT),
    "learn.width": Row(help="Units of a hidden layer.", default=384, values=Whole(1, 4096)),
    "learn.chunk": Row(help="Commands that are predicted at once.", default=16, values=Whole(1, 200)),
    "learn.execute": Row(help="How many of them are carried out.", default=8, values=Whole(1, 200)),
    "learn.hand": Row(
        help="Also learn where the hand is to be, and bring it there: for what has to be grasped.", default=False,
        values=Switch(),
    ),
    "learn.trials": Row(help="Tries of each skill in each set of kitchens.", default=100, values=_COUNT),
    "learn.tried_from": Row(help="Seed of the first try.", default=50_000, values=_SEED, flag="--first-seed"),
    "learn.note": Row(help="Write the result into the weights.", default=False, values=Switch()),
    "learn.chats": Row(help="A file of JSON lines.", default=NEEDED, values=File(), flag="--out"),
    "learn.roles": Row(help="Questions of these roles, such as planner; by default all.", values=Texts()),
    "learn.successful": Row(help="Only of episodes that reached their goal.", default=False, values=Switch()),
    "learn.pictures_backend": Row(
        help="physics, or symbolic: posed by the skill table, which is quicker.", default="physics",
        values=Choice(("physics", "symbolic")), flag="--backend",
    ),
    "learn.held_kitchens": Row(
        help="Record in the layouts and styles held out, instead of in the others.", default=False, values=Switch(),
        flag="--held-out",
    ),
    "learn.pictures_out": Row(help="Folder for pictures.", default=NEEDED, values=File(), flag="--out"),
    "learn.albums": Row(
        help="Folder of pictures; to train, of the folders train, calibrate and test.", default=NEEDED, values=File(),
        flag="--pictures",
    ),
    "learn.checker_out": Row(help="File of weights, .npz.", default=NEEDED, values=File(), flag="--weights"),
    "learn.checker": Row(
        help="File of weights; by default those of the package.", values=File(), flag="--weights"
    ),
    "learn.checker_epochs": Row(help="Passes over the pictures.", default=20, values=_COUNT, flag="--epochs"),
    "learn.asked": Row(
        help="Only conditions that a method would have asked about.", default=False, values=Switch()
    ),
    "learn.processes": Row(help="How many processes.", default=1, values=Whole(1, 256)),
    "memory.keep": Row(help="Number of newest runs to keep per task.", default=NEEDED, values=Whole()),
}  # fmt: skip
