"""Robots among objects on the floor: `python benchmarks/littered.py --trials 12`.

Lays one to six objects of a kitchen on the floor around a robot, between it and where it is to go, or between its base
and the cupboards before which it stands; then every robot is told to go somewhere else, aside, and on. Prints how many
of these drives arrive, whether any robot never gets away, and how deep anything is pressed into the floor, the
furniture and the robots' bases, measured every 5 ms from its shape.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from multiprocessing import get_context

import mujoco
import numpy as np
from numpy.typing import NDArray
from remac_bench.columns import show
from remac_bench.command import run_script
from remac_bench.console import say
from remac_bench.flags import takes
from rich.table import Table

from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.kitchen import layout as layouts
from remac_env.kitchen import style as styles
from remac_env.kitchen.floor_plan import Layout, Station
from remac_env.kitchen.objects.catalogue import Category
from remac_env.kitchen.worlds import TaskWorlds
from remac_env.rules.outcomes import Outcome
from remac_env.rules.subtasks import Subtask
from remac_env.seeding import generator
from remac_env.start import Start
from remac_env.tasks.goals import Inside
from remac_env.tasks.spec import Role, TaskSpec

WAYS = ("ring", "row", "gap")
"""How objects lie: around a robot's base, in a row from it to where it goes, before the cupboards where it stands."""

_MOST = 6
_BASE = ((-0.42, 0.15), (-0.24, 0.24))  # m: spans of a base along its heading and across, from the arm's axis
_AIR = 0.03  # m between a base and the objects around it
_DRIVES = 6
_WHERE = ("the floor", "the floor at rest", "furniture", "a base")
_DEEP = 0.005  # m from which on a line says what was so deep


@dataclass
class Trial:
    """One staged start: how objects lay, how many, how many robots, what came of each drive, and what was measured."""

    seed: int
    way: str
    objects: int
    robots: int
    drives: list[tuple[str, str, Outcome]] = field(default_factory=list)
    stuck: list[str] = field(default_factory=list)
    depth: dict[str, float] = field(default_factory=lambda: defaultdict(float))
    deepest: dict[str, str] = field(default_factory=dict)


class Depths:
    """How deep objects are in the floor, furniture and robots (m); to be set as a backend's ``probe``."""

    def __init__(self, backend: PhysicsBackend, objects: Iterator[str] | list[str], trial: Trial) -> None:
        self._model, self._data, self._trial = backend.model, backend.data, trial
        model = self._model
        names = [model.body(b).name for b in range(model.nbody)]
        self._object = {b: name for b, name in enumerate(names) if name in set(objects)}
        self._kind = ["a base" if name.startswith("robot_") else "object" if b in self._object else "furniture"
                      for b, name in enumerate(names)]
        solid = (model.geom_contype != 0) | (model.geom_conaffinity != 0)
        self._geoms = [(g, self._object[b]) for g, b in enumerate(model.geom_bodyid.tolist())
                       if b in self._object and solid[g]]
        (self._plane,) = np.flatnonzero(model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE)
        self._ground = int(model.geom_bodyid[self._plane])

    def __call__(self) -> None:
        """One step has been simulated."""
        model, data = self._model, self._data
        for geom, name in self._geoms:
            if data.geom_xpos[geom, 2] < model.geom_rbound[geom]:
                gap = mujoco.mj_geomDistance(model, data, geom, int(self._plane), 1.0, None)
                self._note("the floor", -gap, name)
        bodies = model.geom_bodyid[data.contact.geom[: data.ncon]]
        for (one, other), gap in zip(bodies.tolist(), data.contact.dist[: data.ncon].tolist(), strict=True):
            for a, b in ((one, other), (other, one)):
                if a in self._object and data.xpos[a, 2] < 0.3 and b != self._ground and self._kind[b] != "object":
                    self._note(self._kind[b], -gap, f"{self._object[a]} in {model.body(b).name}")

    def at_rest(self) -> None:
        """A round has ended: what is still in the floor."""
        for geom, name in self._geoms:
            gap = mujoco.mj_geomDistance(self._model, self._data, geom, int(self._plane), 1.0, None)
            self._note("the floor at rest", -gap, name)

    def _note(self, where: str, depth: float, what: str) -> None:
        if depth > self._trial.depth[where]:
            self._trial.depth[where], self._trial.deepest[where] = depth, what


def play(seed: int, robots: int) -> Trial:
    """Stage a start and let robots drive."""
    worlds = TaskWorlds(_SPEC)
    names = tuple(f"robot_{k}" for k in range(robots))
    start, _ = worlds.start(seed, style=None, layout=None, starts="paper", robots=names, perception_noise=0.0)
    layout = worlds.layout_of(start)
    chance = generator(seed, "littered")
    way = WAYS[seed % len(WAYS)]
    trial = Trial(seed, way, 1 + seed // len(WAYS) % _MOST, robots)
    backend = PhysicsBackend(worlds)
    backend.reset(start)
    places = [str(name) for name in chance.permutation(_nouns(layout))]

    def drive(texts: list[str]) -> dict[str, Outcome]:
        subtasks: dict[str, Subtask] = {}
        for robot, text in zip(names, texts, strict=False):
            subtasks[robot] = worlds.vocabulary.subtask(worlds.vocabulary.encode(text))  # type: ignore[assignment]
        outcomes = dict(backend.run_round(subtasks).outcomes)
        trial.drives += [(robot, texts[k], outcomes[robot]) for k, robot in enumerate(names)]
        return outcomes

    if way == "gap" or chance.random() < 0.5:
        drive([f"navigate to {places[k]}" for k in range(robots)])
        trial.drives.clear()
    objects = list(start.categories)[: trial.objects]
    _lay(backend, worlds, start, objects, way, layout, names[int(chance.integers(robots))], places[-1])
    drive(["wait"] * robots)
    trial.drives.clear()
    backend.probe = depths = Depths(backend, list(start.categories), trial)
    for number in range(_DRIVES):
        target = places[-1 - number % len(places)]
        texts = [f"navigate to {target}" if number % 2 == k % 2 else "navigate aside" for k in range(robots)]
        drive(texts)
        depths.at_rest()
    trial.stuck = [n for n in names if not any(o.success for r, _, o in trial.drives if r == n)]
    return trial


def _lay(
    backend: PhysicsBackend, worlds: TaskWorlds, start: Start, objects: list[str], way: str, layout: Layout, robot: str,
    target: str,
) -> None:
    """Put objects on the floor: a start that no reset has, staged in the simulator's own state."""
    model, data, chance = backend.model, backend.data, generator(start.seed, "littered", way)
    x, y, yaw = _pose(backend, robot)
    turn = np.array([[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]])
    goal = _station(layout, target)
    line = np.array([goal.x - x, goal.y - y])
    along = math.atan2(*(turn.T @ line)[::-1])
    at = 0.0
    others = [_pose(backend, name) for name in start.robots if name != robot]
    for number, name in enumerate(objects):
        kind: Category = worlds.categories[start.categories[name]]
        reach = max(kind.size[:2])
        if way == "ring":
            point = _around(along + 2.0 * math.pi * number / len(objects), reach)
        elif way == "row":
            at = at + reach if at else float(np.linalg.norm(_around(along, reach)))
            point = np.array([math.cos(along), math.sin(along)]) * at
            at += reach + 0.02
        else:
            point = np.array([0.15 + _AIR + reach + 0.1 * float(chance.random()), 0.0])
            point[1] = (number - 0.5 * (len(objects) - 1)) * 0.16
        place = turn @ point + [x, y]
        if any(_in_base(pose, place, reach) for pose in others):
            continue  # nothing lies in another robot
        address, spin = int(model.joint(name).qposadr[0]), float(chance.uniform(-math.pi, math.pi))
        data.qpos[address : address + 3] = [*place, kind.rest_height + 0.002]
        data.qpos[address + 3 : address + 7] = [math.cos(0.5 * spin), 0.0, 0.0, math.sin(0.5 * spin)]
    mujoco.mj_forward(model, data)


def _around(angle: float, reach: float) -> NDArray[np.float64]:
    """A point (2,) beside a base, in its frame, in a direction."""
    step = np.array([math.cos(angle), math.sin(angle)])
    middle = np.array([np.mean(span) for span in _BASE])
    half = np.array([0.5 * (span[1] - span[0]) + _AIR + reach for span in _BASE])
    return np.asarray(middle + step * float(np.min(half / np.maximum(np.abs(step), 1e-9))))


def _in_base(pose: NDArray[np.float64], place: NDArray[np.float64], reach: float) -> bool:
    """Whether an object that reaches so far would lie in the base of a robot with this pose (3,)."""
    c, s = math.cos(pose[2]), math.sin(pose[2])
    x, y = np.array([[c, s], [-s, c]]) @ (place - pose[:2])
    return all(low - reach < value < high + reach for value, (low, high) in zip((x, y), _BASE, strict=True))


def _pose(backend: PhysicsBackend, robot: str) -> NDArray[np.float64]:
    """A robot's base: x, y (m) and heading (rad)."""
    return np.array([float(backend.data.joint(f"{robot}/base_{part}").qpos[0]) for part in ("x", "y", "yaw")])


def _nouns(layout: Layout) -> list[str]:
    """Fixtures to which commands can send robots."""
    return [name for name, fixture in layout.fixtures.items() if fixture.station and name == fixture.noun]


def _station(layout: Layout, noun: str) -> Station:
    return layout.stations[str(layout.fixtures[noun].station)]


_SPEC = TaskSpec(
    "Littered", ("", "", ""), Inside("{food}", "cabinet"), (Role("food", ("vegetable",)),), (),
    distractors=(_MOST, _MOST), styles=styles.names(), layouts=layouts.names(),
)


@takes("littered.trials", "script.first_seed", "script.processes")
def main(*, trials: int, first_seed: int, processes: int) -> None:
    """Print how robots get away from objects on the floor, and how deep those are pressed into what."""
    jobs = [(seed, robots) for robots in (1, 2) for seed in range(first_seed, first_seed + trials)]
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        found = list(pool.map(play, *zip(*jobs, strict=True)))
    show(_table(found))
    for trial in found:
        lost = [f"{robot} {text}: {o.reason}: {o.detail}" for robot, text, o in trial.drives if not o.success]
        for line in lost:
            say(f"seed {trial.seed}, {trial.way} of {trial.objects}, {trial.robots} robots: {line}")
        for where, what in trial.deepest.items():
            if trial.depth[where] > _DEEP:
                deep = f"{1000 * trial.depth[where]:.1f} mm in {where}: {what}"
                say(f"seed {trial.seed}, {trial.way} of {trial.objects}, {trial.robots} robots: {deep}")
        if trial.stuck:
            say(f"seed {trial.seed}: never got away: {', '.join(trial.stuck)}")


def _table(found: list[Trial]) -> Table:
    table = Table("objects lie", "robots", "starts", "robots walled in", "drives", "arrive", "mean s",
                  *(f"mm in {where}" for where in _WHERE), title="Objects on the floor")
    for robots in (1, 2):
        for way in WAYS:
            part = [t for t in found if t.way == way and t.robots == robots]
            if part:
                table.add_row(way, str(robots), *_row(part))
    table.add_row("all", "", *_row(found))
    return table


def _row(part: list[Trial]) -> Iterator[str]:
    drives = [o for t in part for _, _, o in t.drives]
    yield str(len(part))
    yield str(sum(len(t.stuck) for t in part))
    yield str(len(drives))
    yield f"{sum(o.success for o in drives)}"
    yield f"{np.mean([o.seconds for o in drives]):.1f}"
    for where in _WHERE:
        yield f"{1000 * max(t.depth[where] for t in part):.1f}"


if __name__ == "__main__":
    run_script(main)
