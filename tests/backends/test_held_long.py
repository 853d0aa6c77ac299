"""What a hand has held for two minutes is still in it: standing, tall things turn in the pads and hardly slide."""

from __future__ import annotations

import numpy as np
import pytest
from physics_kit import ROBOT, kitchen, run

from remac_env.backends.physics.simulation import CONTROL_PERIOD

CREEPING = ("bottle", "water", "oil", "ketchup", "cereal", "pasta", "pan")
"""What creeps most, of everything that hands hold."""

WAIT, MOST = 120.0, 0.008  # s; m by which the grip moves on what is held meanwhile
THERE_AND_BACK = ["navigate to sink", "navigate to counter"]


@pytest.mark.long
@pytest.mark.parametrize("name", CREEPING)
def test_it_is_held_for_two_minutes_and_put_down(name: str) -> None:
    backend, _, worlds = kitchen({name: "counter"}, 202500)
    assert run(backend, worlds, [f"navigate to {name}", f"pick up {name}"]) == [None, None]
    timeline = backend._begun()
    body, hand = backend.data.body(name), timeline.simulation.robots[ROBOT]

    def gripped() -> np.ndarray:
        """Where the grip is on the object, (3,) m in its frame."""
        return body.xmat.reshape(3, 3).T @ (hand.grip_pose.position - body.xpos)

    before = gripped()
    for _ in range(round(WAIT / CONTROL_PERIOD)):
        timeline.tick()
    assert np.linalg.norm(gripped() - before) < MOST
    assert run(backend, worlds, [*THERE_AND_BACK, "place to counter"]) == [None] * 3
    assert backend.world.objects[name].place.relation == "slot"


@pytest.mark.long
@pytest.mark.parametrize(("name", "seconds"), [("pan", 120.0), ("bottle", 40.0), ("water", 40.0)])
def test_it_is_carried_and_put_down(name: str, seconds: float) -> None:
    """Each drive draws a bottle's neck 2 mm through the fingers: after 80 s of driving it falls."""
    backend, _, worlds = kitchen({name: "counter"}, 202500)
    assert run(backend, worlds, [f"navigate to {name}", f"pick up {name}"]) == [None, None]
    began = backend.clock
    while backend.clock < began + seconds:
        assert run(backend, worlds, THERE_AND_BACK) == [None, None]
    assert run(backend, worlds, ["place to counter"]) == [None]
    assert backend.world.objects[name].place.relation == "slot"
