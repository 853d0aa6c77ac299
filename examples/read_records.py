"""Reads the records of a run: one line of JSON an episode, and everything is in it."""

import subprocess
import sys

from remac_bench.store import Store

RUN = "bench run --tasks HeatOnStove --methods BASE,CC --seeds 0:3 --backend symbolic --jobs 0 --out example_run"
subprocess.run([sys.executable, "-m", "remac_bench", *RUN.split()], check=True)  # in a shell: remac bench run ...
for record in Store("example_run").read():
    print(record.method, record.task, record.seed, "success" if record.success else record.end, record.final_plan)
    for number, outcomes in enumerate(record.outcomes, 1):
        for robot, outcome in outcomes.items():
            print("  round", number, robot, outcome.subtask, "->", outcome.status, outcome.reason or "")
