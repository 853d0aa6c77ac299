"""Keeps what a checker's cameras show in kitchens, with the truth of every question about it.

Most kitchens are posed, each moment anew, with everything anywhere: every state of what stands before a robot is as
frequent as the others. In the others robots work, in physics or by the skill table: they follow the cheapest plan half
of the time and else do what is possible or at least allowed; with noise in what controllers see, grasps and pulls slip.
After a round a door within reach may be put ajar, as pulls that slip leave it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from remac_agents.checkers.knowledge import ruled
from remac_agents.vision.network import CAMERAS, SIZE
from remac_agents.vision.pictures import fitted
from remac_agents.vision.questions import Question, question_of
from remac_bench.learning.cells import Cells
from remac_bench.learning.checker_files import Row, Seen
from remac_bench.learning.checker_paint import PaintedWorlds, painted
from remac_bench.learning.checker_poses import shuffled
from remac_bench.learning.checker_scenes import Look, labels, seen_in
from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.backends.symbolic import SymbolicBackend
from remac_env.errors import PhysicsError, SamplingError
from remac_env.frozen import FrozenMap
from remac_env.kitchen.fixtures.door import OPEN_TO
from remac_env.kitchen.floor_plan import Layout
from remac_env.kitchen.worlds import TaskWorlds
from remac_env.oracle.certificate import solve
from remac_env.rendering.stage import Stage
from remac_env.rules.claims import feasible, first_false
from remac_env.rules.places import stations_of
from remac_env.rules.skills import SKILLS
from remac_env.rules.subtasks import WAIT, Subtask
from remac_env.seeding import generator
from remac_env.start import Offset, Start
from remac_env.state import CLOSED_MAX, OPEN_MIN, WorldState
from remac_env.tasks import BUILT_IN
from remac_env.tasks import get as get_task
from remac_env.tasks.goals import Goal

ROUNDS = {"physics": 30, "symbolic": 16}
"""Of an episode, by backend. With the skill table alone pictures are posed: there, other kitchens are as quick."""

MOMENTS = 40
"""Of a kitchen that is posed anew at each: about half of the time goes into building it."""

BACKENDS = tuple(ROUNDS)

_DRAWS = {"physics": "physics", "symbolic": "dream"}  # backend -> what the draws of an episode are named by
_TEAM = 0.55  # of the episodes have two robots
_MIXED = 0.7  # begin with doors, switches and vessels in any state
_POSED = 0.7  # of the kitchens without physics are posed anew at each moment
_PAINTED = 0.75  # of the kitchens without physics that are learnt from have a style that there is not
_WANTED = 3  # commands with what stands before a robot, of which a method would ask, at each moment that is posed
_NOISY, _NOISE = 0.4, 0.012  # of the episodes in physics have this noise in what controllers see, m
_PLANNED = 0.5  # of the rounds have one robot follow the cheapest plan
_AT_HAND = 0.65  # of the others are work where the robot stands, if there is any
_IMPOSSIBLE = 0.08  # may be anything that is not refused
_AJAR = 0.35  # of the moments are seen again with a door ajar
_FINE = 2  # times as large as they are kept pictures are drawn: half of them are averaged then, half thinned out
_STATES = 300  # that a search for a plan looks at
_LITTER = 2  # objects on the floor from which on an episode is not worth going on
_SPREAD = 0.05  # m about the middle of their places where posed objects stand
_TURNED = 0.12  # rad about their angle that posed doors stand open


def record(
    seeds: Iterable[int], cells: Cells, *, backend: str = "physics", paints: bool = False
) -> Iterator[Seen]:
    """What is seen in the episodes of these seeds, in styles and layouts of the cells.

    paints: whether kitchens without physics may be painted as no style has them.
    """
    for seed in seeds:
        try:
            yield from _Episode.of(seed, cells, backend, paints=paints).views()
        except (SamplingError, PhysicsError):
            continue  # this layout lacks what the task needs, or physics came to no end


@dataclass(eq=False)
class _Episode:
    worlds: TaskWorlds
    start: Start
    goal: Goal
    backend: PhysicsBackend | SymbolicBackend
    stage: Stage
    layout: Layout
    chance: np.random.Generator
    posed: bool
    last: dict[str, tuple[Subtask, str | None]]

    @staticmethod
    def of(seed: int, cells: Cells, backend: str, *, paints: bool) -> _Episode:
        chance = generator(seed, "pictures", _DRAWS[backend])
        style, layout = cells.of(seed, "pictures")
        worlds, paint = TaskWorlds(get_task(BUILT_IN[seed % len(BUILT_IN)])), None
        if paints and backend == "symbolic" and chance.random() < _PAINTED:
            paint = painted(cells.styles, chance)
            worlds = PaintedWorlds(worlds.spec, paint)
        robots = ("robot_0", "robot_1")[: 1 + int(chance.random() < _TEAM)]
        start, names = worlds.start(
            seed, style=style, layout=layout, starts="mixed" if chance.random() < _MIXED else "paper", robots=robots,
            perception_noise=_NOISE if chance.random() < _NOISY else 0.0,
        )  # fmt: skip
        posed = backend == "symbolic" and bool(chance.random() < _POSED)
        runs = PhysicsBackend(worlds) if backend == "physics" else SymbolicBackend()
        runs.reset(start)
        room = worlds.layout_of(start)
        stage = Stage(start, room, worlds.categories, style=paint)
        return _Episode(worlds, start, worlds.spec.goal.bind(names), runs, stage, room, chance, posed, {})

    @property
    def world(self) -> WorldState:
        """The world now."""
        return self.backend.world

    def views(self) -> Iterator[Seen]:
        """What all robots see, moment by moment."""
        try:
            yield from self._posed() if self.posed else self._played()
        finally:
            self.stage.close()

    def _posed(self) -> Iterator[Seen]:
        first = self.start
        for _ in range(MOMENTS):
            self.start = shuffled(first, self.chance)
            wanted = {robot: self._of_use(robot, self.start.world) for robot in first.scene.robots}
            ajar = self._ajar(self.start.world) if self.chance.random() < _AJAR else {}
            yield from self._seen(wanted, self.start.world, ajar)

    def _played(self) -> Iterator[Seen]:
        rounds = ROUNDS["physics" if isinstance(self.backend, PhysicsBackend) else "symbolic"]
        for number in range(rounds):
            subtasks = self._subtasks()
            wanted = {robot: [subtask] for robot, subtask in subtasks.items()}
            yield from self._seen(wanted, self.world, {})
            if self.chance.random() < _AJAR and (ajar := self._ajar(self.world)):
                yield from self._seen(wanted, self.world, ajar)
            if number == rounds - 1 or _lying(self.world) > _LITTER:
                return
            self.last = {name: (subtask, self.world.robots[name].holding) for name, subtask in subtasks.items()}
            self.backend.run_round(subtasks)

    def _seen(
        self, wanted: dict[str, list[Subtask]], world: WorldState, ajar: dict[str, float]
    ) -> Iterator[Seen]:
        """What the robots see of a world, with these doors at these angles, rad. `wanted`: commands that may come."""
        for name in ajar:
            world = world.with_fixture(name, door="ajar")
        self._show(world, ajar)
        averaged = bool(self.chance.integers(2))
        for robot, subtasks in wanted.items():
            drawn = self.stage.observe(robot, world, size=_FINE * SIZE, cameras=CAMERAS)
            pictures = {name: fitted(p) if averaged else p[::_FINE, ::_FINE].copy() for name, p in drawn.items()}
            pixels: dict[str, int] = {}
            for camera in CAMERAS:
                for body, count in self.stage.shown(robot, world, camera, size=SIZE).items():
                    pixels[body] = max(count, pixels.get(body, 0))
            look = Look(self.start.scene, world, robot, seen_in(pixels, self.start.scene))
            rows = _rows(look, self._asked(robot, subtasks, world))
            yield Seen(
                pictures["station"], pictures["wrist"], world.robots[robot].holding or "",
                self.start.seed, self.start.layout, self.start.style, self.worlds.spec.name, rows,
            )  # fmt: skip

    def _asked(self, robot: str, subtasks: Sequence[Subtask], world: WorldState) -> set[Question]:
        """What a method asks of pictures before one of these commands, and would if it failed.

        What rules of knowledge want to know is asked, too.
        """
        holding = {name: state.holding for name, state in world.robots.items()}
        every = [requirement.condition for subtask in subtasks for requirement in subtask.requirements(robot)]
        tried = [(subtask, holding[robot]) for subtask in subtasks]
        for done, held in (*tried, *((self.last[robot],) if robot in self.last else ())):
            every += done.achieves(robot, held)
        for known in [condition for condition in every if condition.kind == "known"]:
            ruled(known, self.start.scene, holding, every.append)  # type: ignore[arg-type]
        return {question for condition in every if (question := question_of(condition)) is not None}

    def _show(self, world: WorldState, ajar: dict[str, float]) -> None:
        if isinstance(self.backend, PhysicsBackend):
            positions = self.backend.positions()
            for name, angle in ajar.items():
                for panel in self.layout.fixtures[name].door_panels:
                    positions[self.backend.model.joint(panel.joint).qposadr[0]] = panel.position(angle)
            self.stage.show_positions(positions, world)
            return
        spread = {
            name: Offset(dx=float(dx), dy=float(dy), yaw=float(self.chance.uniform(0.0, np.pi)))
            for name, item in world.objects.items() if item.place.relation == "slot"
            for dx, dy in [self.chance.uniform(-_SPREAD, _SPREAD, 2)]
        }  # fmt: skip
        doors = {
            name: max(OPEN_MIN, OPEN_TO + float(self.chance.uniform(-_TURNED, _TURNED)))
            for name, state in world.fixtures.items() if state.door == "open"
        }  # fmt: skip
        offsets, angles = {**self.start.offsets, **spread}, {**self.start.doors, **doors, **ajar}
        self.stage.show_world(replace(self.start, world=world, offsets=offsets, doors=angles), world)

    def _ajar(self, world: WorldState) -> dict[str, float]:
        """A door at a station where a robot stands and the angle at which it is ajar, rad, if there is one."""
        scene, here = self.start.scene, {state.station for state in world.robots.values()}
        doors = [name for name, facts in scene.fixtures.items() if facts.door and facts.station in here]
        if not doors:
            return {}
        return {str(self.chance.choice(doors)): float(self.chance.uniform(2 * CLOSED_MAX, 0.95 * OPEN_MIN))}

    def _of_use(self, robot: str, world: WorldState) -> list[Subtask]:
        """Some commands with what stands before a robot, of any skill alike, and a drive anywhere."""
        scene, here = self.start.scene, world.robots[robot].station
        found: dict[str, list[Subtask]] = {}
        for subtask in map(self.worlds.vocabulary.subtask, self.worlds.vocabulary.legal(scene).values()):
            if subtask.moves or (subtask.target and here in stations_of(scene, world, subtask.target)):
                found.setdefault("" if subtask.moves else subtask.skill, []).append(subtask)
        drives = found.pop("")
        chosen = [found[str(skill)] for skill in self.chance.choice(sorted(found), _WANTED)] if found else []
        return [some[int(self.chance.integers(len(some)))] for some in (*chosen, drives)]

    def _subtasks(self) -> dict[str, Subtask]:
        """What each robot does next: one of them may follow the cheapest plan that it has alone."""
        scene, world = self.start.scene, self.world
        robots = list(scene.robots)
        lead = robots[int(self.chance.integers(len(robots)))]
        planned = WAIT
        if self.chance.random() < _PLANNED and not self.goal.holds(scene, world):
            alone = WorldState(FrozenMap({lead: world.robots[lead]}), world.objects, world.fixtures)
            plan = solve(replace(scene, robots=(lead,)), alone, self.goal, max_states=_STATES)
            planned = plan.rounds[0][lead] if plan is not None and plan.rounds else WAIT
        return {robot: self._chosen(robot, planned if robot == lead else WAIT) for robot in robots}

    def _chosen(self, robot: str, planned: Subtask) -> Subtask:
        scene, world, chance = self.start.scene, self.world, self.chance
        if planned != WAIT:
            return planned
        legal = map(self.worlds.vocabulary.subtask, self.worlds.vocabulary.legal(scene).values())
        active = [subtask for subtask in legal if not SKILLS[subtask.skill].still]
        if chance.random() < _IMPOSSIBLE:
            some = [s for s in active if first_false(scene, world, robot, s, "refuse") is None and not s.moves]
            if some:
                return some[int(chance.integers(len(some)))]
        good = [subtask for subtask in active if feasible(scene, world, robot, subtask)]
        work = [subtask for subtask in good if not subtask.moves]
        if work and chance.random() < _AT_HAND:
            skills = sorted({subtask.skill for subtask in work})
            skill = skills[int(chance.integers(len(skills)))]
            work = [subtask for subtask in work if subtask.skill == skill]
            return work[int(chance.integers(len(work)))]
        return good[int(chance.integers(len(good)))] if good else WAIT


def _rows(look: Look, asked: set[Question]) -> tuple[Row, ...]:
    found = []
    for label in labels(look):
        question = question_of(label.condition)
        if question is not None:
            found.append(Row(question.predicate, question.names, label.truth, label.shown, question in asked))
    return tuple(found)


def _lying(world: WorldState) -> int:
    return sum(item.place.relation == "floor" for item in world.objects.values())
