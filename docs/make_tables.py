"""Makes the tables of README and docs anew from the commands that stand beside them.

    python docs/make_tables.py            every table: minutes, on two cores
    python docs/make_tables.py --fast     those that take seconds
    python docs/make_tables.py --check    the same, and nothing is written: exit code 1 where one differs

A table stands between two comments, of which the first holds its command; what the command prints is the table:

    <!-- table: python benchmarks/offline_tables.py mixed -->
    ...
    <!-- end of table -->

`table slow` takes longer than some seconds, or prints times; `text` puts what is printed into a block of its own. DIR
in a command stands for a folder that is made for it; parts with && between them run one after the other, and the last
prints.
"""

from __future__ import annotations

import argparse
import os
import re
import shlex
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGES = (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))

_TABLE = re.compile(
    r"(?P<head><!-- table(?P<words>(?: slow| text)*): (?P<command>[^\n]+?) -->\n)"
    r"(?P<body>.*?)(?P<tail><!-- end of table -->)",
    re.S,
)


@dataclass(frozen=True)
class Table:
    """One table of a page: its command, how it is shown, and what stands there."""

    page: Path
    command: str
    slow: bool
    text: bool
    body: str

    def made(self) -> str:
        """What should stand there."""
        printed = run(self.command).strip()
        return f"```text\n{printed}\n```\n" if self.text else f"\n{printed}\n\n"


def tables() -> list[Table]:
    """All tables, in the order of the pages."""
    found = []
    for page in PAGES:
        for match in _TABLE.finditer(page.read_text("utf-8")):
            words = match["words"].split()
            found.append(Table(page, match["command"], "slow" in words, "text" in words, match["body"]))
    return found


def run(command: str) -> str:
    """What the last part of a command prints.

    Raises:
        subprocess.CalledProcessError: if a part fails.
    """
    with tempfile.TemporaryDirectory() as folder:
        printed = ""
        for part in command.split(" && "):
            words = [word.replace("DIR", folder) if "DIR" in word else word for word in shlex.split(part)]
            start = {"remac": [sys.executable, "-m", "remac_bench"], "python": [sys.executable]}[words[0]]
            environment = {**os.environ, "COLUMNS": "120"}
            done = subprocess.run(
                [*start, *words[1:]], cwd=ROOT, env=environment, check=True, stdout=subprocess.PIPE, text=True
            )
            printed = done.stdout.replace(folder, "DIR")
        return "\n".join(line.rstrip() for line in printed.splitlines())


def main() -> int:
    """Make or check the tables; the exit code."""
    parser = argparse.ArgumentParser(description="Make the tables of README and docs anew.")
    parser.add_argument("--fast", action="store_true", help="only those that take seconds")
    parser.add_argument("--check", action="store_true", help="the same, write nothing: exit code 1 where one differs")
    given = parser.parse_args()
    stale = 0
    for table in tables():
        if table.slow and (given.fast or given.check):
            continue
        made = table.made()
        if made == table.body:
            continue
        stale += 1
        where = f"{table.page.relative_to(ROOT)}: {table.command}"
        if given.check:
            sys.stderr.write(f"stale table in {where}\n{made}\n")
            continue
        sys.stderr.write(f"made anew: {where}\n")
        table.page.write_text(_put(table.page.read_text("utf-8"), table, made), "utf-8")
    return 1 if given.check and stale else 0


def _put(text: str, table: Table, made: str) -> str:
    """The page with this table's body, found by its command, replaced."""

    def replaced(match: re.Match[str]) -> str:
        return match["head"] + (made if match["command"] == table.command else match["body"]) + match["tail"]

    return _TABLE.sub(replaced, text)


if __name__ == "__main__":
    sys.exit(main())
