"""What one episode of each task costs in physics, counted and not timed: steps, collision checks, contacts.

Wasted work shows as more of them on any machine. After a change that is meant to cost more or less, run this file as a
script: it prints the table anew, for tests/data/episode_costs.toml.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import mujoco
import pytest

import remac_env
from remac_env.oracle import solve

TABLE = Path(__file__).parents[1] / "data" / "episode_costs.toml"
TASKS = ("OpenCabinetPnP", "OpenMicrowavePnP", "DefrostInBowl", "HeatOnStove")
CELL = {"style": "modern_1", "layout": "one_wall_large"}
SEED = 0

MOST = 1.5
"""As many times the stored count are allowed, and a few more where the count is small."""

LEAST = 0.3
"""Below this share of the stored count the table is out of date, or something is not counted any more."""

FEW = {"rounds": 0.0, "steps": 500.0, "control_steps": 50.0, "checks": 200.0, "contacts": 3.0}
"""What may be added to each count in any case."""

Costs = Mapping[str, float]


@contextmanager
def counted_steps() -> Iterator[list[int]]:
    """The steps of each call of mj_step, by whomever, while in the block."""
    calls: list[int] = []
    plain = mujoco.mj_step

    def counting(model: Any, data: Any, nstep: int = 1) -> None:
        calls.append(nstep)
        plain(model, data, nstep)

    mujoco.mj_step = counting
    try:
        yield calls
    finally:
        mujoco.mj_step = plain


def costs(task: str, *, detours: int = 0) -> Costs:
    """What the oracle's plan for two robots costs; `detours`: rounds in which one robot only goes somewhere before."""
    env: Any = remac_env.parallel_env(task, robots=2, **CELL)
    contacts: list[int] = []
    with counted_steps() as calls:
        env.reset(seed=SEED)
        env._backend.watch = lambda: contacts.append(int(env._backend.data.ncon))
        encode = env.vocabulary.encode
        for number in range(detours):
            goer = min(env.agents)
            place = "sink" if number % 2 else "stove"
            env.step({name: encode(f"navigate to {place}" if name == goer else "wait") for name in env.agents})
        plan = solve(env.start.scene, env.world, env.goal)
        assert plan is not None
        for joint in plan.rounds:
            *_, infos = env.step({name: encode(subtask.text) for name, subtask in joint.items()})
    told = next(iter(infos.values()))
    if not told["success"]:
        raise AssertionError(f"the plan for {task} failed: {[info['outcome'] for info in infos.values()]}")
    team = env._backend._timeline._team
    found = {
        "rounds": float(told["round"]),
        "steps": float(sum(calls)),
        "control_steps": float(len(calls)),
        "checks": float(sum(here.clear.checker.checks for here in team.robots.values())),
        "contacts": round(sum(contacts) / len(contacts), 1),
    }
    env.close()
    return found


def faults(found: Costs, stored: Costs) -> list[str]:
    """The counts that are out of their bands."""
    if set(found) != set(stored) or set(found) != set(FEW):
        return [f"counts {sorted(found)}, stored {sorted(stored)}; valid: {sorted(FEW)}"]
    return [
        f"{name}: {count:g}, stored {stored[name]:g}"
        for name, count in found.items()
        if not LEAST * stored[name] - FEW[name] <= count <= MOST * stored[name] + FEW[name]
    ]


@pytest.mark.few(2)
@pytest.mark.parametrize("task", TASKS)
def test_an_episode_costs_no_more_than_it_did(task: str) -> None:
    stored = tomllib.loads(TABLE.read_text(encoding="utf-8"))[task]
    found = faults(costs(task), stored)
    assert not found, f"{'; '.join(found)}. If this is meant: python {Path(__file__).name} > {TABLE.name}"


def test_wasted_work_is_noticed() -> None:
    """Rounds of going to and fro cost no check too many, but steps and rounds."""
    stored = tomllib.loads(TABLE.read_text(encoding="utf-8"))["OpenCabinetPnP"]
    found = faults(costs("OpenCabinetPnP", detours=8), stored)
    assert any(fault.startswith("rounds") for fault in found) and any(fault.startswith("steps") for fault in found)


@pytest.mark.parametrize("name", FEW)
def test_each_count_has_a_band(name: str) -> None:
    stored = dict.fromkeys(FEW, 1000.0)
    assert faults(stored, stored) == []
    for count in (2100.0, -300.0):
        assert [fault.split(":")[0] for fault in faults({**stored, name: count}, stored)] == [name]
    assert faults({k: v for k, v in stored.items() if k != name}, stored)


def table() -> str:
    """The table as it is now, TOML."""
    lines = [
        "# What the oracle's plan for two robots costs in physics, one episode a task; see test_endurance_counters.py,",
        "# which prints this. steps: of 5 ms; checks: collision checks of all robots; contacts: mean a control step.",
    ]
    for task in TASKS:
        lines += ["", f"[{task}]", *(f"{name} = {count:g}" for name, count in costs(task).items())]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    print(table(), end="")
