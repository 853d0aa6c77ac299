"""The planner for what takes its time, by rule: what goes on by itself is started first, the rest is done meanwhile.

The goal is taken part by part, each by one robot with the shortest way to that part alone; a vessel goes where it
belongs before anything is put into it, as none is carried with what it holds. It looks no further: where a deadline is
short it may be late. Who has opened what falls shut stays there until another robot comes with what it is
for; and a robot alone begins nothing after which it would come too late to what spoils
(`remac_agents.planning.lasting`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from remac_agents.plan import Commands, Plan, PlanError
from remac_agents.planners.oracle import for_robots
from remac_agents.planning.lasting import SLOWER, falls_shut, in_time, keeps_open
from remac_agents.roles import PlanRequest
from remac_env import oracle
from remac_env.events.makespan import set_up
from remac_env.events.rehearsal import rehearse
from remac_env.rules.claims import feasible
from remac_env.rules.facts import ASIDE, Process, Rules
from remac_env.rules.places import destination
from remac_env.rules.processes import WHERE, WHILE
from remac_env.rules.subtasks import STEP_ASIDE, WAIT, Subtask
from remac_env.state import WorldState
from remac_env.tasks.compound import Not
from remac_env.tasks.goals import All, DoorIs, Goal, Inside, Marked, Released, SwitchedOn

NOTHING: Mapping[str, float] = {}
"""Nothing goes on by itself."""

ROUNDS = 60
"""Rounds of a plan at most: more than the nine tasks take by far."""

MOST_STATES = 4_000
"""States that the search for one part looks at."""


@dataclass(frozen=True)
class Part:
    """A part of the goal, and any of the ways to it.

    `about`: the objects that it needs; `vessels`: those that still have to go somewhere before it can be finished.
    """

    ways: tuple[Goal, ...]
    about: frozenset[str]
    vessels: frozenset[str] = frozenset()


class TimelyPlanner:
    """Plans for the robots that are asked, from the true state. Asked for one robot's next command (`act`), it
    reckons with what the others are at; asked for a plan, it plays forward in the skill table, waits included."""

    needs_truth = needs_rules = True

    def plan(self, request: PlanRequest) -> Plan | PlanError:
        """The next command, or a plan in rounds."""
        if request.world is None or request.rules is None or request.goal_test is None:
            return PlanError("the planner was not given the truth")
        goal = request.goal_test
        if request.question == "act" or request.single_step:
            known = Commands(request.commands)
            mates = {name: known.parse(text) or WAIT for name, text in request.teammates.items()}
            robot = request.lead
            # How long commands take is not known where robots are asked one by one; a plan goes by the table's seconds.
            step = next_step(request.rules, request.world, goal, robot, mates, request.slow, slower=SLOWER)
            return Plan.of({robot: [step]})
        rules, world = for_robots(request.rules, request.world, request.robots)
        return Plan.of(_rows(rules, world, goal))


def next_step(
    rules: Rules,
    world: WorldState,
    goal: Goal,
    robot: str,
    mates: Mapping[str, Subtask],
    slow: Mapping[str, float] = NOTHING,
    *,
    slower: float = 1.0,
) -> Subtask:
    """What a robot does next, the others being at what they are at; WAIT where there is nothing for it.

    `slow`: what goes on by itself, as "process object" -> for how long already, s. `slower`: see `in_time`.
    """
    for part in _open_to(robot, world, mates, list(_parts(rules, world, goal))):
        if not part.about & _busy_with(world, robot, mates):
            for step in _steps(rules, world, part, robot):
                if step.target not in part.vessels and _may(rules, world, robot, step, mates):
                    if keeps_open(rules, world, goal, robot, step, mates):
                        return WAIT
                    own = rules.robots == (robot,)
                    return in_time(rules, world, goal, step, slow, slower=slower) if own else step
    leaves = world.robots[robot].station != ASIDE and feasible(rules, world, robot, STEP_ASIDE)
    if not leaves or keeps_open(rules, world, goal, robot, STEP_ASIDE, mates):
        return WAIT
    return STEP_ASIDE if mates or len(rules.robots) > 1 else WAIT


def _open_to(robot: str, world: WorldState, mates: Mapping[str, Subtask], parts: list[Part]) -> list[Part]:
    """What a robot may do, in order: first what it holds something for, and that alone while another robot brings the
    vessel for it; without one, what needs that vessel is put off.
    """
    held, busy = world.robots[robot].holding, _busy_with(world, robot, mates)
    able = [part for part in parts if part.vessels <= busy]
    own = [part for part in able if held in part.about]
    if any(part.vessels for part in own):
        return own
    return own + [part for part in able if part not in own]


def _parts(rules: Rules, world: WorldState, goal: Goal) -> Iterator[Part]:
    """What is still to be done, the most urgent first."""
    atoms = [atom for atom in goal.atoms() if not atom.holds(rules, world)]
    waited = [(atom.name, process) for atom in atoms if isinstance(atom, Marked)
              for process in rules.processes if process.mark == atom.mark]  # fmt: skip
    needed = {place for _, process in waited for place in WHERE[process.during](rules)}
    for atom in atoms:
        if isinstance(atom, Not) and isinstance(atom.goal, SwitchedOn) and atom.goal.fixture not in needed:
            yield Part((atom,), frozenset())
    going = {name for name, process in waited if WHILE[process.during](rules, world, name)}
    for name, process in waited:
        if name not in going:
            yield Part(tuple(_ways(rules, name, process)), frozenset((name,)))
    loose = {atom.name for atom in atoms if isinstance(atom, Inside)}
    for name in dict.fromkeys(atom.name for atom in atoms if isinstance(atom, Inside | Released)):
        if name not in going:
            own = [atom for atom in goal.atoms() if isinstance(atom, Inside | Released) and atom.name == name]
            around = {atom.container for atom in own if isinstance(atom, Inside)}
            yield Part((All(*own),), frozenset((name,)), frozenset(around & loose))
    full = {atom.container for atom in atoms if isinstance(atom, Inside)}
    for atom in atoms:
        if isinstance(atom, DoorIs) and atom.fixture not in full:
            yield Part((atom,), frozenset())
        elif not isinstance(atom, Not | Marked | Inside | Released | DoorIs):
            yield Part((atom,), frozenset(set(atom.names()) & set(rules.objects)))


def _ways(rules: Rules, name: str, process: Process) -> Iterator[Goal]:
    """How a process is made to go on; where each place has a switch, in a vessel on one."""
    for way in set_up(rules, name, process):
        switched = [atom.fixture for atom in way.atoms() if isinstance(atom, SwitchedOn)]
        split = [place for place in switched if rules.fixtures[place].switch_per_slot]
        if not split:
            yield way
        for place in split:
            vessels = (each for each, facts in rules.objects.items() if rules.fixtures[place].kind in facts.vessel_in)
            yield from (All(Inside(name, vessel), SwitchedOn(place, under=vessel)) for vessel in vessels)


def _busy_with(world: WorldState, robot: str, mates: Mapping[str, Subtask]) -> frozenset[str]:
    """The objects that other robots hold or are about to touch."""
    held = {state.holding for name, state in world.robots.items() if name != robot and state.holding}
    return frozenset({*held, *(step.target for name, step in mates.items() if name != robot)})


def _steps(rules: Rules, world: WorldState, part: Part, robot: str) -> list[Subtask]:
    """The first steps of the shortest plans of all ways to a part, the shortest first, as if the robot were alone."""
    own, alone = for_robots(rules, world, (robot,))
    own = replace(own, processes=())
    plans = _plans(own, alone, part)
    # What only a team can do has no plan for one, but the others do their share.
    plans = plans or (_plans(replace(own, quirks=()), alone, part) if own.quirks and len(rules.robots) > 1 else [])
    return [plan.rounds[0][robot] for plan in plans]


def _plans(rules: Rules, world: WorldState, part: Part) -> list[oracle.OraclePlan]:
    """The shortest plans of all ways to a part, the shortest first."""
    found = [oracle.solve(rules, world, way, max_states=MOST_STATES) for way in part.ways]
    return sorted((plan for plan in found if plan is not None and plan.rounds), key=lambda plan: len(plan.rounds))


def _may(rules: Rules, world: WorldState, robot: str, step: Subtask, mates: Mapping[str, Subtask]) -> bool:
    """Whether it can begin now, with the others where they are and where they go."""
    if not feasible(rules, world, robot, step):
        return False
    if step.row.goes is None:
        return True
    place = destination(rules, world, robot, step.target) if step != STEP_ASIDE else ASIDE
    goals: list[str | None] = [state.station for name, state in world.robots.items()
                               if name != robot and not _makes_way(rules, world, robot, name, mates)]  # fmt: skip
    goals += [destination(rules, world, name, mate.target) for name, mate in mates.items()
             if mate.row.goes is not None and mate != STEP_ASIDE]  # fmt: skip
    return place is None or not any(goal is not None and rules.conflicting(place, goal) for goal in goals)


def _makes_way(rules: Rules, world: WorldState, robot: str, other: str, mates: Mapping[str, Subtask]) -> bool:
    """Whether another robot, which keeps a door open, leaves as this one comes with what it has in its hand."""
    if world.robots[robot].holding is None or world.robots[other].holding is not None:
        return False
    return mates.get(other, STEP_ASIDE) == STEP_ASIDE and bool(falls_shut(rules, world, other))


def _rows(rules: Rules, world: WorldState, goal: Goal) -> dict[str, list[Subtask]]:
    """The rows of a plan in rounds, with as many waits as it takes by the table's seconds.

    Where it comes to nothing, as when one robot alone cannot keep a door open, those of the shortest plan if nothing
    happened by itself.
    """

    def choose(now: WorldState, going_on: Mapping[str, float]) -> dict[str, Subtask] | None:
        if goal.holds(rules, now):
            return None
        joint: dict[str, Subtask] = {}
        for robot in rules.robots:
            joint[robot] = next_step(rules, now, goal, robot, joint, going_on)
        return joint

    played = rehearse(rules, world, choose, rounds=ROUNDS)
    if len(played) == ROUNDS:
        still = oracle.solve(replace(rules, processes=()), world, goal, max_states=MOST_STATES)
        played = played if still is None else list(still.rounds)
    return {robot: [joint[robot] for joint in played] for robot in rules.robots}
