"""`remac memory`: what is in a memory file."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from remac_agents.memory import Memory, Run, prune_file
from remac_bench.command import Command
from remac_bench.console import plain
from remac_bench.errors import UsageError
from remac_bench.flags import parsed, takes
from remac_env.files import prepare_file
from remac_env.option_rows import Whole

app = typer.Typer(no_args_is_help=True, help="Look into memory files: what runs taught.")

File = Annotated[Path, typer.Argument(help="A memory file (JSON lines).")]


@app.command("list", cls=Command)
@takes("memory.task")
def list_runs(file: File, *, task: str | None) -> None:
    """One line a run: number, task, success, whether the plan was adjusted, lessons, length of the first plan."""
    for number, run in _chosen(file, task):
        adjusted = "adjusted" if run.adjusted else "as planned"
        length = max((len(row) for row in run.initial_plan.values()), default=0)
        result = "success" if run.success else "failure"
        _say(f"{number}  {run.task_description}  {result}  {adjusted}  {len(run.reflection)} lessons  {length} rounds")


@app.command(cls=Command)
@takes("memory.task", "memory.most", "memory.characters")
def show(
    file: File,
    number: Annotated[
        int | None, typer.Argument(help="Of a run, as `list` says; without it, the lessons.", **parsed(Whole()))
    ] = None,
    *,
    task: str | None,
    most: int,
    characters: int,
) -> None:
    """Print one run with its eight fields as JSON, or the lessons that a prompt would get, by task."""
    chosen = dict(_chosen(file, task))
    if number is not None:
        if number not in chosen:
            raise UsageError(f"run {number} is not there; valid: {_range(chosen)}")
        _say(json.dumps(chosen[number].as_json(), ensure_ascii=True, indent=1), lines=True)
        return
    memory = Memory(file)
    for name in dict.fromkeys(run.task_description for run in chosen.values()):
        _say(name)
        for lesson in memory.lessons(name, most=most, characters=characters):
            _say(f"  - {plain(lesson)}")


@app.command(cls=Command)
@takes("memory.task")
def diff(first: File, second: File, *, task: str | None) -> None:
    """What the second file's prompts have (+) and lack (-) against the first's, by task."""
    one, other = Memory(_there(first)), Memory(_there(second))
    names = dict.fromkeys([*one.tasks(), *other.tasks()])
    for name in [task] if task else names:
        before, after = one.lessons(name), other.lessons(name)
        lines = [f"- {plain(text)}" for text in before if text not in after]
        lines += [f"+ {plain(text)}" for text in after if text not in before]
        if lines:
            _say("\n".join([name, *lines]), lines=True)


@app.command(cls=Command)
@takes("memory.keep", "memory.task")
def prune(file: File, *, keep: int, task: str | None) -> None:
    """Forget all but the newest runs of each task; the file is replaced in one step."""
    prepare_file(_there(file), "memory file")
    gone = prune_file(_there(file), keep=keep, task=task)
    _say(f"{gone} {'run' if gone == 1 else 'runs'} forgotten")


def _chosen(file: Path, task: str | None) -> list[tuple[int, Run]]:
    runs = enumerate(Memory(_there(file)).all_runs())
    return [(number, run) for number, run in runs if task in (None, run.task_description)]


def _there(file: Path) -> Path:
    if not file.is_file():
        raise UsageError(f"there is no file {str(file)!r}; give a memory file of remac_agents.Memory")
    return file


def _range(chosen: dict[int, Run]) -> str:
    return ", ".join(map(str, chosen)) if chosen else "none: the file holds no runs of that kind"


def _say(text: str, *, lines: bool = False) -> None:
    """Echo a line; what was written by others comes out without control characters."""
    typer.echo("\n".join(map(_clean, text.splitlines())) if lines else plain(text))


def _clean(line: str) -> str:
    return "".join(letter if letter.isprintable() else " " for letter in line)
