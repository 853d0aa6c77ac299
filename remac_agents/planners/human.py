"""The planner at the keyboard: subtasks are typed in the terminal, one a line, with completion by the Tab key.

    an empty line   ends a robot's row
    ?               lists the commands
    undo            takes the last subtask back
"""

from __future__ import annotations

import importlib
import shutil
import sys
import textwrap
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from remac_agents.plan import MAX_STEPS, Commands, Plan, PlanError
from remac_agents.prompting import wording
from remac_agents.roles import PlanRequest
from remac_env.files import unmarked
from remac_env.rules.subtasks import Subtask

LINES_MAX = 1000
"""Lines read for one plan at most: an input that never says anything valid does not hold an episode for ever."""


class HumanPlanner:
    """Asks in the terminal. The end of the input (Ctrl-D) ends the plan."""

    needs_truth = needs_rules = False

    def __init__(self, *, brief: bool = False) -> None:
        """Args: brief: what the kitchen says of itself is shown once, and rounds are left to who shows them."""
        self._brief, self._shown = brief, ""

    def plan(self, request: PlanRequest) -> Plan | PlanError:
        """A row for each robot, or the next step alone; an error when there is nobody to type."""
        commands = Commands(request.commands)
        seen, self._shown = self._shown, request.scene
        _show(request, brief=self._brief, known=self._brief and seen == request.scene)
        rows: dict[str, list[Subtask]] = {}
        with _completion(list(commands)):
            for robot in request.robots:
                row, ended = _ask_row(robot, commands, single=request.single_step)
                rows[robot] = row
                if ended and not any(rows.values()):
                    return PlanError("nobody types: this planner needs a terminal (and --jobs 0)")
                if ended:
                    break
        return Plan.of(rows)


def _ask_row(robot: str, commands: Commands, *, single: bool) -> tuple[list[Subtask], bool]:
    """One robot's subtasks, and whether the input has ended."""
    row: list[Subtask] = []
    for _ in range(LINES_MAX):
        if len(row) == (1 if single else MAX_STEPS):
            return row, False
        try:
            line = unmarked(input(f"{robot} {len(row) + 1}> ")).strip()
        except EOFError:
            return row, True
        step = commands.parse(line)
        if not line:
            return row, False
        if step is not None:
            row.append(step)
        elif line == "?":
            _say(*commands)
        elif line == "undo":
            row = row[:-1]
        else:
            _say(commands.unknown(line) + "; ? lists them all")
    return row, True


def _show(request: PlanRequest, *, brief: bool, known: bool) -> None:
    _say("", f"Goal: {request.goal}" if known else request.scene or f"Goal: {request.goal}")
    for title, lines in (
        ("Reflections", request.reflections),
        ("The try before", wording.previous_try(request.previous).splitlines()),
        ("Run so far", [] if request.events or brief else wording.rounds(request.ran).splitlines()),
        ("So far", request.events),
        ("Why it failed", [request.explanation] if request.explanation else []),
        ("The last answer", [request.failure] if request.failure else []),
    ):
        if lines:
            _say(f"{title}:", *(f"  {line}" for line in lines))
    for robot, held in request.holding.items():
        _say(f"{robot} holds {held or 'nothing'}.")
    _say("One subtask a line; Tab completes, an empty line ends, ? lists the commands, undo takes one back.")


def _say(*lines: str) -> None:
    """Lines for the terminal, which breaks no word of them; what would steer it is left out."""
    for text in lines:
        for line in "".join(c for c in text if c.isprintable() or c == "\n").split("\n"):
            sys.stdout.write(_laid_out(line) + "\n")
    sys.stdout.flush()


def _laid_out(line: str) -> str:
    if not sys.stdout.isatty():
        return line
    width = shutil.get_terminal_size().columns - 1
    indent = " " * (len(line) - len(line.lstrip()) + 2)
    return textwrap.fill(line, width, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False)


@contextmanager
def _completion(words: Sequence[str]) -> Iterator[None]:
    """Tab completes whole commands while this lasts; nothing where the platform has no readline."""
    try:
        readline: Any = importlib.import_module("readline")
    except ImportError:
        yield
        return
    before = readline.get_completer(), readline.get_completer_delims()
    readline.set_completer(completer(words))
    readline.set_completer_delims("")
    readline.parse_and_bind("tab: complete")
    try:
        yield
    finally:
        readline.set_completer(before[0])
        readline.set_completer_delims(before[1])


def completer(words: Sequence[str]) -> Callable[[str, int], str | None]:
    """A completer as readline calls it: the n-th word that begins with a text, or else holds it."""

    def complete(text: str, index: int) -> str | None:
        wanted = text.lower()
        found = [word for word in words if word.startswith(wanted)] or [word for word in words if wanted in word]
        return found[index] if index < len(found) else None

    return complete
