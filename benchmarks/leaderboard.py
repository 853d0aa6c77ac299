"""Runs a benchmark: the same as `remac bench run`, with the same flags."""

from __future__ import annotations

import sys

from remac_bench.cli import app


def main() -> None:
    """Pass the command line on."""
    app(["bench", "run", *sys.argv[1:]])


if __name__ == "__main__":
    main()
