"""Quirks of switches: they spring back where they may not be on; what a button started stops."""

from __future__ import annotations

from collections.abc import Iterable

from remac_env.backends.physics.quirks.mechanisms import TURN, Surroundings, Switch
from remac_env.backends.physics.truth import Truth
from remac_env.kitchen.fixtures.base import Fixture
from remac_env.rules.facts import Quirk


class _Sender:
    """What sends switches back: its own, and others."""

    def __init__(self, around: Surroundings, fixture: str) -> None:
        self.around, self.fixture, self.struck = around, fixture, set[str]()
        self.switches = self._of(fixture)
        self.others: list[Switch] = []

    def _of(self, fixture: str) -> list[Switch]:
        return [Switch(self.around, actuator) for actuator in self.around.layout.fixtures[fixture].actuators]

    @property
    def at_work(self) -> bool:
        return any(switch.returning for switch in (*self.switches, *self.others))

    def send_back(self, switches: Iterable[Switch], when: bool) -> None:
        """Look at switches, and send those back that are on, when they may not be."""
        for switch in switches:
            switch.came_on()
            if when and switch.on:
                switch.send_back()

    def push(self) -> None:
        for switch in (*self.switches, *self.others):
            switch.push()


class _OfSwitches(_Sender):
    """A quirk that has to do with switches: those of a fixture, or one of them."""

    def __init__(self, around: Surroundings, quirk: Quirk, truth: Truth) -> None:
        fixture = quirk.about if quirk.about in around.scene.fixtures else around.scene.slots[quirk.about].fixture
        super().__init__(around, fixture)
        self.quirk = quirk
        self.switches = [switch for switch in self.switches if quirk.about in (fixture, switch.name)]


class Refuses(_OfSwitches):
    """A switch springs back where it may not come on."""

    def allowed(self) -> bool:
        return False

    def watch(self) -> None:
        for switch in self.switches:
            if switch.came_on() and not self.allowed():
                switch.send_back()
                self.struck.add(self.fixture)


class Enabled(Refuses):
    """Comes on only while another switch is on."""

    def allowed(self) -> bool:
        return self.around.on(self.quirk.other)


class Guarded(Refuses):
    """Comes on only while another door is shut."""

    def allowed(self) -> bool:
        return self.around.shut(self.quirk.other)


class Attended(Refuses):
    """Comes on only while somebody stands at another station, or has not left it for long."""

    def __init__(self, around: Surroundings, quirk: Quirk, truth: Truth) -> None:
        super().__init__(around, quirk, truth)
        self._left = TURN

    def watch(self) -> None:
        self._left = 0 if self.around.attended(self.quirk.other) else self._left + 1
        super().watch()

    @property
    def pending(self) -> bool:
        """Whether it may still come on though nobody stands there any more."""
        return 0 < self._left < TURN

    def allowed(self) -> bool:
        return self._left < TURN


class Fuse(_OfSwitches):
    """When one comes on the other springs back."""

    def __init__(self, around: Surroundings, quirk: Quirk, truth: Truth) -> None:
        super().__init__(around, quirk, truth)
        self.others = self._of(quirk.other)

    def watch(self) -> None:
        came = [switch.came_on() for switch in self.switches]
        self.send_back(self.others, any(came))


class Springs(_OfSwitches):
    """It springs back when nobody stands there."""

    def watch(self) -> None:
        left = any(switch.on for switch in self.switches) and not self.around.attended(self.fixture)
        self.send_back(self.switches, left)


class Interlock(_Sender):
    """No quirk: what runs only shut goes off when its door opens. A spring brings its knobs back."""

    @classmethod
    def wanted(cls, fixture: Fixture) -> bool:
        """Whether it has knobs that need one: what a button started stops without."""
        return fixture.shut_to_run and not all(actuator.springs_back for actuator in fixture.actuators)

    def watch(self) -> None:
        self.send_back(self.switches, not self.around.shut(self.fixture))
