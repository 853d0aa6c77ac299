"""The planner that is another program: it reads the episode as PDDL, and prints or writes a plan.

Whatever goes wrong is an error value: no plan, none in time, one that this kitchen's rules do not carry out.
"""

from __future__ import annotations

import shlex
import shutil
import tempfile
from pathlib import Path

from remac_agents.plan import MAX_STEPS, Plan, PlanError
from remac_agents.planners.child import CommandError, run_command
from remac_agents.planners.oracle import for_robots
from remac_agents.planners.parallel_steps import StepError, in_rounds
from remac_agents.roles import PlanRequest
from remac_env.errors import OptionError, check_choice, real_number
from remac_env.pddl import LEVELS, Step, printed_plan, read_plan, write_domain, write_problem
from remac_env.rules.facts import Rules

PLACES = ("{domain}", "{problem}", "{plan}")
"""What stands in a command for the files."""

WRITES = ("*.soln", "*plan*")
"""Names of the files that planners write their plans to, where the command does not name one: pyperplan, and Fast
Downward with its kin."""


class PddlPlanner:
    """Runs a command for each plan, in an empty folder and in processes of its own that end with it.

    The command's `{domain}`, `{problem}` and `{plan}` become paths; where it names no file, domain and problem stand
    behind it. The plan is what it wrote to `{plan}`, else to `*.soln` or `*plan*` in its folder, the newest of them,
    else what it printed last.

    Args:
        command: the program and its arguments, as a shell would part them; no shell is asked.
        level: "strips" for classical planners, "durative" for temporal ones (`remac_env.pddl`).
        seconds: deadline of one plan, of real time.
        most_bytes: a longer plan is refused.

    Raises:
        OptionError: for a command that is none, a program that is not there, or a bound that is not positive.
    """

    needs_truth = needs_rules = True
    outside = isolated = True

    def __init__(
        self, command: str, *, level: str = "strips", seconds: float = 60.0, most_bytes: int = 1_000_000
    ) -> None:
        check_choice("level", level, LEVELS)
        for name, value in (("seconds", seconds), ("most_bytes", most_bytes)):
            if not real_number(name, value, 0.0):
                raise OptionError(f"{name} {value!r} is not valid; valid: a number above 0")
        try:
            self._command = shlex.split(command)
        except ValueError as error:
            raise OptionError(f"command {command!r} is not valid: {error}; valid: a planner's command line") from error
        program = self._command[0] if self._command else ""
        found = shutil.which(program)
        if found is None:
            raise OptionError(f"command {command!r}: there is no program {program!r}; valid: a planner's command line")
        # Its folder is another one: what was found beside us is named in full.
        self._command = [str(Path(found).absolute()), *map(_absolute, self._command[1:])]
        if not any(place in part for part in self._command for place in PLACES[:2]):
            self._command += PLACES[:2]
        self._level, self._seconds, self._most = level, float(seconds), int(most_bytes)

    def plan(self, request: PlanRequest) -> Plan | PlanError:
        """The program's plan in rounds, or why there is none."""
        if request.world is None or request.rules is None or request.goal_test is None:
            return PlanError("the planner was not given the truth")
        robots = request.facts.robots if request.question == "act" else request.robots
        rules, world = for_robots(request.rules, request.world, robots)
        try:
            domain = write_domain(rules, level=self._level)
            problem = write_problem(rules, world, request.goal_test, level=self._level)
            steps = self._steps(domain, problem, rules)
            rounds = in_rounds(rules, world, steps)
        except (OptionError, CommandError, StepError) as error:
            return PlanError(str(error))
        return Plan.of({robot: [joint[robot] for joint in rounds] for robot in request.robots})

    def _steps(self, domain: str, problem: str, rules: Rules) -> list[Step]:
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as told:
            folder = Path(told)
            paths = {place: folder / name for place, name in zip(PLACES, ("domain.pddl", "problem.pddl", "out.plan"),
                                                                  strict=True)}  # fmt: skip
            paths["{domain}"].write_text(domain, "utf-8")
            paths["{problem}"].write_text(problem, "utf-8")
            command = [_filled(part, paths) for part in self._command]
            printed = run_command(command, folder=folder, seconds=self._seconds, most_bytes=self._most)
            text = self._written(folder)
        steps = read_plan(printed_plan(printed.text, rules) if text is None else text, rules)
        if not steps:
            told = f": {printed.complaint}" if printed.complaint else ""
            raise CommandError(f"{Path(self._command[0]).name} gave no plan (status {printed.status}){told}")
        if len(steps) > MAX_STEPS:
            raise CommandError(f"its plan has {len(steps)} steps; valid: at most {MAX_STEPS}")
        return steps

    def _written(self, folder: Path) -> str | None:
        """The plan in a file, None where none was written."""
        names = {path for pattern in WRITES for path in folder.glob(pattern)}
        found = [path for path in names if path.is_file() and not path.is_symlink()]
        newest = max(found, key=lambda path: (path.stat().st_mtime_ns, path.name), default=None)
        if newest is None:
            return None
        with newest.open("rb") as file:
            content = file.read(self._most + 1)
        if len(content) > self._most:
            raise CommandError(f"its plan has more than {self._most} bytes")
        return content.decode("utf-8", "replace")


def _absolute(argument: str) -> str:
    """A relative path to a file that is there, in full; anything else as it is."""
    path = Path(argument)
    return str(path.absolute()) if path.is_file() else argument


def _filled(part: str, paths: dict[str, Path]) -> str:
    for place, path in paths.items():
        part = part.replace(place, str(path))
    return part
