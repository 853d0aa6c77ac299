"""What is observed of a task beside robots and cameras: objects and fixtures, by the same names in every kitchen."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
from robosuite.utils.observables import sensor

from remac_env.backends.physics.bodies import Bodies
from remac_env.integrations.robosuite.episode import Episode
from remac_env.kitchen.fixtures import Fixture
from remac_env.kitchen.layout import Layout
from remac_env.robots.rotation import Array

Sensor = Callable[[dict[str, Any]], Array]
Source = Callable[[], Bodies]


def task_sensors(
    episode: Episode, fixtures: Sequence[str], robots: int, bodies: Source, switched: Callable[[str], list[float]]
) -> Iterator[tuple[str, Sensor]]:
    """Names and sensors, of modality "object"; world frame, m and rad, quaternions (x, y, z, w).

    Of each role's object `<role>_pos` (3,), `<role>_quat` (4,) and, of each robot, `robot<i>_to_<role>_pos` (3,), from
    its hand. Of each fixture that the task needs `<fixture>_pos` (3,), the middle of where objects lie in it;
    `<fixture>_door` (2,) where it has a door, the angles of its least and its most open panel, and
    `<fixture>_handle_pos` (3,) of the least open one; `<fixture>_on` (n,) of its switches, 1 where on.
    """
    for role, obj in episode.roles.items():
        yield f"{role}_pos", _position(bodies, obj)
        yield f"{role}_quat", _turn(bodies, obj)
        for robot in range(robots):
            yield f"robot{robot}_to_{role}_pos", _between(f"robot{robot}_eef_pos", f"{role}_pos")
    for name in fixtures:
        fixture = episode.layout.fixtures[name]
        yield f"{name}_pos", _always(_middle(episode.layout, fixture))
        if fixture.door_panels:
            yield f"{name}_door", _door(bodies, fixture)
            yield f"{name}_handle_pos", _handle(bodies, fixture)
        if fixture.switches:
            yield f"{name}_on", _switches(name, switched)


def _position(bodies: Source, obj: str) -> Sensor:
    @sensor(modality="object")
    def read(cache: dict[str, Any]) -> Array:
        return bodies().pose(obj).position

    return read  # type: ignore[no-any-return]


def _turn(bodies: Source, obj: str) -> Sensor:
    @sensor(modality="object")
    def read(cache: dict[str, Any]) -> Array:
        found = bodies()
        return np.roll(found.data.xquat[found.model.body(obj).id], -1)

    return read  # type: ignore[no-any-return]


def _between(hand: str, obj: str) -> Sensor:
    @sensor(modality="object")
    def read(cache: dict[str, Any]) -> Array:
        # Before the first observation robosuite asks each sensor alone.
        return cache[obj] - cache[hand] if obj in cache and hand in cache else np.zeros(3)

    return read  # type: ignore[no-any-return]


def _always(value: Array) -> Sensor:
    @sensor(modality="object")
    def read(cache: dict[str, Any]) -> Array:
        return value.copy()

    return read  # type: ignore[no-any-return]


def _door(bodies: Source, fixture: Fixture) -> Sensor:
    @sensor(modality="object")
    def read(cache: dict[str, Any]) -> Array:
        angles = [bodies().joint(panel.joint) for panel in fixture.door_panels]
        return np.array([min(angles), max(angles)])

    return read  # type: ignore[no-any-return]


def _handle(bodies: Source, fixture: Fixture) -> Sensor:
    @sensor(modality="object")
    def read(cache: dict[str, Any]) -> Array:
        found = bodies()
        panel = min(fixture.door_panels, key=lambda panel: found.joint(panel.joint))
        return found.data.site_xpos[found.model.site(panel.grip).id].copy()

    return read  # type: ignore[no-any-return]


def _switches(name: str, switched: Callable[[str], list[float]]) -> Sensor:
    @sensor(modality="object")
    def read(cache: dict[str, Any]) -> Array:
        return np.array(switched(name))

    return read  # type: ignore[no-any-return]


def _middle(layout: Layout, fixture: Fixture) -> Array:
    """The middle of a fixture's slots, or of its boxes where it has none."""
    if fixture.slots:
        return np.mean([layout.middle(slot.name) for slot in fixture.slots], axis=0)
    boxes = [layout.frame(fixture.name).block(block) for block in fixture.blocks]
    return np.mean([[box.low, box.high] for box in boxes], axis=(0, 1))
