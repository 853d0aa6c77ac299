"""`python benchmarks/leaderboard.py --suite paper --model openai:o3`: the same as `remac bench run --suite ...`."""

from __future__ import annotations

import sys

from remac_bench.cli import app


def main() -> None:
    """Run the command with the flags given."""
    app(args=["bench", "run", *sys.argv[1:]], prog_name="leaderboard.py")


if __name__ == "__main__":
    main()
