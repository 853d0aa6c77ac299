"""The way of one robot's commands to its servos: each is checked here, and nothing else moves a robot."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Mapping, Sequence

from remac_env.backends.physics.controllers.base import Command, CommandError, Controller, Proprioception, set_points
from remac_env.backends.physics.controllers.guard import guarded
from remac_env.backends.physics.controllers.learned.aim import feels
from remac_env.backends.physics.controllers.scripted.controller import Scripted, ended
from remac_env.backends.physics.controllers.scripted.motion import Steps
from remac_env.backends.physics.controllers.scripted.skill import go_home, take
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.backends.physics.pose import Pose
from remac_env.backends.physics.sensing import Briefed, Felt
from remac_env.backends.physics.simulation import CONTROL_PERIOD, Simulation
from remac_env.backends.physics.snapshot import STATION_DISTANCE, holding
from remac_env.kitchen.floor_plan import Station
from remac_env.robots.rotation import Array
from remac_env.rules.facts import Rules
from remac_env.rules.outcomes import Outcome, failure
from remac_env.rules.subtasks import Subtask
from remac_env.seeding import generator
from remac_env.state import WorldState, contents

SKILL_TIME = 60.0  # s, after which a skill is stopped
RECOVERY_TIME = 20.0  # s for coming home after a failure
_BACK = 20  # control periods, 1 s: a piece of the way that a controller came
_PIECES = 6  # of it that are gone back at most

Attempt = Generator[None, None, Outcome]


class Pilot:
    """Runs motions of one robot. ``own``: the controllers, by skill, that take the place of scripted ones.

    ``stopping``: it has been told to stop, and its skill ends before its next command.
    """

    def __init__(
        self, simulation: Simulation, here: Workspace, rules: Rules, own: Mapping[str, Controller], seed: int
    ) -> None:
        self._simulation, self._handle = simulation, simulation.robots[here.robot.name]
        self.here, self._own, self._seed = here, own, seed
        self._scripted = Scripted(here, rules)
        self.stopping = False

    def own_for(
        self, number: int, subtask: Subtask, world: WorldState, goal: Station | None = None
    ) -> Controller | None:
        """The controller of the robot's own for a subtask; None where the scripted one carries it out.

        One that has a method `covers` is asked whether the subtask, as it is briefed, is one for it.
        """
        controller = self._own.get(subtask.skill)
        covers = getattr(controller, "covers", None)
        return controller if covers is None or covers(subtask, self.briefed(number, subtask, world, goal)) else None

    def briefed(self, number: int, subtask: Subtask, world: WorldState, goal: Station | None = None) -> Briefed:
        """What the robot is told about a subtask that begins now; ``number``: of the batch in which it was given."""
        chance = generator(self._seed, "search", number, subtask.text)
        return Briefed(self.here.sensed.senses, Felt(self._handle), self.here.place, goal, world, chance)

    def wanted(self, subtask: Subtask, sensing: Briefed) -> Generator[Command, None, Outcome]:
        """What the scripted controller wants of the robot."""
        return self._scripted.run(subtask, sensing)

    def scripted(self, subtask: Subtask, sensing: Briefed) -> Attempt:
        """Run the scripted controller."""
        return self._kept(self._stoppable(self.wanted(subtask, sensing)), SKILL_TIME)

    def steps(self, steps: Steps, seconds: float) -> Attempt:
        """Run scripted steps."""
        return self._kept(ended(self.here, steps), seconds)

    def home(self) -> Attempt:
        """Come home from where the robot is, if that can be done."""
        self.here.robot.q = self.here.robot.measured
        return self.steps(go_home(self.here), RECOVERY_TIME)

    def skill(
        self, controller: Controller, subtask: Subtask, sensing: Briefed, hindered: Callable[[], bool]
    ) -> Attempt:
        """Run a controller of the robot's own at a station, and bring the robot home from wherever that leaves it.

        One that says how many `tries` it has begins again where it missed (`slipped`), but not where it was `hindered`.
        """
        for left in reversed(range(getattr(controller, "tries", 1))):
            came: list[Array] = []
            outcome = yield from self._owned(guarded(controller, subtask, sensing), sensing, came)
            home = yield from self._home_again(came, sensing.body, well=outcome.success)
            if not left or outcome.reason != "slipped" or not home.success or self.stopping or hindered():
                break
        return outcome

    def _home_again(self, came: Sequence[Array], body: Proprioception, *, well: bool) -> Attempt:
        """Come home from where a controller has left the robot.

        A policy may press an arm against something, or fold it as no path does. Where no way leads on, an empty hand
        first goes back by the way that it came, a piece at a time.

        Args:
            came: where the robot was at each of the controller's commands.
            body: what it feels of itself.
            well: it did what it was to do, so that its last set-points are where a path may begin.
        """
        home = (yield from self.steps(go_home(self.here), RECOVERY_TIME)) if well else (yield from self.home())
        for end in range(len(came), 0, -_BACK)[:_PIECES]:
            if home.success or feels(body):
                break
            piece = came[max(0, end - _BACK) : end]
            yield from self.steps(self.here.mover.play(piece[::-1]), RECOVERY_TIME)
            home = yield from self.home()
        return home

    def drive(self, controller: Controller, subtask: Subtask, sensing: Briefed) -> Attempt:
        """The same for a drive: the last bit to the station's home pose is scripted, where it has come near."""
        here, goal = self.here, sensing.goal
        if goal is None:
            return failure("blocked", "no parking place is free")
        here.leave()
        outcome = yield from self._owned(guarded(controller, subtask, sensing), sensing)
        x, y, _ = self._handle.standing
        if math.hypot(x - goal.x, y - goal.y) > STATION_DISTANCE:
            here.enter(here.place)
            return outcome if not outcome.success else failure("blocked", f"the drive did not end at {goal.name}")
        here.enter(goal)
        yield from self.steps(go_home(here), RECOVERY_TIME)
        return outcome

    def _owned(
        self, run: Generator[Command, None, Outcome], sensing: Briefed, came: list[Array] | None = None
    ) -> Attempt:
        """Pass on the commands of a controller of the robot's own; scripted motions can go on from what it has left."""
        stood = {name: sensing.pose(name) for name in sensing.objects}
        outcome = yield from self._bounded(self._stoppable(run, came), SKILL_TIME)
        self.here.robot.catch_up()
        self._feel(sensing.told, stood)
        return outcome

    def _feel(self, told: WorldState, stood: Mapping[str, Pose]) -> None:
        """Note what the hand holds by now. ``stood``: how everything stood before."""
        here = self.here
        held = holding(self._simulation, self._handle, here.kitchen.objects)
        if held is None:
            here.hand.body, here.hand.contents = None, ()
        elif held != here.hand.body:
            take(here, held, stood[held].seen_from(here.robot.frame), tuple(contents(told, held)))

    def _kept(self, run: Generator[Command, None, Outcome], seconds: float) -> Attempt:
        """Run scripted motions; the set-points at which they leave the robot stay in force."""
        outcome = yield from self._bounded(run, seconds)
        robot = self.here.robot
        self._handle.hold(robot.in_world(robot.q), robot.grip)
        return outcome

    def _stoppable(
        self, run: Generator[Command, None, Outcome], came: list[Array] | None = None
    ) -> Generator[Command, None, Outcome]:
        """The same commands, up to where the robot is told to stop. ``came``: takes where it was before each."""
        while not self.stopping:
            if came is not None:
                came.append(self.here.robot.measured)
            try:
                command = next(run)
            except StopIteration as end:
                outcome: Outcome = end.value
                return outcome
            yield command
        run.close()
        return failure("interrupted", "it was told to stop")

    def _bounded(self, run: Generator[Command, None, Outcome], seconds: float) -> Attempt:
        """Pass commands on for at most so long; a wrong one ends the run, and reaches no servo."""
        for _ in range(int(seconds / CONTROL_PERIOD)):
            try:
                command = next(run)
            except StopIteration as end:
                outcome: Outcome = end.value
                return outcome
            try:
                self._handle.take(*set_points(command, self._handle.body))
            except CommandError as wrong:
                run.close()
                return failure("invalid", str(wrong))
            yield
        run.close()
        return failure("timeout", f"not done after {seconds:.0f} s")
