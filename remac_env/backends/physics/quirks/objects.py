"""Quirks of objects: glue, and what is too hot to hold."""

from __future__ import annotations

import numpy as np

from remac_env.backends.physics.quirks.mechanisms import LET_GO, Surroundings
from remac_env.backends.physics.snapshot import holding, slot_under, vessel_around
from remac_env.backends.physics.truth import Truth
from remac_env.rules.facts import Quirk
from remac_env.rules.quirks import LOOSENED

_PULLED = 0.002  # m by which an object is lifted that is pulled at
_OFF = 0.15  # m at which glue is off in any case
_STIFF, _DAMPED = 0.5, 0.3  # of what one step of 5 ms takes, per mass


class Sticks:
    """Glue holds it down until it has been pulled at and let go; a hand that pulls at it gives up and opens.

    The glue is no stronger than what brings the object back to where it stood: what fingers squeezed out against a
    stronger one hopped away.
    """

    def __init__(self, around: Surroundings, quirk: Quirk, truth: Truth) -> None:
        self._around, self._name, self._truth, self.struck = around, quirk.about, truth, set[str]()
        model = around.simulation.model
        self._body, joint = model.body(quirk.about).id, model.joint(quirk.about)
        self._height, self._rise = int(joint.qposadr[0]) + 2, int(joint.dofadr[0]) + 2
        self._mass, self._step = float(model.body_mass[self._body]), float(model.opt.timestep)
        self._stands = self._now
        self._touched, self._free, self._pulled = False, 0, False
        self._loose = LOOSENED in truth.marks_of(quirk.about)

    @property
    def _now(self) -> float:
        return float(self._around.simulation.data.qpos[self._height])

    @property
    def at_work(self) -> bool:
        return (self._touched or self._pulled) and not self._loose

    def watch(self) -> None:
        if self._loose:
            return
        self._touched = self._around.touched(self._name)
        if self._touched:
            self._free = 0
            self._pulled = self._pulled or self._now - self._stands > _PULLED
            self._give_up()
        else:
            self._free += 1
            if not self._pulled:
                self._stands = self._now
        if self._pulled:
            self.struck.add(self._name)
        if (self._pulled and self._free >= LET_GO) or self._now - self._stands > _OFF:
            self._loose = True
        if not self.at_work:
            self._around.simulation.data.xfrc_applied[self._body, :3] = 0.0
        if self._loose:
            self._truth.mark(self._name, LOOSENED)

    def _give_up(self) -> None:
        simulation = self._around.simulation
        for name, robot in simulation.robots.items():
            if self._pulled and holding(simulation, robot, self._around.objects) == self._name:
                self._around.open_hand(name)

    def push(self) -> None:
        if not self.at_work:
            return
        data, step = self._around.simulation.data, self._step
        lifted = max(0.0, self._now - self._stands)
        force = self._mass * (_STIFF * lifted / step + _DAMPED * float(data.qvel[self._rise])) / step
        data.xfrc_applied[self._body, 2] = -max(force, 0.0) if lifted > 0.0 else 0.0
        # Glue is tough: what fingers squeeze out does not hop away.
        aside = -self._mass * _DAMPED / step * data.qvel[self._rise - 2 : self._rise]
        data.xfrc_applied[self._body, :2] = aside if self._pulled else 0.0


class Hot:
    """Hands have a thermostat: they open, and stay open for a while, when they close on what stands on a flame."""

    at_work = False

    def __init__(self, around: Surroundings, quirk: Quirk, truth: Truth) -> None:
        self._around, self._fixture, self.struck = around, quirk.about, set[str]()

    def watch(self) -> None:
        simulation = self._around.simulation
        lit = self._around.reading(self._fixture).on
        for name, robot in simulation.robots.items():
            if lit and (obj := holding(simulation, robot, self._around.objects)) and self._stands_on(obj) in lit:
                self._around.open_hand(name)
                self.struck.add(obj)

    def _stands_on(self, name: str) -> str | None:
        """The slot over which an object is, by itself or in its vessel."""
        simulation, objects = self._around.simulation, self._around.objects
        base = vessel_around(simulation, objects, name, simulation.pose(name).position) or name
        foot = simulation.pose(base).position - np.array([0.0, 0.0, objects[base].rest_height])
        return slot_under(self._around.layout, foot)

    def push(self) -> None:
        """It has no force of its own: the hand's motors open it."""
