"""The reflection database: eight fields a run, append-only, readable by people, queried by task."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from remac_agents.memory.file import MemoryFile
from remac_env.errors import whole_number

MAX_LESSONS = 40
"""How many lessons of the memory go into one prompt at most; the newest are kept."""

MAX_CHARACTERS = 6000
"""And how many characters."""


@dataclass(frozen=True)
class Run:
    """One episode, in the eight fields of the paper's appendix.

    Attributes:
        task_description: the task's name.
        task_goal: the sentence.
        initial_plan: robot -> commands.
        action_list: what was run, in order, in the lines of `remac_agents.roles.accounts.Ran`.
        pre_check_results, post_check_results: an entry for each verdict, in order.
        success: whether the goal was reached.
        reflection: what was learnt.
    """

    task_description: str
    task_goal: str
    initial_plan: Mapping[str, list[str]]
    action_list: list[str]
    pre_check_results: list[dict[str, Any]]
    post_check_results: list[dict[str, Any]]
    success: bool
    reflection: list[str]

    @property
    def adjusted(self) -> bool:
        """True when some pre-condition was found false, so that the plan was changed on the way."""
        return any(entry.get("verdict") is False for entry in self.pre_check_results)

    def as_json(self) -> dict[str, Any]:
        """The eight fields as values that json.dumps takes."""
        return asdict(self)


class Memory:
    """Runs in the order in which they ended, in a JSON-lines file or in this process alone.

    Processes may share a file: each sees what the others have appended when it next asks.
    """

    def __init__(self, path: str | Path | None = None, *, keep: int | None = None) -> None:
        """See the class.

        Args:
            path: a file to read, if it exists, and to append to.
            keep: how many of the newest runs of a task are still told; None forgets nothing. The file keeps all:
                `prune_file` shortens it.

        Raises:
            OptionError: if `keep` is not a whole number from 1.
        """
        self._keep = None if keep is None else whole_number("keep", keep, 1)
        self._file = None if path is None else MemoryFile(Path(path))
        self._own: list[Run] = []

    def __repr__(self) -> str:
        return f"<Memory of {len(self)} runs>"

    def __len__(self) -> int:
        return len(self.all_runs())

    def append(self, run: Run) -> None:
        """Add a run and write it out at once."""
        if self._file is None:
            self._own.append(run)
        else:
            self._file.append(run.as_json())

    def all_runs(self) -> tuple[Run, ...]:
        """Every run that can be read, oldest first; `keep` does not matter here."""
        if self._file is None:
            return tuple(self._own)
        return tuple(run for entry in self._file.entries() if (run := _read(entry)) is not None)

    def tasks(self) -> tuple[str, ...]:
        """The tasks that runs are about, each once, oldest first."""
        return tuple(dict.fromkeys(run.task_description for run in self.all_runs()))

    def runs(self, task: str) -> tuple[Run, ...]:
        """The runs of a task that are not forgotten, oldest first."""
        runs = tuple(run for run in self.all_runs() if run.task_description == task)
        return runs if self._keep is None else runs[-self._keep :]

    def lessons(
        self, task: str, *, most: int = MAX_LESSONS, characters: int = MAX_CHARACTERS
    ) -> tuple[str, ...]:
        """The reflections of a task, each once where it was last learnt; the newest ones, oldest first."""
        told = [text for run in self.runs(task) for text in run.reflection]
        newest = list(dict.fromkeys(reversed(told)))[:most]
        kept: list[str] = []
        for text in newest:
            if len(text) <= characters:  # one that is too long must not push the others out
                kept.append(text)
                characters -= len(text)
        return tuple(reversed(kept))


def prune_file(path: str | Path, *, keep: int, task: str | None = None) -> int:
    """Shorten a memory file to the newest `keep` runs of each task (or of one), and say how many runs went.

    Lines that are no runs go too. The file is replaced in one step: a kill leaves the old one or the new one.
    """
    told: defaultdict[str, int] = defaultdict(int)

    def stays(entry: Mapping[str, Any]) -> bool:
        run = _read(entry)
        if run is None:
            return False
        told[run.task_description] += 1
        return task not in (None, run.task_description) or told[run.task_description] <= keep

    return MemoryFile(Path(path)).rewrite(stays)


def _read(entry: Mapping[str, Any]) -> Run | None:
    """A run from its line, or None for a foreign one."""
    names = [field.name for field in fields(Run)]
    if any(name not in entry or not _FITS[name](entry[name]) for name in names):
        return None
    return Run(**{name: entry[name] for name in names})


def _is_texts(value: object) -> bool:
    return isinstance(value, list) and all(isinstance(text, str) for text in value)


def _is_tables(value: object) -> bool:
    return isinstance(value, list) and all(isinstance(entry, dict) for entry in value)


_FITS: dict[str, Callable[[Any], bool]] = {
    "task_description": lambda value: isinstance(value, str),
    "task_goal": lambda value: isinstance(value, str),
    "initial_plan": lambda value: isinstance(value, dict) and all(_is_texts(row) for row in value.values()),
    "action_list": _is_texts,
    "pre_check_results": _is_tables,
    "post_check_results": _is_tables,
    "success": lambda value: isinstance(value, bool),
    "reflection": _is_texts,
}
"""Field -> whether a value found in a file can be it."""
