"""What a layout must be like: nothing overlaps, doors swing free, robots reach every station and can pass."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import combinations

from remac_env.errors import KitchenFileError
from remac_env.kitchen.blocks import Block
from remac_env.kitchen.fixtures.base import WALL_Y, Fixture, Slot
from remac_env.kitchen.floor import TALL, Floor
from remac_env.kitchen.floor_plan import Layout, Station
from remac_env.kitchen.frame import Frame
from remac_env.robots import bodies
from remac_env.robots.bodies import STANDARD
from remac_env.robots.footprints import radius, width

ELBOW_ROOM = 0.36
"""Between two bases at neighbouring stations, m: two swinging elbows and a margin."""

WORK_HALF, WORK_DEPTH = 0.42, 1.30
"""Floor that a robot at work uses in front of its wall, m: to both sides of its station, and from the fronts on."""

STANCE_HALF = 0.60
"""How far to both sides of its station, m, a robot at work may bring its base or elbows."""

FREE_FRONT = 2.5
"""How far robots may drive beyond the open front of the room, m."""

_BESIDE, _BEHIND = 0.30, 0.42  # m from the floor of a working robot at which the axis of another one may pass
_PARKED = 0.80  # m from the axis of a parked robot at which another one's axis may pass
_FRONT_SLACK = 0.06  # m by which fridges and handles stand out of the line of fronts
_TOUCH = 0.001  # fixtures that reach this little, m, into one another merely touch

Corner = tuple[float, float]


def check(layout: Layout, file: str) -> None:
    """Raise KitchenFileError for whatever in the layout cannot be."""
    for fixture in layout.fixtures.values():
        _check_references(fixture, layout, file)
        _check_slots(fixture, file)
        _check_room(fixture, layout, file)
    for first, second in combinations(layout.fixtures.values(), 2):
        _check_apart(first, second, layout, file)
    for fixture in layout.fixtures.values():
        _check_sweep(fixture, layout, file)
    check_places(layout, file)
    if layout.team_asides:
        check_team(replace(layout, asides=layout.team_asides), file)


def station_gap(body: str = STANDARD) -> float:
    """Least distance between two stations of a layout file, m."""
    return width(bodies.get(body).footprint) + ELBOW_ROOM


def check_places(layout: Layout, file: str, body: str = STANDARD) -> None:
    """Raise KitchenFileError where robots of a body cannot stand, or cannot pass one that works or is parked."""
    _check_stations(layout, file, body)
    _check_ways(layout, file, radius(bodies.get(body).footprint))


def check_team(layout: Layout, file: str, body: str = STANDARD) -> None:
    """Raise KitchenFileError unless robots of a body on all parking places have room there, and out of there.

    Each reaches all stations while all others are parked, also while one of them works at any station.
    """
    check_places(layout, file, body)
    space = floor(layout, radius(bodies.get(body).footprint))
    for own in layout.asides:
        others = [place for place in layout.asides if place is not own]
        for worker in (None, *others):
            parked = [place for place in others if place is not worker]
            alone = _without(space, layout, parked)
            for station in layout.stations.values() if worker else ():
                _check_team_way(_without(alone, layout, [station]), layout, own, [*parked, station], file)
            if worker is None:
                _check_team_way(alone, layout, own, parked, file)


def _without(space: Floor, layout: Layout, places: Iterable[Station]) -> Floor:
    for place in places:
        block = in_use(layout, place)
        space = space.without(block.low[:2], block.high[:2])
    return space


def _check_team_way(space: Floor, layout: Layout, own: Station, others: Sequence[Station], file: str) -> None:
    cells, taken = space.reachable((own.x, own.y)), [in_use(layout, place) for place in others]
    for station in layout.stations.values():
        if not space.holds(cells, (station.x, station.y)) and not any(within(station, block) for block in taken):
            around = " and ".join(place.name for place in others)
            key = f"team_asides.{own.name}"
            raise KitchenFileError(file, key, f"{station.name} cannot be reached from there past robots at {around}")


def world_blocks(layout: Layout, fixture: Fixture) -> list[Block]:
    """The room a fixture takes up, world frame."""
    return [layout.frame(fixture.name).block(block) for block in fixture.blocks]


def work_floor(frame: Frame, station: Station, *, beside: float = 0.0, behind: float = 0.0) -> Block:
    """The floor, world frame, that a robot uses which works at a station of a wall with this frame; and more, m."""
    x, _ = frame.local(station.x, station.y)
    half, depth = WORK_HALF + beside, WORK_DEPTH + behind
    return frame.block(Block((x - half, -depth, 0.0), (x + half, WALL_Y, 1.0)))


def in_use(layout: Layout, place: Station) -> Block:
    """The floor, world frame, that the axis of a robot must not enter while another one works or is parked there."""
    if place.wall:
        return work_floor(layout.facing(place), place, beside=_BESIDE, behind=_BEHIND)
    return Block((place.x - _PARKED, place.y - _PARKED, 0.0), (place.x + _PARKED, place.y + _PARKED, 1.0))


def within(place: Station, block: Block) -> bool:
    """Whether the axis of a robot at a place is over a block, seen from above."""
    return block.low[0] < place.x < block.high[0] and block.low[1] < place.y < block.high[1]


@lru_cache(maxsize=64)
def floor(layout: Layout, around: float) -> Floor:
    """The floor of a layout, for robots that need so much, m, around their axis. Shared: do not change it."""
    blocks = [block for fixture in layout.fixtures.values() for block in world_blocks(layout, fixture)]
    (left, right), front = layout.room.x, layout.room.front - FREE_FRONT
    return Floor((left, front), (right, WALL_Y), blocks, around)


def _check_references(fixture: Fixture, layout: Layout, file: str) -> None:
    if fixture.part_of:
        wholes = [f.name for f in layout.fixtures.values() if f.kind == fixture.kind and f.slots and not f.part_of]
        if fixture.part_of not in wholes:
            key = f"fixtures.{fixture.name}.part_of"
            raise KitchenFileError(file, key, f"{fixture.part_of!r} is no {fixture.kind} with slots of its own", wholes)
        if not fixture.slots:
            raise KitchenFileError(file, f"fixtures.{fixture.name}.slots", "a part without slots is mere decoration")
    for station in fixture.stations:
        key = f"fixtures.{fixture.name}.station"
        if station not in layout.stations:
            raise KitchenFileError(file, key, f"unknown station {station!r}", layout.stations)
        if layout.stations[station].wall != fixture.wall:
            own = [name for name, place in layout.stations.items() if place.wall == fixture.wall]
            raise KitchenFileError(file, key, f"station {station!r} does not face wall {fixture.wall!r}", own)


def _check_slots(fixture: Fixture, file: str) -> None:
    """Slots lie on a surface of their fixture and apart from one another."""
    for slot in fixture.slots:
        key = f"fixtures.{fixture.name}.slots ({slot.name})"
        if min(slot.half) <= 0:
            raise KitchenFileError(file, key, f"half extents {slot.half} must be positive")
        if not any(
            _inside(_slot_span(slot, 0), surface.x) and _inside(_slot_span(slot, 1), surface.y)
            for surface in fixture.surfaces
        ):
            raise KitchenFileError(
                file,
                key,
                f"x {_shown(_slot_span(slot, 0))} y {_shown(_slot_span(slot, 1))} reaches off its surface",
                (f"x {_shown(surface.x)} y {_shown(surface.y)}" for surface in fixture.surfaces),
            )
    for first, second in combinations(fixture.slots, 2):
        if all(abs(first.center[i] - second.center[i]) < first.half[i] + second.half[i] - _TOUCH for i in (0, 1)):
            raise KitchenFileError(file, f"fixtures.{fixture.name}.slots", f"{first.name} overlaps {second.name}")


def _check_room(fixture: Fixture, layout: Layout, file: str) -> None:
    (left, right), height = layout.room.x, layout.room.height
    for block in world_blocks(layout, fixture):
        if (
            block.low[0] < left - _TOUCH
            or block.high[0] > right + _TOUCH
            or block.high[1] > WALL_Y + _TOUCH
            or block.low[1] < layout.room.front - _TOUCH
            or block.low[2] < -_TOUCH
            or block.high[2] > height + _TOUCH
        ):
            valid = f"x {_shown(layout.room.x)} y {_shown((layout.room.front, WALL_Y))} z {_shown((0.0, height))}"
            raise KitchenFileError(file, f"fixtures.{fixture.name}", f"{_shown_block(block)} leaves the room", valid)


def _check_apart(first: Fixture, second: Fixture, layout: Layout, file: str) -> None:
    for one in world_blocks(layout, first):
        for other in world_blocks(layout, second):
            if one.overlap(other) > _TOUCH:
                raise KitchenFileError(
                    file,
                    f"fixtures.{second.name}",
                    f"overlaps fixture {first.name} by {one.overlap(other):.3f} m; "
                    f"{second.name}: {_shown_block(other)}; {first.name}: {_shown_block(one)}",
                )


def _check_sweep(fixture: Fixture, layout: Layout, file: str) -> None:
    """Doors swing clear of other fixtures and of the room's walls."""
    points = [layout.frame(fixture.name).space(point) for point in fixture.swept_points]
    if not points:
        return
    left, right = layout.room.x
    if any(not left < x < right or y > WALL_Y for x, y, _ in points):
        raise KitchenFileError(file, f"fixtures.{fixture.name}", "its door swings into a wall of the room")
    for other in layout.fixtures.values():
        if other is not fixture and any(b.holds(p) for b in world_blocks(layout, other) for p in points):
            raise KitchenFileError(file, f"fixtures.{fixture.name}", f"its door swings into fixture {other.name}")


def _check_stations(layout: Layout, file: str, body: str) -> None:
    """Stations lie apart, and the floor that a robot uses there is free."""
    gap, around_axis = station_gap(body), radius(bodies.get(body).footprint)
    places = (*layout.stations.values(), *layout.asides)
    for first, second in combinations(places, 2):
        if first.distance(second) < gap - 1e-9:
            problem = f"{first.distance(second):.3f} m from station {first.name}"
            raise KitchenFileError(file, f"stations.{second.name}", problem, f"at least {gap:g} m apart")
    users = {station: fixture.name for fixture in layout.fixtures.values() for station in fixture.stations}
    for station in places:
        user = f" (where robots use fixture {users[station.name]})" if station.name in users else ""
        low, high = _stance(layout, station, around_axis, skilled=_skilled(layout, station.name))
        if low[0] < layout.room.x[0] or high[0] > layout.room.x[1] or high[1] > WALL_Y:
            raise KitchenFileError(file, f"stations.{station.name}", f"x {station.x:g} is too near a side wall{user}")
        if station.y < (front := layout.room.front - FREE_FRONT):
            key = f"stations.{station.name}"
            raise KitchenFileError(file, key, f"y {station.y:g} is outside the room", f"y from {front:g} up")
        around = Block((*low, 0.0), (*high, TALL))
        for name, block in _standing(layout):
            if around.overlap(block) > _TOUCH:
                raise KitchenFileError(
                    file, f"stations.{station.name}", f"a robot there would stand in fixture {name}{user}"
                )


def _standing(layout: Layout) -> Iterator[tuple[str, Block]]:
    for fixture in layout.fixtures.values():
        yield from ((fixture.name, block) for block in world_blocks(layout, fixture) if block.low[2] < TALL)


def _skilled(layout: Layout, station: str) -> bool:
    """Whether anything is handled at a station; a fridge is only gone to."""
    return any(
        station in fixture.stations and (fixture.door or fixture.switches or fixture.slots)
        for fixture in layout.fixtures.values()
    )


def _stance(layout: Layout, station: Station, around: float, *, skilled: bool) -> tuple[Corner, Corner]:
    """Low and high corner (x, y), world frame, of the floor that must be free for a robot to stand and work."""
    if not station.wall:
        return (station.x - around, station.y - around), (station.x + around, station.y + around)
    frame = layout.facing(station)
    x, y = frame.local(station.x, station.y)
    half = STANCE_HALF if skilled else WORK_HALF
    front = min(-_FRONT_SLACK, y + around) if y < 0 else y
    block = frame.block(Block((x - half, min(-WORK_DEPTH, y - WORK_HALF), 0.0), (x + half, front, 1.0)))
    return block.low[:2], block.high[:2]


def _check_ways(layout: Layout, file: str, around_axis: float) -> None:
    """Every place is reached from every other, also while another robot works or is parked anywhere."""
    space = floor(layout, around_axis)
    places = (*layout.stations.values(), *layout.asides)
    users = {station: fixture.name for fixture in layout.fixtures.values() for station in fixture.stations}
    lane = f"{2 * around_axis:.2f} m of free floor all the way"
    _check_reached(space, places, users, file, lane)
    for other in places:
        around = in_use(layout, other)
        rest = [p for p in places if p is not other and not within(p, around)]
        _check_reached(space.without(around.low[:2], around.high[:2]), rest, users, file, lane, other.name)


def _check_reached(
    space: Floor, places: Iterable[Station], users: dict[str, str], file: str, lane: str, blocker: str = ""
) -> None:
    """Raise for the first place that cannot be reached from the one before all others."""
    first, *rest = places
    cells = space.reachable((first.x, first.y))
    for place in rest:
        if not space.holds(cells, (place.x, place.y)):
            used = f" (fixture {users[place.name]})" if place.name in users else ""
            cause = f" past a robot at {blocker}: two robots cannot pass" if blocker else ""
            problem = f"cannot be reached from {first.name}{cause}{used}"
            raise KitchenFileError(file, f"stations.{place.name}", problem, lane)


def _slot_span(slot: Slot, axis: int) -> tuple[float, float]:
    return slot.center[axis] - slot.half[axis], slot.center[axis] + slot.half[axis]


def _inside(span: tuple[float, float], around: tuple[float, float]) -> bool:
    return around[0] - _TOUCH <= span[0] and span[1] <= around[1] + _TOUCH


def _shown(span: Iterable[float]) -> str:
    return "[{:.3f}, {:.3f}]".format(*span)


def _shown_block(block: Block) -> str:
    return " ".join(f"{axis} {_shown(span)}" for axis, *span in zip("xyz", block.low, block.high, strict=True))
