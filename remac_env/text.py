"""What a planner is told: names and commands, and states only where they are asked for."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from remac_env.rules.facts import Rules
from remac_env.rules.outcomes import Outcome
from remac_env.rules.scene import PublicScene
from remac_env.state import Place, WorldState


def describe(
    scene: PublicScene, commands: Sequence[str], goal: str, *, clock: str = "rounds", notes: Sequence[str] = ()
) -> str:
    """The scene as names alone, how it is used, and the goal sentence; facts, and no states.

    Args:
        commands: what can be said to robots; clock: rounds or events, of which it is said how it is used.
        notes: what else everybody may know, a sentence each.
    """
    return "\n".join(
        (
            f"Robots: {', '.join(scene.robots)}. Each has one gripper.",
            f"Fixtures: {', '.join(scene.fixtures)}.",
            f"Objects: {', '.join(sorted(scene.objects))}.",
            f"Commands: {', '.join(commands)}.",
            describe_use(scene, clock=clock),
            *notes,
            f"Goal: {goal}.",
        )
    )


def describe_use(scene: PublicScene, *, clock: str = "rounds") -> str:
    """What rounds and places are, and what has room where: what everybody may know who plans here or mends a plan."""
    course = _rounds(scene) if clock == "rounds" else _events(scene)
    return "\n".join((*course, *_places(scene, clock=clock), *describe_room(scene), *_vessels(scene)))


def _rounds(scene: PublicScene) -> tuple[str, ...]:
    """What a round is, and the commands that are about no object."""
    aside = "`navigate aside` takes the robot out of the way, where it can use nothing."
    if len(scene.robots) == 1:
        done = "`done` says that the robot has finished, and the episode ends."
        return (f"In a round the robot runs one command. `wait` lets a round pass. {done} {aside}",)
    return (
        "In a round every robot runs one command, all of them together; the next round begins when all have ended.",
        f"`wait` lets a round pass. `done` says that the robot has finished; the episode ends when all have. {aside}",
    )


def _events(scene: PublicScene) -> tuple[str, ...]:
    """What becomes of commands where robots do not wait for each other."""
    aside = "`navigate aside` takes the robot out of the way, where it can use nothing."
    if len(scene.robots) == 1:
        done = "`done` says that the robot has finished, and the episode ends."
        return (f"Commands take time. `wait` lasts until something happens, or 5 seconds. {done} {aside}",)
    return (
        "Commands take time, and each robot is asked for its next one when its own has ended, whatever the others do.",
        "`wait` lasts until something happens, or 5 seconds if all wait. `done` says that the robot has finished; the "
        f"episode ends when all have. {aside}",
    )


def _places(scene: PublicScene, *, clock: str) -> list[str]:
    """What can be used from where, as far as names say it, and where two robots cannot be together."""
    shared = (scene.used_from(station) for station in scene.stations)
    groups = dict.fromkeys(_listed(names) for names in shared if len(names) > 1)
    several = _listed(name for name in scene.fixtures if len(scene.stations_of(name)) > 1)
    lines = ["A fixture is used from its place, and so is an object that is there; `navigate to` goes to that place."]
    lines += [f"The same place serves {names}." for names in groups]
    lines += [f"Along {several} there are several places; an object there is used from one of them."] if several else []
    if len(scene.robots) > 1:
        if clock == "rounds":
            lines.append("Two robots cannot be in the same place, but one may leave it in the round in which the other")
            lines.append("arrives; out of the way there is room for all.")
        else:
            lines.append("Two robots cannot be in the same place, and it is taken from when one sets out for it until")
            lines.append("that one has left; out of the way there is room for all.")
        pairs = (sorted(_listed(scene.used_from(station)) for station in pair) for pair in scene.conflicts)
        lines += [f"While one robot is by {one}, no other can be by {other}." for one, other in sorted(pairs)]
    return [" ".join(lines)]


def describe_room(scene: PublicScene) -> list[str]:
    """How many objects the fixtures take that have one place in front of them, as a sentence; none where all have more.

    A fixture along which there are several places, such as a counter, has room for many.
    """
    one = [name for name, fixture in scene.fixtures.items() if fixture.room == 1]
    more = {
        name: fixture.room
        for name, fixture in scene.fixtures.items()
        if fixture.room > 1 and len(fixture.stations) == 1
    }
    carrying = ", or one vessel with what it carries" if _has_vessels(scene) else ""
    said = []
    if one:
        said.append(f"{_listed(one)} {'take one thing each' if len(one) > 1 else 'takes one thing'}{carrying}")
    said += [f"the {name} takes {room}{' things' if not one else ''}" for name, room in more.items()]
    told = "; ".join(said)
    return [f"{told[0].upper()}{told[1:]}."] if told else []


def _vessels(scene: PublicScene) -> list[str]:
    if not _has_vessels(scene):
        return []
    return ["An object that carries another one, such as a filled vessel, cannot be picked up."]


def _has_vessels(scene: PublicScene) -> bool:
    return any(facts.vessel for facts in scene.objects.values())


def _listed(names: Iterable[str]) -> str:
    """Names as in a sentence: the sink, the faucet and the stove."""
    *first, last = [f"the {name}" for name in names] or [""]
    return f"{', '.join(first)} and {last}" if first else last


def describe_states(scene: Rules, world: WorldState) -> str:
    """What is true now, one sentence a line; only with text="states"."""
    lines = []
    for name, robot in world.robots.items():
        held = f"holds the {robot.holding}" if robot.holding else "holds nothing"
        lines.append(f"{name} stands at {robot.station} and {held}.")
    for name, item in sorted(world.objects.items()):
        marks = f" It has been {' and '.join(sorted(item.marks))}." if item.marks else ""
        lines.append(f"The {name} is {_where(scene, item.place)}.{marks}")
    for name, fixture in world.fixtures.items():
        if fixture.door is not None:
            lines.append(f"The {name} door is {fixture.door}.")
        if scene.fixtures[name].switches:
            lines.append(f"The {name} is switched {'on' if fixture.on else 'off'}.")
    return "\n".join(lines)


def describe_unseen(names: Iterable[str]) -> str:
    """Of which objects nobody knows yet where they are; only with knowledge="seen"."""
    return f"Nobody has seen {_listed(sorted(names))} yet; what nobody has seen is behind a door."


def describe_outcome(outcome: Outcome | None, *, feedback: str) -> str:
    """One line on how the last subtask ended, or "" before the first; why only with feedback="reason"."""
    if outcome is None:
        return ""
    if outcome.success:
        return "The last command succeeded."
    why = f" ({outcome.reason}: {outcome.detail})" if feedback == "reason" else ""
    return f"The last command failed{why}."


def _where(scene: Rules, place: Place) -> str:
    if place.relation == "slot":
        return f"on or in the {scene.slots[place.where].fixture}"
    if place.relation == "vessel":
        return f"on or in the {place.where}"
    return f"held by {place.where}" if place.relation == "held" else "on the floor"
