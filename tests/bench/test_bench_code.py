"""The digest of the code in records: whatever decides results changes it, in whichever folder it lies; pages do not."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
import remac_bench
from remac_bench.playing import code

import remac_agents
import remac_env

PACKAGES = [Path(str(package.__file__)).parent for package in (remac_env, remac_agents, remac_bench)]
ROOMS = sorted(path.name for path in PACKAGES[1].iterdir() if path.is_dir() and path.name[0] != "_")


@pytest.fixture
def copy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the packages' code, of which the digest is taken."""
    for package in PACKAGES:
        left = shutil.ignore_patterns("__pycache__", "*.png", "*.jpg")
        shutil.copytree(package, tmp_path / package.name, ignore=left)
    monkeypatch.setattr(code.resources, "files", lambda name: tmp_path / name)
    return tmp_path


def digest() -> str:
    return code.code_digest.__wrapped__()


def test_a_change_in_any_room_changes_the_digest(copy: Path) -> None:
    before = digest()
    assert len(ROOMS) > 15 and before == digest()
    for room in ROOMS:
        file = next(path for path in sorted((copy / "remac_agents" / room).iterdir()) if path.suffix in code.KINDS)
        old = file.read_bytes()
        file.write_bytes(old + b"\n")
        assert digest() != before, file
        file.write_bytes(old)
    assert digest() == before


def test_pages_and_commands_decide_nothing(copy: Path) -> None:
    before = digest()
    for name in ("pages/places.py", "commands/bench.py", "report.py", "playing/machine.py"):
        with (copy / "remac_bench" / name).open("a") as file:
            file.write("\n")
    assert digest() == before
