"""The maker's limits hold, gravity compensation included, and doors are handled with little force."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from forces import Measured, Probe, together
from physics_kit import ROBOT, kitchen, run

from remac_env.backends.physics import timeline
from remac_env.backends.physics.controllers.scripted import arc, panel
from remac_env.robots import tracking
from remac_env.robots.panda import measures as panda

TORQUES = np.array([87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0])
"""N m, the manufacturer's; written down here once more, so that a limit that is raised in the model is seen."""

FINGER, DOOR = 70.0, 200.0
"""N: the manufacturer's continuous force of a finger, and what a part of the robot may do to a door."""

DOORS = (
    "navigate to microwave", "open microwave door", "close microwave door", "navigate to cabinet", "open cabinet door",
    "close cabinet door",
)
TAP = ("navigate to faucet", "turn on faucet")


@pytest.fixture
def fresh_models() -> Iterator[None]:
    """Models are compiled anew, before and after."""
    for cache in (timeline._model, tracking.bare_model):
        cache.cache_clear()
    yield
    for cache in (timeline._model, tracking.bare_model):
        cache.cache_clear()


def measured(texts: tuple[str, ...], *, style: str = "modern_1", seed: int = 120400) -> Measured:
    """What a chain of commands takes, all of which succeed."""
    backend, _, worlds = kitchen({"mug": "counter"}, seed, style=style)
    backend.probe = probe = Probe(backend, ROBOT)
    assert run(backend, worlds, texts) == [None] * len(texts)
    return probe.found


def within_torques(found: Measured) -> bool:
    return bool((found.torque <= TORQUES + 1e-6).all())


def strongest(found: Measured) -> float:
    """N, the largest force of any part of the robot on any door panel."""
    return max(found.doors.values())


@pytest.mark.parametrize("styles", [("modern_1",), pytest.param(("modern_1", "coastal"), marks=pytest.mark.long)])
def test_the_makers_limits_hold(styles: tuple[str, ...]) -> None:
    found = together([*(measured(DOORS, style=style) for style in styles), measured(TAP)])
    assert within_torques(found), found.torque
    assert (found.torque[4:] > 5.0).any(), "an episode that asks nothing of the wrist shows nothing"
    assert found.finger <= FINGER + 1e-6
    assert len({panel for _, panel in found.doors}) >= 1 + len(styles)
    assert 20.0 < strongest(found) <= DOOR, found.doors


def test_a_raised_limit_is_seen(monkeypatch: pytest.MonkeyPatch, fresh_models: None) -> None:
    monkeypatch.setattr(panda, "ARM_FORCE", (87.0, 87.0, 87.0, 87.0, 40.0, 40.0, 40.0))
    assert not within_torques(measured(TAP))


def test_gravity_counts(fresh_models: None) -> None:
    backend, _, worlds = kitchen({"mug": "counter"}, 120400)
    arm = [backend.model.joint(f"{ROBOT}/joint{number}") for number in range(1, 8)]
    probe = Probe(backend, ROBOT)
    backend.probe = probe
    run(backend, worlds, ("navigate to mug",))
    dofs = np.array([joint.dofadr[0] for joint in arm])
    weight = np.abs(backend.data.qfrc_gravcomp[dofs])
    assert weight.max() > 10.0, "the arm has a weight"
    assert (found := probe.found.torque).max() > 0.9 * weight.max(), found
    # Compensation that MuJoCo counts as passive stands outside the limit; the probe adds it all the same.
    backend.model.jnt_actgravcomp[[joint.id for joint in arm]] = 0
    passive = Probe(backend, ROBOT)
    backend.probe = passive
    run(backend, worlds, ("navigate aside",))
    assert passive.found.torque.max() > 0.9 * weight.max()


def test_a_hand_that_presses_on_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(arc, "_YIELD", 0.0)
    monkeypatch.setattr(arc, "_SQUEEZE", 140.0)
    monkeypatch.setattr(panel.DoorPanel, "clear_of_palm", lambda self, pitch, palm: 0.0)
    assert strongest(measured(DOORS[:2])) > DOOR


def test_pads_grip_no_better_than_rubber() -> None:
    backend, _, _ = kitchen({"mug": "counter"}, 120400)
    for part in panda.FINGERS:
        body = backend.model.body(f"{ROBOT}/{part}")
        pads = range(int(body.geomadr[0]), int(body.geomadr[0] + body.geomnum[0]))
        assert max(backend.model.geom_friction[pad, 0] for pad in pads) <= 1.1
        assert max(backend.model.geom_friction[pad, 1] for pad in pads) <= 0.012
