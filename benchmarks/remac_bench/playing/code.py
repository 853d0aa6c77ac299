"""A digest of the code that decides results: environment, agents and judge, but no page, command or text."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from functools import lru_cache
from importlib import resources
from importlib.resources.abc import Traversable

PACKAGES = ("remac_env", "remac_agents", "remac_bench")

KINDS = (".py", ".toml", ".md", ".json")
"""Endings of the files that count: code, data and prompts."""

LEFT_OUT = (
    "pages", "live", "commands", "console.py", "report.py", "board.py", "cli.py", "flags.py", "playing/machine.py",
)
"""What in remac_bench shows results and decides none."""


@lru_cache(maxsize=1)
def code_digest() -> str:
    """Twelve hexadecimal digits: the same for the same sources, wherever they are installed."""
    found = hashlib.sha256()
    for package in PACKAGES:
        for name, file in sorted(_files(resources.files(package), package)):
            data = file.read_bytes().replace(b"\r\n", b"\n")
            found.update(f"{name}\0{len(data)}\0".encode() + data)
    return found.hexdigest()[:12]


def _files(folder: Traversable, name: str) -> Iterator[tuple[str, Traversable]]:
    for entry in folder.iterdir():
        path = f"{name}/{entry.name}"
        if path.removeprefix("remac_bench/") in LEFT_OUT or entry.name.startswith((".", "__pycache__")):
            continue
        if entry.is_dir():
            yield from _files(entry, path)
        elif entry.name.endswith(KINDS):
            yield path, entry
