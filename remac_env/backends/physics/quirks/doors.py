"""Quirks of doors: closers, springs that open them, and a safety catch."""

from __future__ import annotations

from remac_env.backends.physics.quirks.mechanisms import LET_GO, TURN, JointDrive, Surroundings
from remac_env.backends.physics.truth import Truth
from remac_env.rules.facts import Quirk

AJAR = 0.28
"""rad (drawers: told alike) that a door stands open which jams, or comes open by itself."""

_STRAINED = 0.25  # rad at which a catch has been pulled at: it gives by a little, and a hand may stop before it does
_SWUNG = 0.25  # rad at which a door that comes open is left to itself
_SWING = 0.8  # rad/s with which doors fall shut and come open


class _OfDoor:
    """What has to do with a door: a drive at each of its panels."""

    def __init__(self, around: Surroundings, quirk: Quirk, truth: Truth) -> None:
        self.around, self.fixture, self.struck = around, quirk.about, set[str]()
        self.door_panels = around.layout.fixtures[quirk.about].door_panels
        self.drives = [JointDrive(around.simulation, panel.joint) for panel in self.door_panels]
        self.at_work = False

    def rest(self) -> None:
        for drive in self.drives:
            drive.rest()
        self.at_work = False

    def go(self, angle: float) -> None:
        for panel, drive in zip(self.door_panels, self.drives, strict=True):
            drive.toward(panel.position(angle), speed=abs(panel.position(_SWING)))


class Falls(_OfDoor):
    """A closer shuts it when nobody has stood there for a while: robots can take turns."""

    def __init__(self, around: Surroundings, quirk: Quirk, truth: Truth) -> None:
        super().__init__(around, quirk, truth)
        self._alone = 0

    @property
    def pending(self) -> bool:
        """Whether it will fall unless somebody comes."""
        return 0 < self._alone <= TURN

    def watch(self) -> None:
        left = not self.around.shut(self.fixture) and not self.around.attended(self.fixture)
        self._alone = self._alone + 1 if left else 0
        falls = self._alone > TURN
        if self.at_work and not falls:
            self.rest()
        self.at_work = falls

    def push(self) -> None:
        if self.at_work:
            self.go(0.0)


class Swings(_OfDoor):
    """A spring opens it when nobody stands there."""

    def watch(self) -> None:
        left = not self.around.attended(self.fixture)
        opened = min(self.around.reading(self.fixture).door_angles)
        if self.at_work and (not left or opened >= _SWUNG):
            self.rest()
        elif left and self.around.shut(self.fixture):
            self.at_work = True

    def push(self) -> None:
        if self.at_work:
            self.go(AJAR)


class Jams(_OfDoor):
    """A safety catch holds it ajar until it has been pulled at and let go; when it is shut the catch falls in again."""

    def __init__(self, around: Surroundings, quirk: Quirk, truth: Truth) -> None:
        super().__init__(around, quirk, truth)
        self._caught, self._strained, self._free = around.shut(quirk.about), False, 0

    def watch(self) -> None:
        opened = max(self.around.reading(self.fixture).door_angles)
        if self.around.shut(self.fixture):
            self._caught, self._strained, self._free = True, False, 0
        self.at_work = self._caught and opened > 0.5 * AJAR
        if not self._caught:
            return
        held = any(self.around.touched(panel.joint) for panel in self.door_panels)
        if held and opened >= _STRAINED:
            self._strained = True
            self.struck.add(self.fixture)
        self._free = 0 if held else self._free + 1
        if self._strained and self._free >= LET_GO:
            self._caught = False
            self.rest()

    def push(self) -> None:
        if self.at_work:
            for panel, drive in zip(self.door_panels, self.drives, strict=True):
                drive.stop_at(panel.position(AJAR))
