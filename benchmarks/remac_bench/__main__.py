"""`python -m remac_bench` is `remac`."""

from __future__ import annotations

from remac_bench.cli import main

if __name__ == "__main__":
    main()
