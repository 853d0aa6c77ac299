"""One variant of a fixture alone at a plain wall, and what robots do there; see certify_modules.py."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any, Literal

import numpy as np
from module_record import Recorder, Touch, geoms

from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.kitchen import layout as layouts
from remac_env.kitchen.builder import build_model
from remac_env.kitchen.fixtures import Fixture, certificates, models
from remac_env.kitchen.fixtures.base import ONE_VARIANT
from remac_env.kitchen.floor_plan import Layout
from remac_env.kitchen.layout_checks import STANCE_HALF
from remac_env.kitchen.objects import catalogue
from remac_env.kitchen.objects.catalogue import Category
from remac_env.kitchen.worlds import TaskWorlds
from remac_env.robots import bodies
from remac_env.robots.bodies import STANDARD
from remac_env.rules.facts import Rules
from remac_env.rules.subtasks import Subtask
from remac_env.seeding import digest
from remac_env.start import Start
from remac_env.state import Place, WorldState, door_state
from remac_env.tasks.goals import Released
from remac_env.tasks.spec import Role, TaskSpec
from remac_env.vocabulary import Noun

TRIALS = Path(__file__).with_name("module_trials.toml")
ROBOTS = ("robot_0", "robot_1")
STATION, REST = "module", "rest"
Side = Literal["left", "right"]
SIDES: tuple[Side, ...] = ("left", "right")
_Y = -0.85  # m, of both stations
_BESIDE, _FAR, _REST = STANCE_HALF, 4.0, 1.9  # m from the station: the wall beside it, the other one, the objects'

_FRAME = """
version = 1
[room]
x = [{low}, {high}]
front = -3.60
height = 2.50
[walls.back]
side = "back"
[stations]
module = {{ at = [0.0, {y}] }}
rest = {{ at = [{rest}, {y}] }}
[asides]
near = {{ at = [{near}, -2.60], yaw = 1.5707963267948966 }}
far = {{ at = [{far}, -2.60], yaw = 1.5707963267948966 }}
[fixtures.counter]
kind = "counter"
segments = [{segments}]
slots = [{slots}]
"""


@dataclass(frozen=True)
class Trial:
    """One run: the variant, where a wall is near, the slot of a worktop, what is done, by whom, from which seed.

    body: what kind of robot it is.
    """

    kind: str
    variant: str
    beside: Side
    slot: tuple[float, float] | None
    objects: Mapping[str, str]
    door: float
    steps: tuple[str, ...]
    robot: str
    seed: int
    body: str


@dataclass(frozen=True)
class Found:
    """What one step came to: its skill, what went wrong if anything, its touches, and where a wall was near.

    skill: empty for a failure on the way there, which is none of the variant's.
    floor: low and high corner (x, y), m, of what the base took, from the variant's middle and the line of fronts.
    """

    skill: str
    problem: str
    touches: tuple[Touch, ...]
    beside: Side
    floor: tuple[tuple[float, float], tuple[float, float]]


class _Never(Released):
    """A goal that no start fulfils."""

    def holds(self, scene: Rules, world: WorldState) -> bool:
        """Never."""
        return False


class OwnCategories(TaskWorlds):
    """Kitchens in which each noun is its own category: the fish is no salmon."""

    @property
    def categories(self) -> Mapping[str, Category]:
        """The categories of the task's objects."""
        return {role.nouns[0]: catalogue.get(role.nouns[0]) for role in self.spec.roles}


class _Module(OwnCategories):
    """The kitchen of one variant."""

    def __init__(self, spec: TaskSpec, layout: Layout) -> None:
        super().__init__(spec)
        self._only = layout

    def layout(self, name: str, style: str) -> Layout:
        """The one layout."""
        return self._only


def variants() -> list[tuple[str, str]]:
    """Every (kind, variant) that is to be proven."""
    return [(kind, variant) for kind in tables() for variant in (models.names(kind) or (ONE_VARIANT,))]


@cache
def module_layout(kind: str, variant: str, beside: Side, slot: tuple[float, float] | None = None) -> Layout:
    """A kitchen with one fixture of this variant, which is not asked for its certificate.

    beside: the side on which a wall of the room is as near to the station as any layout may have it. slot: of worktops
    its one slot there, (x, y) from the station and the fronts, m.
    """
    table, sign = tables()[kind], 1.0 if beside == "left" else -1.0
    low, high = sorted((-sign * _BESIDE, sign * _FAR))
    gap = table.get("gap")
    segments = [(low, gap[0]), (gap[1], high)] if gap else [(low, high)]
    slots = [(sign * _REST + x, 0.24, REST) for x in (-0.26, 0.0, 0.26)]
    if slot is not None:
        slots.insert(0, (*slot, STATION))
    text = _FRAME.format(
        low=low,
        high=high,
        y=_Y,
        rest=sign * _REST,
        near=sign * 0.6,
        far=sign * 2.4,
        segments=", ".join(
            f'{{ name = "{name}", x = [{start}, {end}], fronts = ["doors"] }}'
            for name, (start, end) in zip("ab", segments, strict=False)
        ),
        slots=", ".join(f'{{ at = [{x}, {y}], half = [0.13, 0.14], station = "{at}" }}' for x, y, at in slots),
    )
    text += table["layout"].format(variant=variant)
    return layouts.parse(text, name=f"module_{kind}", file=f"module of {kind} {variant}", certified=False)


def colliders_hash(kind: str, variant: str) -> str:
    """A fingerprint of what robots touch on a variant: bodies, colliders and joints, to 1e-6."""
    model = build_model(any_layout(kind, variant), robots=(), objects={})
    values: list[object] = []
    for body in (model.body(index) for index in range(model.nbody)):
        if not body.name.startswith(f"{kind}/"):
            continue
        values.append([body.name, *rounded(body.pos, body.quat, body.mass, body.inertia)])
        for geom in geoms(model, body.name):
            shape = (model.geom_size[geom], model.geom_pos[geom], model.geom_quat[geom], model.geom_friction[geom])
            values.append([int(model.geom_type[geom]), *rounded(*shape)])
        for joint in range(int(body.jntadr[0]), int(body.jntadr[0]) + int(body.jntnum[0])):
            dof = int(model.jnt_dofadr[joint])
            drag = (model.dof_damping[dof], model.dof_frictionloss[dof], model.dof_armature[dof])
            moves = (model.jnt_axis[joint], model.jnt_range[joint], model.jnt_stiffness[joint])
            values.append([int(model.jnt_type[joint]), *rounded(*moves, *drag)])
    return digest(values)


def trials(kind: str, variant: str, first_seed: int, rounds: int = 1, body: str = STANDARD) -> list[Trial]:
    """All runs that certify a variant, both robots in turn; as many rounds of them, each with other seeds."""
    if rounds > 1:
        firsts = [first_seed + 100 * number for number in range(rounds)]
        return [trial for first in firsts for trial in trials(kind, variant, first, body=body)]
    table, found = tables()[kind], []
    for slot in [tuple(place) for place in table.get("slots", ())] or [None]:
        for entry in table["trials"]:
            for noun in entry.get("each", ("",)):
                named = {name: at.format(object=noun) for name, at in entry.get("objects", {}).items()}
                objects = {name.format(object=noun): at for name, at in named.items()}
                steps = tuple(step.format(object=noun) for step in entry["steps"])
                for robot in ROBOTS:
                    # Each object with a wall on either side, and each robot equally often on each.
                    beside = SIDES[(len(found) + len(found) // 2) % 2]
                    door, seed = entry.get("door", 0.0), first_seed + len(found)
                    found.append(Trial(kind, variant, beside, slot, objects, door, steps, robot, seed, body))
    return found


def run(trial: Trial) -> list[Found]:
    """Run a trial until its end or its first failure."""
    layout = module_layout(trial.kind, trial.variant, trial.beside, trial.slot)
    fixture = layout.fixtures[trial.kind]
    roles = tuple(Role(noun, (noun,), at=at.partition(".")[0]) for noun, at in trial.objects.items())
    uses = tables()[trial.kind].get("uses")
    nouns = (Noun(trial.kind, "fixture", tuple(uses)),) if uses else ()
    spec = TaskSpec("Module", ("", "", ""), _Never("nothing"), roles, fixtures=(), distractors=(0, 0), nouns=nouns)
    worlds = _Module(spec, layout)
    start, _ = worlds.start(
        trial.seed, style="modern_1", layout=None, starts="paper", robots=(trial.robot,), perception_noise=0.0,
        body=trial.body,
    )  # fmt: skip
    backend, body = PhysicsBackend(worlds), bodies.get(trial.body)
    world, found = backend.reset(_arranged(start, trial)), []
    for text in trial.steps:
        subtask = worlds.vocabulary.subtask(worlds.vocabulary.encode(text))
        here, held = world.robots[trial.robot].station == STATION, world.robots[trial.robot].holding
        recorder = Recorder(backend, trial.robot, body, _targets(fixture, subtask, held))
        backend.watch = recorder
        result = backend.run_round({trial.robot: subtask})
        world, outcome = result.world, result.outcomes[trial.robot]
        counts = here and not subtask.skill.startswith("navigate")
        if counts or not outcome.success:
            problem = "" if outcome.success else f"{text}: {outcome.reason}: {outcome.detail}"
            found.append(_found(recorder, subtask, problem, fixture, trial, counts=counts))
        if not outcome.success:
            break
    return found


def origin(kind: str, variant: str) -> float:
    """x, m, from which a certificate is expressed in the variant's kitchens: its middle; of worktops the station."""
    return 0.0 if "slots" in tables()[kind] else certificates.anchor(any_layout(kind, variant).fixtures[kind])


def any_layout(kind: str, variant: str) -> Layout:
    """One of a variant's kitchens: what is said of the variant alone is the same in each."""
    slots = tables()[kind].get("slots")
    return module_layout(kind, variant, SIDES[0], tuple(slots[0]) if slots else None)


def _arranged(start: Start, trial: Trial) -> Start:
    """The start with the door and the objects where the trial has them."""
    world = start.world
    for noun, at in trial.objects.items():
        if "." in at:
            world = world.with_object(noun, place=Place("slot", at))
    doors = {name: trial.door or angle for name, angle in start.doors.items()}
    for name, angle in doors.items():
        world = world.with_fixture(name, door=door_state(angle))
    return replace(start, world=world, doors=doors)


def _targets(fixture: Fixture, subtask: Subtask, held: str | None) -> list[str]:
    """The bodies that fingers touch in a subtask."""
    if subtask.skill == "place to":
        return [held] if held else []
    if subtask.skill == "pick up":
        return [subtask.target]
    if subtask.skill in ("open door", "close door"):
        return [panel.joint for panel in fixture.door_panels]
    if subtask.skill not in ("turn on", "turn off"):
        return []
    return [actuator.joint for actuator in fixture.actuators]


def _found(
    recorder: Recorder, subtask: Subtask, problem: str, fixture: Fixture, trial: Trial, *, counts: bool
) -> Found:
    middle = origin(trial.kind, trial.variant)
    touches = tuple(recorder.touches(middle, last=subtask.skill == "place to"))
    (left, near), (right, far) = recorder.low - (middle, 0.0), recorder.high - (middle, 0.0)
    floor = (float(left), float(near)), (float(right), float(far))
    # Each switch and each burner is a proof of its own.
    part = next((f" {at}" for at in trial.objects.values() if at in fixture.switches), "")
    return Found(subtask.skill + part if counts else "", problem, touches, trial.beside, floor)


@cache
def tables() -> dict[str, Any]:
    """The file of trials: by kind."""
    return tomllib.loads(TRIALS.read_text(encoding="utf-8"))


def rounded(*values: Any) -> list[float]:
    """Numbers and arrays of them as one list, to 1e-6."""
    return [round(float(number), 6) + 0.0 for value in values for number in np.ravel(value)]
