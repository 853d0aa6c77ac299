"""Tries every supported Python, with the newest dependencies and with the oldest that pyproject.toml allows.

    python .ci/versions.py [--only 3.11-oldest] [--processes 2]

Each gets an environment in a temporary folder and the fast tests that need no physics. Pythons are looked for as
python3.X on the path and below ~/.pyenv. One that is not there is named, and the exit code is 1 as where tests fail:
what was not tried is not known to work.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TESTS = ("tests/env", "tests/symbolic", "tests/agents/planning", "tests/contract/test_contract_libraries.py",
         "tests/contract/test_vector_environments.py", "tests/bench/test_bench_lines.py",
         "tests/bench/test_bench_cli.py", "tests/bench/test_bench_report.py", "tests/test_examples.py")  # fmt: skip
TOOLS = ("pytest", "pytest-xdist", "hypothesis")


def main() -> int:
    """Try each and print a line; the exit code is 1 where one fails."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", help="one of the names that are printed, such as 3.12-newest")
    parser.add_argument("--processes", default="2")
    given = parser.parse_args()
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    listed = [c.rpartition(" ")[2] for c in project["classifiers"] if re.fullmatch(r".* :: 3\.\d+", c)]
    failed = 0
    for version in listed:
        # The oldest NumPy of all has no wheels for later Pythons: the oldest of everything is tried on the first.
        for age in ("oldest", "newest") if version == listed[0] else ("newest",):
            name = f"{version}-{age}"
            if given.only not in (None, name):
                continue
            python = found(version)
            if python is None:
                passed, told = False, f"not tried: no python{version} on the path, and none below ~/.pyenv/versions"
            else:
                passed, told = tried(python, oldest(project) if age == "oldest" else [], given)
            failed += not passed
            print(f"{name}: {told}", flush=True)
    return 1 if failed else 0


def oldest(project: dict[str, list[str]]) -> list[str]:
    """Each dependency at its lower bound: "numpy>=1.26" as "numpy==1.26.*"."""
    bounds = (re.match(r"([\w-]+)>=([\d.]+)", line) for line in project["dependencies"])
    return [f"{bound[1]}=={bound[2]}.*" for bound in bounds if bound]


def found(version: str) -> str | None:
    """The newest Python of a version on this machine."""
    below = sorted(Path.home().glob(f".pyenv/versions/{version}.*/bin/python"))
    return str(below[-1]) if below else shutil.which(f"python{version}")


def tried(python: str, pins: list[str], given: argparse.Namespace) -> tuple[bool, str]:
    """Install and test: whether all is well, and the last line of the tests, or the errors of what failed."""
    with tempfile.TemporaryDirectory() as folder:
        made = f"{folder}/env/bin/python"
        quiet = ["--quiet", "--disable-pip-version-check", *pins]
        lines = (
            [python, "-m", "venv", f"{folder}/env"],
            [made, "-m", "pip", "install", *quiet, "--editable", str(ROOT), *TOOLS],
            [made, "-m", "pytest", "-p", "no:cacheprovider", "-n", given.processes, "-m", "not long", *TESTS],
        )
        for line in lines:
            done = subprocess.run(
                line, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False
            )
            if done.returncode:
                bad = [told for told in done.stdout.splitlines() if told.startswith(("ERROR", "FAILED", "E  "))]
                return False, f"{' '.join(line[1:4])} failed: {'; '.join(bad[-8:]) or done.stdout[-300:]}"
        return True, done.stdout.rstrip().rpartition("\n")[2]


if __name__ == "__main__":
    sys.exit(main())
