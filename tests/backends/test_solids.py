"""What is solid stays out of what is solid: walls of dishes, door panels, what a hand carries past furniture."""

from __future__ import annotations

from itertools import product

import mujoco
import numpy as np
import pytest
import solids
from physics_kit import kitchen, run

from remac_env.backends.physics.controllers.scripted.collision import CollisionChecker
from remac_env.backends.physics.controllers.scripted.robot import Robot, View
from remac_env.backends.physics.sensing import Senses
from remac_env.backends.physics.simulation import Simulation
from remac_env.kitchen import layout as layouts
from remac_env.kitchen.builder import build_model
from remac_env.kitchen.canvas import COLLIDER_GROUP
from remac_env.kitchen.fixtures import models
from remac_env.kitchen.fixtures.base import COUNTER_Z
from remac_env.kitchen.fixtures.door import OPENED, Door
from remac_env.kitchen.objects import catalogue, colliders
from remac_env.robots import bodies
from remac_env.robots.panda import measures as panda
from remac_env.state import FrozenMap

LAYOUT = layouts.load("one_wall_large")
AT_REST = 0.008
"""m: how deep a contact may be that carries a dish."""


def deepest(depths: solids.Depths) -> float:
    return max(depths.values(), default=0.0)


@pytest.mark.parametrize(
    ("dish", "onto"), [*product(("bowl", "pan", "plate", "mug"), ("worktop",)), ("bowl", "spout"), ("pan", "spout")]
)
def test_dishes_that_fall_onto_an_edge_lie_on_it(dish: str, onto: str) -> None:
    _, rest = solids.fall(LAYOUT, dish, onto=onto)
    assert deepest(rest) < AT_REST, rest


def test_walls_that_pass_through_furniture_are_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(colliders._WHOLE, "conaffinity", 2)
    impact, _ = solids.fall(LAYOUT, "bowl", onto="worktop")
    assert max(depth for (_, into), depth in impact.items() if into.startswith("counter")) > 0.02


@pytest.mark.parametrize("variant", models.names("cabinet"))
def test_doors_open_all_the_way_and_clear_of_their_neighbours(variant: str) -> None:
    for name in ("one_wall_large", "u_shaped_small"):
        depths, angle = solids.swing(layouts.load(name, FrozenMap({"cabinet": variant})))
        assert angle > OPENED and deepest(depths) < AT_REST, (name, depths)


def test_a_door_that_turns_about_its_back_edge_jams_between_its_neighbours(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Door, "face", property(lambda self: -self.thickness))
    monkeypatch.setattr(Door, "_aside", 0.0)
    _, angle = solids.swing(layouts.load("one_wall_large"))
    assert angle < OPENED


def test_what_is_held_keeps_clear_on_its_way() -> None:
    model = build_model(LAYOUT, robots=("robot_0",), objects={"bowl": "bowl"})
    simulation = Simulation(model, ("robot_0",))
    handle = simulation.robots["robot_0"]
    stand = panda.tucked(0.1, -0.85, 0.5 * np.pi)
    handle.put(stand)
    robot = Robot(handle, bodies.get().kinematics())
    objects = {"bowl": catalogue.get("bowl")}
    checker = CollisionChecker(View(Senses(simulation, handle, LAYOUT, objects), robot), robot)
    spot = next(slot for slot in LAYOUT.slots.values() if slot.kind == "surface").center
    for height, clear in ((0.004, False), (0.02, True)):
        simulation.place("bowl", np.array([spot[0], spot[1], COUNTER_Z + height]), np.array([1.0, 0.0, 0.0, 0.0]))
        mujoco.mj_forward(model, simulation.data)
        checker.begin(held="bowl")
        assert checker.free(stand)
        with checker.clearance(0.010, gripper=False):
            assert bool(checker.free(stand)) == clear
        assert checker.free(stand), "the margin holds within the context only"


def test_in_play_nothing_reaches_deep_into_anything() -> None:
    backend, _, worlds = kitchen({"bowl": "counter"}, 120400, style="industrial")
    backend.probe = probe = solids.Probe(backend)
    chain = (
        "navigate to bowl", "pick up bowl", "navigate to sink", "place to sink", "pick up bowl", "navigate to counter",
        "place to counter", "navigate to cabinet", "open cabinet door",
    )  # fmt: skip
    assert run(backend, worlds, chain) == [None] * len(chain)
    assert deepest(probe.depths) < AT_REST, probe.depths


def test_robots_are_not_measured_and_every_collider_of_the_kitchen_is() -> None:
    model = build_model(LAYOUT, robots=("robot_0",), objects={"bowl": "bowl"})
    measured = solids.Solids(model).model
    robot = np.array([model.body(body).name.startswith("robot_0/") for body in model.geom_bodyid])
    meets = (measured.geom_contype | measured.geom_conaffinity).astype(bool)
    assert (meets == (~robot & (model.geom_group == COLLIDER_GROUP))).all()
