"""The reflection database: eight fields a run, append-only, readable by people, queried by task."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

MAX_LESSONS = 40
MAX_CHARACTERS = 6000
"""How much of the memory goes into one prompt at most; the newest lessons are kept."""


@dataclass(frozen=True)
class Run:
    """One episode, in the eight fields of the paper's appendix.

    `initial_plan` maps robots to commands; `action_list`, `pre_check_results` and `post_check_results` have
    one entry an event, in order.
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
        return any(not entry.get("verdict", True) for entry in self.pre_check_results)


class Memory:
    """Runs in the order in which they ended, in a JSON-lines file or in this process alone."""

    def __init__(self, path: str | Path | None = None) -> None:
        """Args: path: a file to read, if it exists, and to append to."""
        self._path = None if path is None else Path(path)
        self._runs: list[Run] = []
        if self._path is not None and self._path.exists():
            text = self._path.read_text("utf-8", errors="replace")
            self._runs = [run for line in text.splitlines() if (run := _read(line)) is not None]

    def __len__(self) -> int:
        return len(self._runs)

    def append(self, run: Run) -> None:
        """Add a run and write it out at once."""
        self._runs.append(run)
        if self._path is None:
            return
        self._path.parent.mkdir(parents=True, exist_ok=True)
        line = json.dumps(asdict(run), ensure_ascii=False)
        with self._path.open("ab+") as file:
            # A line that was torn when a process died must not swallow this one.
            start = "\n" if _ends_torn(file) else ""
            file.write(f"{start}{line}\n".encode())
            file.flush()
            os.fsync(file.fileno())

    def runs(self, task: str) -> tuple[Run, ...]:
        """The runs of a task, oldest first."""
        return tuple(run for run in self._runs if run.task_description == task)

    def lessons(
        self, task: str, *, most: int = MAX_LESSONS, characters: int = MAX_CHARACTERS
    ) -> tuple[str, ...]:
        """The reflections of a task, each once where it was last learnt; the newest ones, oldest first."""
        told = [text for run in self.runs(task) for text in run.reflection]
        newest = list(dict.fromkeys(reversed(told)))[:most]
        kept: list[str] = []
        for text in newest:
            characters -= len(text)
            if characters < 0:
                break
            kept.append(text)
        return tuple(reversed(kept))

    def proven_plan(self, task: str) -> Mapping[str, list[str]] | None:
        """The single-robot plan that last succeeded as it was, or None if the task is not mastered.

        A run by several robots that failed takes the mastery away again.
        """
        proven: Mapping[str, list[str]] | None = None
        for run in self.runs(task):
            if len(run.initial_plan) > 1:
                proven = proven if run.success else None
            else:
                proven = run.initial_plan if run.success and not run.adjusted else None
        return proven


def _ends_torn(file: Any) -> bool:
    if file.seek(0, os.SEEK_END) == 0:
        return False
    file.seek(-1, os.SEEK_END)
    return bool(file.read(1) != b"\n")


def _read(line: str) -> Run | None:
    """A run from its line, or None for a torn or foreign one."""
    try:
        entry = json.loads(line)
    except json.JSONDecodeError:
        return None
    if not isinstance(entry, dict) or not _complete(entry, (field.name for field in fields(Run))):
        return None
    return Run(**{field.name: entry[field.name] for field in fields(Run)})


def _complete(entry: Mapping[str, Any], names: Iterable[str]) -> bool:
    kinds: dict[str, type] = {
        "initial_plan": dict,
        "reflection": list,
        "pre_check_results": list,
        "success": bool,
    }
    return all(name in entry and isinstance(entry[name], kinds.get(name, object)) for name in names)
