"""Whatever a model or a planner answers, nothing is executed, spawned, written elsewhere or connected elsewhere."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

HERE = Path(__file__).parent
ROOT = HERE.parents[1]


def played(folder: Path, *more: str) -> dict[str, Any]:
    """What the run under the audit hook prints."""
    environ = os.environ | {"PYTHONPATH": os.pathsep.join(map(str, (ROOT, ROOT / "benchmarks", HERE)))}
    program = [sys.executable, str(HERE / "hostile_run.py"), str(folder / "runs"), str(folder / "outside"), *more]
    done = subprocess.run(program, capture_output=True, text=True, env=environ, cwd=folder, timeout=600)
    assert done.returncode == 0, done.stderr[-3000:]
    return dict(json.loads(done.stdout))


@pytest.mark.parametrize("methods", ["one", pytest.param("all", marks=pytest.mark.long)])
def test_no_answer_does_anything(tmp_path: Path, methods: str) -> None:
    told = played(tmp_path, methods)
    assert told["seen"] == []
    assert [path.name for path in tmp_path.iterdir()] == ["runs"]
    ends = told["ends"]
    assert len(ends) >= 2 * (1 if methods == "one" else 2) * 45
    for end in ends:
        assert not end["success"] and end["scored"] and end["error"] is None, end
        assert end["rounds"] <= 6, end


def test_a_planner_that_obeys_is_caught(tmp_path: Path) -> None:
    seen = played(tmp_path, "obey", "one")["seen"]
    assert any("os.system" in line for line in seen)
    assert any(" open " in line for line in seen)
    assert any(" compile " in line or " exec " in line for line in seen)
