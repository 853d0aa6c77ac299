"""What plan-only commands have found so far, a JSON line each, so that the same command asks for nothing twice."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from remac_agents.memory.file import MemoryFile
from remac_bench.asked import Asked
from remac_bench.errors import UsageError
from remac_env.files import prepare_file

SETTINGS = "settings"


class Book:
    """Findings by what was asked; in a file where there is one, each on the disk before the next question.

    The file's first line holds the settings that all its findings share. A line that was torn by a kill is passed over.
    """

    def __init__(self, path: Path | None = None, settings: Mapping[str, Any] | None = None) -> None:
        """See the class.

        Raises:
            OptionError: if the file cannot be written.
            UsageError: if it holds findings of other settings, which the message names, or is no such file.
        """
        self.path = path
        self._found: dict[str, Any] = {}
        self._file: MemoryFile | None = None
        if path is None:
            return
        self._file = MemoryFile(prepare_file(path, "--out"))
        told = _plain(dict(settings or {}))
        entries = self._file.entries()
        if not entries:
            if path.exists() and path.stat().st_size:
                raise UsageError(f"{path} is not a file of findings; give another")
            self._file.append({SETTINGS: told})
        else:
            _check_settings(path, entries[0].get(SETTINGS), told)
        self._found = {_key(entry["of"]): entry["found"] for entry in entries if "of" in entry and "found" in entry}

    def __len__(self) -> int:
        return len(self._found)

    def find(self, of: Mapping[str, Any]) -> Any:
        """What was found of this before; None where nothing was."""
        return self._found.get(_key(of))

    def usage(self) -> dict[str, Asked]:
        """Planner -> what all its plans and first iterations took of language models; without those that ask none."""
        total: dict[str, Asked] = {}
        for key, found in self._found.items():
            taken = Asked.from_json(found.get("usage"))
            if taken is not None:
                planner = str(json.loads(key)["planner"])
                total[planner] = total.get(planner, Asked()) + taken
        return total

    def add(self, of: Mapping[str, Any], found: Any) -> None:
        """Note a finding."""
        self._found[_key(of)] = found
        if self._file is not None:
            self._file.append({"of": dict(of), "found": found})


def _check_settings(path: Path, held: object, told: Mapping[str, Any]) -> None:
    if not isinstance(held, dict):
        raise UsageError(f"{path} is not a file of findings; give another")
    other = [name for name in dict.fromkeys([*held, *told]) if held.get(name) != told.get(name)]
    if other:
        differ = "; ".join(f"{name} {held.get(name)!r}, not {told.get(name)!r}" for name in other)
        raise UsageError(f"{path} holds findings of other settings: {differ}; give another file")


def _plain(value: Any) -> Any:
    """The value as a file gives it back."""
    return json.loads(json.dumps(value))


def _key(of: Mapping[str, Any]) -> str:
    return json.dumps(of, sort_keys=True)
