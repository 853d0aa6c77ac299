"""Where nothing is drawn OpenCV is not needed: it may be missing, and what draws says what to install."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

MISSING = "import sys\nsys.modules['cv2'] = None\n"  # an import of it then fails, as where it is not installed

PLAYS = """
import remac_env
for backend in ("symbolic", "physics"):
    env = remac_env.parallel_env("OpenCabinetPnP", robots=1, backend=backend, render_mode="rgb_array")
    env.reset(seed=0)
    *_, infos = env.step({"robot_0": env.vocabulary.encode("wait")})
    print(backend, infos["robot_0"]["outcome"]["status"])
try:
    env.render()
except remac_env.errors.RenderingError as error:
    print(error)
"""

REPORTS = """
from remac_bench.cli import app
from typer.testing import CliRunner
run = "bench run --tasks HeatOnStove --methods BASE --seeds 0 --backend symbolic --jobs 0 --video all --out out"
for line in (run, "bench report out"):
    print(CliRunner().invoke(app, line.split()).exit_code)
"""


def said(code: str, folder: Path) -> list[str]:
    """What Python prints where OpenCV is missing."""
    paths = os.pathsep.join(map(str, (ROOT, ROOT / "benchmarks")))
    done = subprocess.run(
        [sys.executable, "-c", MISSING + code], cwd=folder, env={**os.environ, "PYTHONPATH": paths},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


def test_both_backends_play_and_a_picture_says_what_it_needs(tmp_path: Path) -> None:
    symbolic, physics, told = said(PLAYS, tmp_path)
    assert symbolic == "symbolic success" and physics == "physics success"
    assert told.endswith("install it: opencv-python-headless")


@pytest.mark.long
def test_a_run_is_recorded_and_reported_with_its_tables_as_drawings(tmp_path: Path) -> None:
    assert said(REPORTS, tmp_path) == ["0", "0"]
    made = {path.suffix for path in (tmp_path / "out" / "tables").iterdir()}
    assert made == {".svg"} and (tmp_path / "out" / "leaderboard.html").is_file()
    assert "opencv-python-headless" in (tmp_path / "out" / "records.jsonl").read_text("utf-8")
