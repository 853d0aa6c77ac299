"""What repairs have in common: where to put an object down, how to fetch it again, what stands where.

Everything that is not a static fact is asked of the checker.
"""

from __future__ import annotations

from collections.abc import Sequence

from remac_agents.roles import AdjustRequest
from remac_env.rules.conditions import Condition, condition
from remac_env.rules.facts import FixtureFacts, ObjectFacts
from remac_env.rules.predicates import PREDICATES
from remac_env.rules.skills import SKILLS
from remac_env.rules.subtasks import Subtask


def go(target: str) -> Subtask:
    """Navigate to it."""
    return Subtask("navigate to", target)


def take(obj: str) -> Subtask:
    """Pick it up."""
    return Subtask("pick up", obj)


def put(target: str) -> Subtask:
    """Place what is held there."""
    return Subtask("place to", target)


class KitchenSense:
    """Questions and short sequences around one request."""

    def __init__(self, request: AdjustRequest) -> None:
        self.request = request
        self.robot, self.subtask, self.target = request.robot, request.subtask, request.subtask.target
        self.rest = request.plan.row(request.robot)[1:]
        self.held = request.view.holding.get(request.robot)
        rules = request.view.rules
        if rules is None:
            raise ValueError("the rule adjuster was not given the rules; a planner that asks it needs_rules")
        self.fixtures, self.objects = rules.fixtures, rules.objects

    def true(self, predicate: str, *args: str) -> bool:
        """Whether the checker says so; what it cannot tell it does not say."""
        return self.request.ask(condition(predicate, *args)) is True

    def kind(self, target: str) -> FixtureFacts | ObjectFacts:
        """The static facts of a fixture or object."""
        return self.fixtures[target] if target in self.fixtures else self.objects[target]

    def open_surface(self, obj: str, *, avoid: Sequence[str] = ()) -> str | None:
        """A fixture to put `obj` down on: no door, no switch, no vessel needed; the largest first."""
        needs = self.objects[obj].needs_vessel_in
        options = [
            name
            for name, facts in self.fixtures.items()
            if facts.slots
            and not facts.door
            and not facts.switches
            and facts.kind not in needs
            and name not in avoid
        ]
        for name in sorted(options, key=lambda name: -len(self.fixtures[name].slots)):
            # Whether there is room can only be seen from where the robot stands; a long surface has other
            # parts.
            if (
                not self._one_station(name)
                or not self.true("at", self.robot, name)
                or self.true("room", self.robot, name)
            ):
                return name
        return None

    def put_down(self, *, avoid: Sequence[str] = ()) -> tuple[Subtask, ...] | None:
        """Steps that empty the hand; () if it is empty, None if there is nowhere to put the object."""
        if self.held is None:
            return ()
        surface = self.open_surface(self.held, avoid=avoid)
        return None if surface is None else (go(surface), put(surface))

    def move_away(self, obj: str) -> tuple[Subtask, ...] | None:
        """Steps, with an empty hand, that bring `obj` from the target to an open surface."""
        surface = self.open_surface(obj, avoid=(self.target,))
        if surface is None:
            return None
        # By the name of what it is in: a plan that is there already needs no second way.
        named = self.target in self.objects or self._one_station(self.target)
        way = () if named and self._can_put_here(surface) else (go(surface),)
        return (go(self.target if named else obj), take(obj), *way, put(surface))

    def _can_put_here(self, surface: str) -> bool:
        """Whether an empty hand could take something from the target and put it there without a step."""
        here = self.held is None and all(self.true("at", self.robot, name) for name in (self.target, surface))
        return here and self.true("room", self.robot, surface)

    def _one_station(self, fixture: str) -> bool:
        return len(self.request.view.scene.stations_of(fixture)) == 1

    def with_empty_hand(self, work: Sequence[Subtask]) -> tuple[Subtask, ...] | None:
        """Put down what is held, do `work`, fetch the object if it is needed, come back to the target."""
        down = self.put_down(avoid=(self.target,))
        if down is None:
            return None
        steps = [*down, *work]
        needs_object = any(
            r.condition.predicate != "hand_empty" for r in self.subtask.requirements(self.robot)
        )
        if self.held is not None and needs_object and not self.subtask.row.takes:
            steps += [go(self.held), take(self.held)]
        return self.and_back(steps)

    def and_back(self, steps: Sequence[Subtask]) -> tuple[Subtask, ...]:
        """The steps, and the way back to the target if they lead elsewhere."""
        leads_away = any(step.moves for step in steps) and steps[-1] != go(self.target)
        return (*steps, go(self.target)) if leads_away else tuple(steps)

    def failed(self, repair: str) -> list[Condition]:
        """The conditions that failed whose row names this repair."""
        rows = ((condition, PREDICATES.get(condition.predicate)) for condition in self.request.failed)
        return [condition for condition, row in rows if row is not None and row.repair == repair]

    def achieving(self, wanted: Condition) -> list[Subtask]:
        """The commands of this kitchen after which a condition holds."""
        steps = [Subtask(skill, name) for skill in SKILLS for name in (*wanted.args, "")]
        legal = [step for step in steps if step.text in self.request.commands]
        return [step for step in dict.fromkeys(legal) if wanted in step.achieves(self.robot, self.held)]

    def not_looked_into(self) -> str | None:
        """The first fixture behind whose door nobody has looked in this episode, as far as commands tell."""
        done = {ran.command for ran in self.request.ran if not ran.failed}
        for name, facts in self.fixtures.items():
            opened = Subtask("open door", name).text in done
            visited = go(name).text in done and self.true("door_open", name)
            if facts.door and facts.slots and not opened and not visited:
                return name
        return None

    def inside(self, container: str) -> list[str]:
        """The objects that the checker sees on or in a fixture or vessel, other than what is held."""
        return [name for name in self.objects if name != self.held and self.true("inside", name, container)]

    def lowest(self, names: Sequence[str]) -> str | None:
        """Of objects at one place, one that lies on none of the others."""
        vessels = [name for name in names if self.objects[name].holds]
        for name in names:
            if not any(self.true("directly_on", name, vessel) for vessel in vessels if vessel != name):
                return name
        return next(iter(names), None)

    def last_taken(self) -> str | None:
        """What the robot took up last, as far as it knows."""
        taken = [step.target for step in self.request.executed if step.row.takes]
        return taken[-1] if taken else None

    def has_served(self) -> bool:
        """Whether the robot has worked with what it holds since it took it up: then it cannot be taken up later."""
        since: list[Subtask] = []
        for step in self.request.executed:
            since = [] if step.row.takes else [*since, step]
        return any(not step.moves for step in since)

    def surrounding(self, target: str) -> str | None:
        """The fixture with a door that `target` is, or is in."""
        doors = [name for name, facts in self.fixtures.items() if facts.door]
        if target in doors:
            return target
        return next(
            (name for name in doors if target in self.objects and self.true("inside", target, name)), None
        )
