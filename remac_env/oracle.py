"""Exact shortest plans, for one robot or several, by A* over rounds of the skill table.

Only commands that can matter for the goal are tried, so the plan is the shortest over those commands: about every
object that the goal names or that is in its way, and every surface to put a thing down on.
"""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from remac_env.conditions import destination, stations_of
from remac_env.marks import SEASONED, WASHED, washed
from remac_env.rounds import NAVIGATION, attempt, first_false, merge
from remac_env.state import Place, Scene, WorldState, contents, inside, occupant, supports
from remac_env.subtasks import WAIT, Subtask
from remac_env.tasks.goals import DoorIs, Goal, Inside, Marked, SwitchedOn

Reached = Callable[[WorldState], bool]
Joint = dict[str, Subtask]
_Entry = tuple[int, int, int, WorldState, WorldState | None, Joint]


@dataclass(frozen=True)
class OraclePlan:
    """A shortest plan: `rounds` of joint subtasks, one entry a robot; `expanded` states were looked at."""

    rounds: tuple[Mapping[str, Subtask], ...]
    expanded: int

    @property
    def length(self) -> int:
        """Number of rounds."""
        return len(self.rounds)

    def as_text(self) -> dict[str, list[str]]:
        """Robot -> commands, without the waits after its last subtask."""
        plan: dict[str, list[str]] = {}
        for joint in self.rounds:
            for robot, subtask in joint.items():
                plan.setdefault(robot, []).append(subtask.text)
        for commands in plan.values():
            while commands and commands[-1] == WAIT.text:
                commands.pop()
        return plan


def solve(scene: Scene, world: WorldState, goal: Goal, *, max_rounds: int = 30) -> OraclePlan | None:
    """The shortest plan to the goal for all robots of the scene, or None when there is none within `max_rounds`."""
    return search_plan(
        scene,
        world,
        lambda state: goal.holds(scene, state),
        commands=relevant_commands(scene, world, goal),
        bound=lambda state: _rounds_at_least(scene, state, goal),
        max_rounds=max_rounds,
    )


def search_plan(
    scene: Scene,
    world: WorldState,
    reached: Reached,
    *,
    commands: Sequence[Subtask],
    bound: Callable[[WorldState], int] = lambda state: 0,
    max_rounds: int = 30,
    max_states: int = 200_000,
) -> OraclePlan | None:
    """The shortest sequence of rounds to a state in which `reached` is true.

    Args:
        commands: the subtasks that robots may run; waiting is always allowed.
        bound: a number of rounds that the rest needs at least; 0 makes the search breadth-first.
        max_rounds, max_states: where to give up and return None.
    """
    counter = itertools.count()
    parents: dict[WorldState, tuple[WorldState, Joint] | None] = {}
    costs = {world: 0}
    queue: list[_Entry] = [(bound(world), next(counter), 0, world, None, {})]
    while queue:
        _, _, depth, state, parent, joint = heapq.heappop(queue)
        if state in parents:
            continue
        parents[state] = None if parent is None else (parent, joint)
        if reached(state):
            return OraclePlan(tuple(_trace(parents, state)), len(parents))
        if depth >= max_rounds or len(parents) >= max_states:
            continue
        for move, after in _joint_moves(scene, state, commands):
            if after not in parents and depth + 1 < costs.get(after, max_rounds + 1):
                costs[after] = depth + 1
                entry = (depth + 1 + bound(after), next(counter), depth + 1, after, state, move)
                heapq.heappush(queue, entry)
    return None


def _trace(parents: Mapping[WorldState, tuple[WorldState, Joint] | None], state: WorldState) -> list[Joint]:
    rounds: list[Joint] = []
    while (step := parents[state]) is not None:
        state, joint = step
        rounds.append(joint)
    return rounds[::-1]


def _joint_moves(scene: Scene, world: WorldState, commands: Sequence[Subtask]) -> Iterable[tuple[Joint, WorldState]]:
    """Every round whose subtasks all succeed, with the world after it."""
    single = {robot: _moves(scene, world, robot, commands) for robot in scene.robots}
    names = list(single)
    for choice in itertools.product(*single.values()):
        stations = [station for _, _, station in choice]
        if any(scene.conflicting(a, b) for a, b in itertools.combinations(stations, 2)):
            continue
        picked = [subtask.target for subtask, _, _ in choice if subtask.skill == "pick up"]
        if len(set(picked)) < len(picked):
            continue
        after = merge(world, {name: move[1] for name, move in zip(names, choice, strict=True)})
        if after is not None and after != world:
            yield {name: move[0] for name, move in zip(names, choice, strict=True)}, washed(scene, after)


def _moves(
    scene: Scene, world: WorldState, robot: str, commands: Sequence[Subtask]
) -> list[tuple[Subtask, WorldState, str]]:
    """This robot's subtasks that would succeed now: (subtask, world with its effect alone, its station after)."""
    here = world.robots[robot].station
    moves = [(WAIT, world, here)]
    seen = {here}
    for subtask in commands:
        if first_false(scene, world, robot, subtask, "refuse", skip=("station_free",)) is not None:
            continue
        station = here
        if subtask.skill in NAVIGATION:
            goal = "aside" if subtask.skill == "navigate aside" else destination(scene, world, robot, subtask.target)
            if goal is None or goal in seen:
                continue
            seen.add(goal)
            station = goal
        outcome, after = attempt(scene, world, robot, subtask, station=station)
        if outcome.success:
            moves.append((subtask, after, station))
    return moves


def relevant_commands(scene: Scene, world: WorldState, goal: Goal) -> list[Subtask]:
    """The commands that can matter: about what the goal names, what is around or in its way, and where to put down."""
    objects, fixtures = _relevant_nouns(scene, world, goal)
    surfaces = [name for name, facts in scene.fixtures.items() if facts.slots and not facts.door and not facts.switches]
    commands = [Subtask("navigate aside")]
    for name in objects:
        commands += [Subtask("navigate to", name), Subtask("pick up", name)]
        if scene.objects[name].holds:
            commands.append(Subtask("place to", name))
    for name in dict.fromkeys([*fixtures, *surfaces]):
        facts = scene.fixtures[name]
        commands.append(Subtask("navigate to", name))
        commands += [Subtask("place to", name)] if facts.slots else []
        commands += [Subtask("open door", name), Subtask("close door", name)] if facts.door else []
        commands += [Subtask("turn on", name), Subtask("turn off", name)] if facts.switches else []
    return commands + [Subtask("season", name) for name in _to_mark(goal, SEASONED)]


def _to_mark(goal: Goal, mark: str) -> list[str]:
    """The objects to which `mark` is to happen."""
    return [atom.name for atom in goal.atoms() if isinstance(atom, Marked) and atom.mark == mark]


def _relevant_nouns(scene: Scene, world: WorldState, goal: Goal) -> tuple[list[str], list[str]]:
    objects = [name for name in goal.names() if name in scene.objects]
    fixtures = [name for name in goal.names() if name in scene.fixtures]
    if _to_mark(goal, SEASONED):
        objects += [name for name, facts in scene.objects.items() if facts.seasons]
    if _to_mark(goal, WASHED):
        fixtures += [name for tap, facts in scene.fixtures.items() if facts.wets for name in (tap, *facts.wets)]
    for name in list(fixtures):
        slots = scene.fixtures[name].slots
        taken = [occupant(world, slot) for slot in slots]
        if slots and all(other is not None for other in taken):
            objects += [other for other in taken if other is not None]
    for name in objects:
        # The list grows while it is read: what lies in a thing that is in the way is in the way too.
        fresh = [other for other in contents(world, name) if other not in objects]
        fresh += [other for other in supports(scene, world, name) if other in scene.objects and other not in objects]
        objects += fresh
        around = [scene.fixtures[other] for other in supports(scene, world, name) if other in scene.fixtures]
        fixtures += [facts.name for facts in around if facts.door]
    return list(dict.fromkeys(objects)), list(dict.fromkeys(fixtures))


def _rounds_at_least(scene: Scene, world: WorldState, goal: Goal) -> int:
    """A lower bound on the rounds left: the longest chain that any one part of the goal still needs."""
    return max((_atom_needs(scene, world, goal, atom) for atom in goal.atoms()), default=0)


def _atom_needs(scene: Scene, world: WorldState, goal: Goal, atom: Goal) -> int:
    if atom.holds(scene, world):
        return 0
    if isinstance(atom, Marked) and atom.mark == WASHED:
        return _washing_needs(scene, world, atom.name)
    if isinstance(atom, SwitchedOn) and scene.fixtures[atom.fixture].shut_to_run:
        return 1 if world.fixtures[atom.fixture].door == "closed" else 2
    if not isinstance(atom, Inside):
        return 1
    after = _rounds_after(scene, goal, atom.container)
    if atom.name in _to_mark(goal, WASHED) and WASHED not in world.objects[atom.name].marks:
        # Out of the basin, there, and in; the going falls away where both are used from one station.
        return _washing_needs(scene, world, atom.name) + 2 + after
    place = world.objects[atom.name].place
    if place.relation == "held":
        return after + (1 if _stands_at(scene, world, place.where, atom.container) else 2)
    if place == Place("floor"):
        return 1
    # pick up, go, place - the going falls away only where both are used from one station.
    return after + (3 if not _one_station(scene, world, atom) else 2)


def _rounds_after(scene: Scene, goal: Goal, container: str) -> int:
    """Rounds that are left once the last thing has gone into a container: its door was open then."""
    if container not in scene.fixtures or not scene.fixtures[container].door:
        return 0
    rest = [atom for atom in goal.atoms() if isinstance(atom, SwitchedOn | DoorIs) and atom.fixture == container]
    runs = any(isinstance(atom, SwitchedOn) for atom in rest) and scene.fixtures[container].shut_to_run
    shut = any(isinstance(atom, DoorIs) and atom.door == "closed" for atom in rest)
    return 2 if runs else int(shut)


def _washing_needs(scene: Scene, world: WorldState, name: str) -> int:
    """Rounds until water has run on a thing, at least."""
    basins = [basin for facts in scene.fixtures.values() for basin in facts.wets]
    if any(inside(scene, world, name, basin) for basin in basins):
        return 1
    place = world.objects[name].place
    if place.relation == "held":
        return 1 if any(_stands_at(scene, world, place.where, basin) for basin in basins) else 2
    return 2


def _stands_at(scene: Scene, world: WorldState, robot: str, container: str) -> bool:
    return world.robots[robot].station in stations_of(scene, world, container)


def _one_station(scene: Scene, world: WorldState, atom: Inside) -> bool:
    first = set(stations_of(scene, world, atom.name))
    # A container that is itself still to be moved may come to this very station.
    second = stations_of(scene, world, atom.container)
    return bool(first & set(second)) or not second or atom.container in scene.objects
