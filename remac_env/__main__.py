"""`python -m remac_env`: the version and the tasks."""

from __future__ import annotations

import sys

import remac_env

if __name__ == "__main__":
    sys.stdout.write(f"remac_env {remac_env.__version__}; tasks: {', '.join(remac_env.tasks())}\n")
