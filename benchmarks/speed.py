"""How fast everything is: `python benchmarks/speed.py [--json FILE]`. Medians of CPU time, warm, never a test.

Beside each figure stands what the project aims at. Wall and CPU time depend on the machine and on what else runs; the
counters (mj_step calls, contacts, constraint rows) do not.
"""

from __future__ import annotations

import gc
import json
import os
import resource
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from functools import partial
from itertools import cycle
from pathlib import Path
from statistics import median
from time import process_time

import clock_speed
import gymnasium
import numpy as np
import robosuite_speed
import typer
from remac_bench.columns import show
from remac_bench.command import run_script
from remac_bench.flags import takes
from rich.table import Table

import remac_env
from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.backends.physics.simulation import SUBSTEPS
from remac_env.files import prepare_file
from remac_env.oracle import solve
from remac_env.rules.rounds import transition
from remac_env.rules.subtasks import Subtask
from remac_env.start import Start
from remac_env.tasks.goals import Goal

TASK = "OpenMicrowavePnP"
REPEATS = 5


@dataclass(frozen=True)
class Figure:
    """One measured figure: its name, the median, its unit, and what is aimed at ("" where nothing is)."""

    name: str
    value: float
    unit: str
    aim: str = ""


@takes("script.file", "script.only")
def main(*, file: Path | None, only: str) -> None:
    """Measure and print."""
    chosen = [group for name, group in GROUPS.items() if only in name]
    if not chosen:
        raise typer.BadParameter(f"no group has {only!r} in its name; choose from {', '.join(GROUPS)}")
    if file is not None:
        prepare_file(file, "--json")
    figures = [figure for group in chosen for figure in group()]
    table = Table("figure", "median", "unit", "aim", title="Speed, CPU time of one core")
    for figure in figures:
        table.add_row(figure.name, f"{figure.value:,.4g}", figure.unit, figure.aim)
    show(table)
    if file is not None:
        file.write_text(json.dumps([asdict(figure) for figure in figures], indent=1) + "\n", "utf-8")


# -- physics --------------------------------------------------------------------------------------------------------


def physics() -> Iterator[Figure]:
    """Whole episodes of two robots, and what a control step costs while both move."""
    _team_episode(REPEATS)  # warm: what is imported and made once a process is not what a step costs
    runs = [_team_episode(seed) for seed in range(REPEATS)]
    rates = [run["control steps"] / run["seconds"] for run in runs]
    yield Figure("two robots: control steps a second, planning included", median(rates), "1/s", ">= 600")
    yield Figure("two robots: simulation alone", median(_stepping(seed) for seed in range(REPEATS)), "1/s")
    yield Figure("two robots: mj_step calls of an episode", median(run["mj_step calls"] for run in runs), "calls")
    for counter in ("contacts", "constraint rows"):
        yield Figure(f"two robots: {counter}", median(run[counter] for run in runs), "mean of a step")
    yield Figure("REMAC-length episode of two robots", median(run["seconds"] for run in runs), "s", "< 1")
    peer = robosuite_speed.rate("TwoArmLift", "Panda", 2)
    if peer is not None:
        yield Figure("two robots: steps for each of robosuite's TwoArmLift", median(rates) / peer, "", ">= 25")


def _team_episode(seed: int) -> dict[str, float]:
    """The shortest plan of two robots, carried out."""
    backend, start, goal = _team(seed)
    plan = solve(start.scene, start.world, goal)
    if plan is None:
        raise RuntimeError(f"{TASK} with seed {seed} has no plan")
    counts: list[tuple[int, int]] = []
    backend.watch = lambda: counts.append((backend.data.ncon, backend.data.nefc))
    began, calls = process_time(), 0
    for joint in plan.rounds:
        calls += backend.run_round(joint).counters.physics_steps
    seconds = process_time() - began
    contacts, rows = np.mean(counts, axis=0)
    return {
        "seconds": seconds,
        "control steps": len(counts),
        "mj_step calls": calls,
        "contacts": float(contacts),
        "constraint rows": float(rows),
    }


def _team(seed: int) -> tuple[PhysicsBackend, Start, Goal]:
    """A kitchen for two robots in physics."""
    env = remac_env.parallel_env(TASK, robots=2, backend="symbolic")
    env.reset(seed=seed)
    backend = PhysicsBackend()
    backend.reset(env.start)
    return backend, env.start, env.goal


def _stepping(seed: int) -> float:
    """Control steps a second of the simulation while both robots sway, without planning and skills."""
    import mujoco

    backend, _, _ = _team(seed)
    middle, count = backend.data.ctrl.copy(), 400
    began = process_time()
    for step in range(count):
        backend.data.ctrl[:] = middle + 0.05 * np.sin(0.1 * step)
        mujoco.mj_step(backend.model, backend.data, nstep=SUBSTEPS)
    return count / (process_time() - began)


# -- robosuite ------------------------------------------------------------------------------------------------------


def robosuite() -> Iterator[Figure]:
    """Control steps of robosuite's TwoArmLift and of our kitchen in robosuite, in one run, where it is installed."""
    ours = f"RemacKitchen{TASK}"
    cases = [("TwoArmLift", "Panda", 2, 0.002), *((ours, "PandaOmron", n, dt) for dt in (0.002, 0.005) for n in (2, 1))]
    for name, robot, count, step in cases:
        rate = robosuite_speed.rate(name, robot, count, step)
        if rate is not None:
            yield Figure(f"robosuite: env.step of {name}, {count} {robot}, {1000 * step:.0f} ms", rate, "1/s")


def skills() -> Iterator[Figure]:
    """Actions a second in an environment of a skill, without pictures."""
    for control in ("joints", "ee"):
        env = gymnasium.make("RemacSkill-PickUp-v0", target="vegetable", control=control, layout="one_wall_large")
        env.reset(seed=0)
        rate = 300 / sum(_timed(partial(lambda made: made.step(made.action_space.sample()), env), 300))
        yield Figure(f"skills: env.step of RemacSkill-PickUp-v0, control={control}", rate, "1/s", ">= 400")


# -- symbolic -------------------------------------------------------------------------------------------------------


def symbolic() -> Iterator[Figure]:
    """Transitions of the skill table, and rounds of the whole environment, under random legal commands."""
    yield Figure("symbolic transitions", median(_transitions(seed) for seed in range(REPEATS)), "1/s", ">= 100,000")
    yield Figure("symbolic env.step", median(_rounds(seed) for seed in range(REPEATS)), "1/s", ">= 10,000")


def _transitions(seed: int, count: int = 20_000) -> float:
    env = remac_env.parallel_env(TASK, robots=2, backend="symbolic")
    env.reset(seed=seed)
    scene, world, rng = env.start.scene, env.world, np.random.default_rng(seed)
    legal = [env.vocabulary.parse(text) or Subtask("wait") for text in env.vocabulary.commands(scene)]
    picks = rng.integers(len(legal), size=(count, 2)).tolist()
    began = process_time()
    for first, second in picks:
        world, _ = transition(scene, world, {"robot_0": legal[first], "robot_1": legal[second]})
    return count / (process_time() - began)


def _rounds(seed: int, count: int = 4_000) -> float:
    env = remac_env.parallel_env(TASK, robots=2, backend="symbolic", max_rounds=100_000)
    env.reset(seed=seed)
    tokens = [env.vocabulary.encode(text) for text in env.vocabulary.commands(env.start.scene)]
    picks = np.random.default_rng(seed).integers(2, len(tokens), size=(count, 2)).tolist()
    spent = 0.0
    for first, second in picks:
        began = process_time()
        env.step({"robot_0": tokens[first], "robot_1": tokens[second]})
        spent += process_time() - began
        if not env.agents:
            env.reset(seed=seed)
    return count / spent


def clocks() -> Iterator[Figure]:
    """What a simulated second costs by both clocks."""
    for backend, seeds in (("symbolic", range(REPEATS)), ("physics", range(2))):
        found = clock_speed.rates(backend, seeds)
        for clock, rate in found.items():
            yield Figure(f"{backend}, clock={clock}: simulated seconds a second", rate, "1/s")
        yield Figure(f"{backend}: events for each one with rounds", found["events"] / found["rounds"], "", ">= 1")


# -- starting -------------------------------------------------------------------------------------------------------


def starting() -> Iterator[Figure]:
    """Importing, the first kitchen of a process, and resets."""
    yield Figure("import remac_env", _in_new_process("import remac_env"), "s", "< 0.3")
    first = f"import remac_env; env = remac_env.parallel_env('{TASK}'); env.reset(seed=0)"
    yield Figure("import, first make and reset, physics", _in_new_process(first), "s", "< 1.5")
    env = remac_env.parallel_env(TASK, robots=2)
    env.reset(seed=0)
    yield Figure("reset in a known cell", 1000 * median(_timed(lambda: env.reset(seed=0), 200)), "ms", "< 5")
    fresh = [_timed(lambda seed=seed: env.reset(seed=seed), 1)[0] for seed in range(1, 12)]  # type: ignore[misc]
    yield Figure("reset of another seed", 1000 * median(fresh), "ms", "< 60")
    env.close()


def _in_new_process(code: str) -> float:
    program = f"from time import process_time as t; a = t(); exec({code!r}); print(t() - a)"
    return median(float(_printed(program)) for _ in range(3))


def _printed(program: str) -> str:
    return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout


def _timed(call: Callable[[], object], repeats: int = 20) -> list[float]:
    times = []
    for _ in range(repeats):
        began = process_time()
        call()
        times.append(process_time() - began)
    return times


# -- pictures and memory --------------------------------------------------------------------------------------------


def pictures() -> Iterator[Figure]:
    """Observation images of 128 pixels: three a robot and round, both robots moving in every one."""
    env = remac_env.parallel_env(TASK, robots=2, backend="symbolic", obs="state+images", image_size=128)
    env.reset(seed=0)
    there, back = (
        {robot: env.vocabulary.encode(f"navigate to {goal}") for robot, goal in zip(env.agents, goals, strict=True)}
        for goals in (("microwave", "cabinet"), ("sink", "stove"))
    )
    turns = cycle((there, back))
    env.step(next(turns))  # the first picture compiles the driver's programs
    times = _timed(lambda: env.step(next(turns)), 20)
    yield Figure("observation images at 128 px", 6 / median(times), "1/s", ">= 80")
    env.close()


def memory() -> Iterator[Figure]:
    """Resident memory of a process with one physics environment, and what each further one adds."""
    program = (
        "import resource, remac_env\n"
        "def used(): return int(open('/proc/self/statm').read().split()[1]) * resource.getpagesize() / 2**20\n"
        f"envs = [remac_env.parallel_env('{TASK}')]; envs[0].reset(seed=0); first = used()\n"
        f"for k in range(20): envs.append(remac_env.parallel_env('{TASK}')); envs[-1].reset(seed=0)\n"
        "print(first, (used() - first) / 20)"
    )
    if not os.path.exists("/proc/self/statm"):
        return
    first, further = map(float, _printed(program).split())
    yield Figure("memory: process with one physics environment", first, "MiB", "< 150")
    yield Figure("memory: each further one", further, "MiB", "< 2")
    env = remac_env.parallel_env(TASK, backend="symbolic")
    env.reset(seed=0)
    gc.collect()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for seed in range(5_000):
        env.reset(seed=seed)
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
    yield Figure("memory: growth over 5,000 symbolic resets", grown, "MiB", "0")


GROUPS: dict[str, Callable[[], Iterator[Figure]]] = {
    "physics": physics,
    "robosuite": robosuite,
    "skills": skills,
    "symbolic": symbolic,
    "clocks": clocks,
    "starting": starting,
    "pictures": pictures,
    "memory": memory,
}

if __name__ == "__main__":
    run_script(main)
