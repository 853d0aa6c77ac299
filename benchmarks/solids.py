"""How deep solid objects reach into one another: `python benchmarks/solids.py --trials 5`.

Staged: dishes and cups fall onto the worktop's edge and onto the spout of the faucet, and every door is pushed open as
far as it goes, in every layout. In play: the chains of skill_chains.toml, measured at every step of 5 ms. The depth of
a pair of colliders is the shortest way that parts them, whether or not the simulation lets them touch; robots are left
out, as every link of theirs touches everything. It is told too how far what is drawn of a kitchen stands out of its
colliders.
"""

from __future__ import annotations

import copy
import tomllib
from collections.abc import Iterable, Mapping
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

import mujoco
import numpy as np
from drawn_solids import standing_out
from numpy.typing import NDArray
from remac_bench.columns import show
from remac_bench.command import run_script
from remac_bench.flags import takes
from rich.table import Table
from skills import CHAINS, run_chain

from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.kitchen import layout as layouts
from remac_env.kitchen import style as styles
from remac_env.kitchen.builder import build_model
from remac_env.kitchen.fixtures import models
from remac_env.kitchen.fixtures.base import COUNTER_Z
from remac_env.kitchen.fixtures.faucet import SPOUT_Y
from remac_env.kitchen.layout import Layout
from remac_env.kitchen.objects import catalogue
from remac_env.state import FrozenMap

Depths = dict[tuple[str, str], float]
"""m, by the two bodies that reach into one another."""

LEAST = 0.002
"""m; what reaches less deep than this is how contacts hold, and is left out of the tables."""

_OBJECT, _FURNITURE, _PANEL = (2, 3), (1, 0), (1, 1)  # contype, conaffinity
_BEFORE, _ABOVE = 0.012, 0.010  # m before the worktop's front and above what it falls onto at which a dish starts
_FALL = 300  # steps in which it comes to rest
_SEEN = 0.006  # m; what stands out of what is solid by less is left out
_PUSH, _PUSHED = 1.0, 700  # N m with which a door is pushed open, and for how many steps


class Solids:
    """Measures a model's colliders, all of which meet here: objects, furniture, and door panels."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self.model = copy.copy(model)
        self.names = [model.body(number).name for number in range(model.nbody)]
        free = {int(body) for body, kind in zip(model.jnt_bodyid, model.jnt_type, strict=True) if kind == 0}
        self._objects = free
        for geom, body in enumerate(model.geom_bodyid.tolist()):
            masks = (0, 0)
            if body in free:
                masks = _OBJECT
            elif "robot" not in self.names[body] and (model.geom_contype[geom] or model.geom_conaffinity[geom]):
                masks = _PANEL if self.names[body].endswith("door") else _FURNITURE
            self.model.geom_contype[geom], self.model.geom_conaffinity[geom] = masks
        for body in range(model.nbody):
            of = model.geom_bodyid == body
            self.model.body_contype[body] = np.bitwise_or.reduce(self.model.geom_contype[of], initial=0)
            self.model.body_conaffinity[body] = np.bitwise_or.reduce(self.model.geom_conaffinity[of], initial=0)
        self.model.opt.enableflags = 0
        self.data = mujoco.MjData(self.model)

    def measure(self, qpos: NDArray[np.float64], deepest: Depths) -> list[tuple[str, str]]:
        """Raise `deepest` to what is found at `qpos`; return the pairs for which it rose."""
        data, rose = self.data, []
        data.qpos[:] = qpos
        mujoco.mj_kinematics(self.model, data)
        mujoco.mj_collision(self.model, data)
        for number in np.flatnonzero(data.contact.dist[: data.ncon] < -LEAST):
            geoms = data.contact.geom[number].tolist()
            pair = self._pair(*geoms)
            depth = -float(data.contact.dist[number])
            if pair is None or depth <= deepest.get(pair, 0.0):
                continue
            # Two boxes now and then have a contact where they do not meet; the shortest way apart is asked for too.
            depth = min(depth, -float(mujoco.mj_geomDistance(self.model, data, *geoms, 0.1, None)))
            if depth > max(LEAST, deepest.get(pair, 0.0)):
                deepest[pair] = depth
                rose.append(pair)
        return rose

    def _pair(self, one: int, other: int) -> tuple[str, str] | None:
        """The bodies of two geoms, an object or door panel first; None for two parts of one fixture."""
        bodies = sorted((int(self.model.geom_bodyid[geom]) for geom in (one, other)), key=self._rank)
        first, second = (self.names[body] for body in bodies)
        same = first.partition("/")[0] == second.partition("/")[0]
        return None if same and not self._objects & set(bodies) else (first, second)

    def _rank(self, body: int) -> tuple[int, str]:
        name = self.names[body]
        return (0 if body in self._objects else 1 if name.endswith("door") else 2), name


class Probe:
    """Measures a backend at every step; to be set as its ``probe``. `commands`: where each pair was deepest."""

    def __init__(self, backend: PhysicsBackend) -> None:
        self._data, self._solids = backend.data, Solids(backend.model)
        self.depths: Depths = {}
        self.commands: dict[tuple[str, str], str] = {}
        self.command = ""

    def __call__(self) -> None:
        """One step has been simulated."""
        for pair in self._solids.measure(self._data.qpos, self.depths):
            self.commands[pair] = self.command


def fall(layout: Layout, category: str, *, onto: str) -> tuple[Depths, Depths]:
    """Let a dish fall onto the worktop's edge, or onto the spout: how deep it goes, and how deep it is in the end."""
    model = build_model(layout, robots=(), objects={category: category})
    solids, data, deepest, rest = Solids(model), mujoco.MjData(model), Depths(), Depths()
    for x, y, z in _edges(layout) if onto == "worktop" else _spouts(layout, catalogue.get(category).size[0]):
        mujoco.mj_resetData(model, data)
        data.joint(category).qpos[:3] = x, y, z
        _run(model, solids, data, _FALL, deepest)
        solids.measure(data.qpos, rest)
    return deepest, rest


def swing(layout: Layout) -> tuple[Depths, float]:
    """Push every door panel open, one at a time: the depths, and the least angle (rad) to which one comes."""
    model = build_model(layout, robots=(), objects={})
    solids, data, deepest, angles = Solids(model), mujoco.MjData(model), Depths(), []
    for panel in (panel for fixture in layout.fixtures.values() for panel in fixture.door_panels):
        mujoco.mj_resetData(model, data)
        data.joint(panel.joint).qfrc_applied[0] = _PUSH
        _run(model, solids, data, _PUSHED, deepest)
        angles.append(float(data.joint(panel.joint).qpos[0]))
    return deepest, min(angles)


def play(chain: Mapping[str, Any], seed: int) -> tuple[Depths, dict[tuple[str, str], str]]:
    """Run a chain on a seed: the depths, and the commands during which they were found."""
    probes: list[Probe] = []

    def before(backend: PhysicsBackend, text: str) -> None:
        if not probes:
            probes.append(Probe(backend))
        backend.probe = probes[0]
        probes[0].command = f"{text} ({chain['name']} {seed})"

    run_chain(chain, seed, style=None, layout=None, perception_noise=0.0, before=before)
    return (probes[0].depths, probes[0].commands) if probes else ({}, {})


@takes("solids.trials", "script.first_seed", "script.only", "solids.staged", "script.processes")
def main(*, trials: int, first_seed: int, only: str, staged: bool, processes: int) -> None:
    """Print how deep colliders reach into one another."""
    if staged:
        show(_falls())
        show(_doors())
        show(_drawn())
    chains = [chain for chain in tomllib.loads(CHAINS.read_text("utf-8"))["chain"] if only in chain["name"]]
    jobs = [(chain, first_seed + number) for chain in chains for number in range(trials)]
    if not jobs:
        return
    deepest, commands = Depths(), dict[tuple[str, str], str]()
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        for depths, during in pool.map(_job, jobs):
            for pair, depth in depths.items():
                if depth > deepest.get(pair, 0.0):
                    deepest[pair], commands[pair] = depth, during[pair]
    table = Table("object", "into", "deepest, mm", "during", title=f"In play, {len(jobs)} chains")
    for pair, depth in sorted(deepest.items(), key=lambda entry: -entry[1]):
        table.add_row(*pair, f"{1000 * depth:.1f}", commands[pair])
    show(table)


def _job(job: tuple[Mapping[str, Any], int]) -> tuple[Depths, dict[tuple[str, str], str]]:
    return play(*job)


def _falls() -> Table:
    table = Table("what falls", "onto", "on impact, mm", "at rest, mm", "deepest into", title="Falls onto edges")
    layout = layouts.load("one_wall_large")
    for name, category in catalogue.load().items():
        if category.body.form in ("dish", "cup"):
            for onto in ("worktop", "spout"):
                impact, rest = fall(layout, name, onto=onto)
                table.add_row(name, onto, _shown(impact), _shown(rest), _where(impact))
    return table


def _doors() -> Table:
    table = Table("layout", "doors open to, rad", "deepest, mm", "where", title="Doors pushed open, of every variant")
    for name in layouts.names():
        deepest, least = Depths(), np.inf
        for variant in models.names("cabinet"):
            depths, angle = swing(layouts.load(name, FrozenMap({"cabinet": variant})))
            least = min(least, angle)
            for pair, depth in depths.items():
                deepest[pair] = max(deepest.get(pair, 0.0), depth)
        table.add_row(name, f"{least:.2f}", _shown(deepest), _where(deepest))
    return table


def _drawn() -> Table:
    """By kind of fixture, over all layouts and styles."""
    table = Table("fixture", "part, by its material", "stands out, mm", title="Visual parts without collision geometry")
    deepest = Depths()
    for number, style in enumerate(styles.names()):
        names = layouts.names()
        layout = names[number % len(names)]
        kinds = {name: fixture.kind for name, fixture in layouts.load(layout).fixtures.items()}
        for (name, part), depth in standing_out(layout, style).items():
            key = kinds.get(name, name), part
            deepest[key] = max(deepest.get(key, 0.0), depth)
    for key, depth in sorted(deepest.items(), key=lambda entry: -entry[1]):
        if depth > _SEEN:
            table.add_row(*key, f"{1000 * depth:.0f}")
    return table


def _shown(depths: Depths) -> str:
    return f"{1000 * max(depths.values()):.1f}" if depths else f"under {1000 * LEAST:g}"


def _where(depths: Depths) -> str:
    return " into ".join(max(depths, key=lambda pair: depths[pair])) if depths else ""


def _run(model: mujoco.MjModel, solids: Solids, data: mujoco.MjData, steps: int, deepest: Depths) -> None:
    for _ in range(steps):
        mujoco.mj_step(model, data)
        solids.measure(data.qpos, deepest)


def _edges(layout: Layout) -> Iterable[tuple[float, float, float]]:
    """Over the front of the worktop, in the world."""
    slot = next(s for s in layout.slots.values() if s.kind == "surface")
    return [(slot.center[0], -_BEFORE, COUNTER_Z + _ABOVE)]


def _spouts(layout: Layout, radius: float) -> Iterable[tuple[float, float, float]]:
    """Over the spout: with the middle, with the wall, and with the wall half way to it."""
    x = next(f.x for f in layout.fixtures.values() if f.kind == "faucet")  # type: ignore[attr-defined]
    return [(x + aside, SPOUT_Y - before, 1.11) for aside in (0.0, radius) for before in (0.0, 0.8 * radius, radius)]


if __name__ == "__main__":
    run_script(main)
