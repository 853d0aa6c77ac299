"""Builds wheel and source archive, checks them, and tries each in an empty environment: `make wheel`.

    python .ci/package.py [--to dist]

Needs `build` and `twine`, which `make wheel` installs apart. What is tried runs outside the checkout.
"""

from __future__ import annotations

import argparse
import os
import shlex
import subprocess
import sys
import tempfile
import zipfile
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
NEEDED = (
    *("remac_env/py.typed", "remac_agents/py.typed", "remac_bench/py.typed"),
    *("remac_env/nouns.toml", "remac_agents/prompts/", "remac_bench/suite_files/paper.toml", "remac_bench/pages/"),
    "remac_env/kitchen/fixtures/certified/panda.toml",
)
"""Files, or beginnings of names, that a wheel must hold."""

UNWANTED = ("tests/", "docs/", "examples/", "build/")

PLAY = """
import remac_env
env = remac_env.parallel_env("HeatOnStove", robots=1)
env.reset(seed=0)
*_, infos = env.step({"robot_0": env.vocabulary.encode("navigate to pan")})
assert infos["robot_0"]["outcome"]["status"] == "success"
"""

TRIES = (
    "-m remac_env",
    "-m remac_agents",
    "-m remac_bench --version",
    "-m remac_bench tasks",
    "-m remac_bench bench run --tasks HeatOnStove --methods BASE,CC --seeds 0 --jobs 0 --backend symbolic --out out",
    "-m remac_bench bench report out",
    "-m remac_bench bench verify out",
    f"-c {shlex.quote(PLAY)}",
)
"""What an installation must be able to do, outside the checkout."""


def main() -> int:
    """Build, check and try; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--to", type=Path, default=ROOT / "dist")
    folder = parser.parse_args().to
    for old in folder.glob("remac_kitchen-*"):
        old.unlink()
    run([sys.executable, "-m", "build", "--outdir", str(folder), str(ROOT)])
    made = sorted(folder.glob("remac_kitchen-*"))
    run([sys.executable, "-m", "twine", "check", "--strict", *map(str, made)])
    for path in made:
        if path.suffix == ".whl":
            check_wheel(path)
        tried(path)
    for path in made:
        print(f"{path.name}: {path.stat().st_size / 1e6:.1f} MB, installed and tried")
        if path.suffix == ".whl":
            print(f"  unpacked {held(path)}")
    return 0


def held(path: Path) -> str:
    """How large what a wheel holds is, in MB, and what of: by the ends of file names."""
    sizes: Counter[str] = Counter()
    for each in zipfile.ZipFile(path).infolist():
        sizes[Path(each.filename).suffix or Path(each.filename).name] += each.file_size
    told = ", ".join(f"{size / 1e6:.1f} {kind}" for kind, size in sizes.most_common(3))
    return f"{sizes.total() / 1e6:.1f} MB: {told}"


def check_wheel(path: Path) -> None:
    """What a wheel holds and what not; SystemExit names what is wrong."""
    names = zipfile.ZipFile(path).namelist()
    missing = [needed for needed in NEEDED if not any(name.startswith(needed) for name in names)]
    strange = [name for name in names if name.startswith(UNWANTED)]
    if missing or strange:
        raise SystemExit(f"{path.name} lacks {missing} and should not hold {strange[:5]}")


def tried(path: Path) -> None:
    """Install into an empty environment, and do there what users do first."""
    with tempfile.TemporaryDirectory() as empty:
        run([sys.executable, "-m", "venv", f"{empty}/env"])
        python = f"{empty}/env/bin/python"
        run([python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", str(path)])
        clean = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        for line in TRIES:
            run([python, *shlex.split(line)], cwd=empty, env=clean)


def run(line: list[str], **more: object) -> None:
    """Run a command; SystemExit with what it printed where it fails."""
    done = subprocess.run(line, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, **more)
    if done.returncode:
        raise SystemExit(f"{' '.join(line)}: exit code {done.returncode}\n{done.stdout[-3000:]}")


if __name__ == "__main__":
    sys.exit(main())
