"""Prints what a process of its own takes for a job: `python benchmarks/isolation.py`."""

from __future__ import annotations

import statistics
import time

import typer
from remac_bench.command import run_script
from remac_bench.flags import takes

from remac_agents.isolation.remote import ForkServer, Host

JOBS = 50


@takes()
def main() -> None:
    """Start a server, and for each job a process that makes its roles."""
    began = time.perf_counter()
    server = ForkServer({"planner": "remac_agents.planners.literal:LiteralPlanner"})
    imported = time.perf_counter() - began
    taken = []
    for _ in range(JOBS):
        began = time.perf_counter()
        host = Host(server)
        host.roles()
        host.end()
        taken.append(1000 * (time.perf_counter() - began))
    server.close()
    middle = statistics.median(taken)
    typer.echo(f"server {imported:.2f} s, once a worker; a job: median {middle:.0f} ms of {JOBS}")


if __name__ == "__main__":
    run_script(main)
