"""Backward chaining over the predicates: for each that can be false, steps that make it true.

It sees no more than it asks the checker, so a checker that errs misleads it. New steps are checked before
they are run like any others, so each repair looks one step back only.
"""

from __future__ import annotations

from collections.abc import Callable

from remac_agents.adjusters.kitchen_sense import KitchenSense, go, put, take
from remac_agents.roles import AdjustRequest, Advice
from remac_env.rules.predicates import PREDICATES
from remac_env.rules.subtasks import Subtask

Repair = Callable[[KitchenSense], Advice | None]


class RuleAdjuster:
    """Repairs the first false condition that a rule can repair, the most telling first."""

    needs_truth, needs_rules = False, True

    def adjust(self, request: AdjustRequest) -> Advice:
        """Steps to be run first and the robot's new row; the old row where no rule helps."""
        sense = KitchenSense(request)
        wanted = {row.repair for c in request.failed if (row := PREDICATES.get(c.predicate)) is not None}
        for name, repair in REPAIRS.items():
            if name in wanted and (advice := repair(sense)) is not None:
                return advice
        sentences = "; ".join(condition.sentence for condition in request.failed)
        return Advice(f"no rule helps here, not true: {sentences}", row=request.plan.row(request.robot))


def _advice(
    sense: KitchenSense,
    reason: str,
    steps: tuple[Subtask, ...] | None,
    *,
    remedy: tuple[Subtask, ...] = (),
    instead: Subtask | None = None,
) -> Advice | None:
    if steps is None:
        return None
    row = (*steps, instead or sense.subtask, *sense.rest)
    return Advice(reason, steps, row, remedy, instead)


def _already_done(sense: KitchenSense) -> Advice:
    return Advice(f'"{sense.subtask.text}" is done already', (), sense.rest, left_out=True)


def _leave_out(sense: KitchenSense, reason: str) -> Advice:
    """Drop the step; unlike work that was done already, this says nothing about the task."""
    return Advice(reason, (), sense.rest)


def _not_placed(sense: KitchenSense) -> Advice | None:
    if sense.held == sense.target and (sense.subtask.moves or sense.subtask.row.takes):
        return _leave_out(sense, f"the {sense.target} is in hand already")
    return _search(sense) if sense.target in sense.request.view.unseen else None


def _search(sense: KitchenSense) -> Advice | None:
    """Nobody has seen it: look behind the next door."""
    fixture, down = sense.not_looked_into(), sense.put_down()
    if fixture is None or down is None:
        return None
    opened = sense.true("door_open", fixture)
    work = (go(fixture),) if opened else (go(fixture), Subtask("open door", fixture))
    back = () if sense.held is None or opened else (go(sense.held), take(sense.held))
    steps = (*(() if opened else down), *work, *back)
    return _advice(sense, f"nobody has seen the {sense.target}: it may be in the {fixture}", steps, remedy=work)


def _hand_is_empty(sense: KitchenSense) -> Advice | None:
    obj = sense.last_taken()
    if obj is None or (sense.held is None and sense.true("inside", obj, sense.target)):
        return _leave_out(sense, "there is nothing left to place")
    if sense.held is not None:
        return None  # the gripper feels something: the checker errs
    return _advice(sense, f"the {obj} was not in hand", (go(obj), take(obj), go(sense.target)))


def _no_shaker(sense: KitchenSense) -> Advice | None:
    shaker = next((name for name, facts in sense.objects.items() if facts.seasons), None)
    down = sense.put_down()
    if shaker is None or shaker == sense.held or down is None:
        return None
    fetch = (go(shaker), take(shaker))
    return _advice(
        sense,
        "a shaker is needed in hand",
        (*down, *fetch, go(sense.target)),
        remedy=(*fetch, go(sense.target)),
    )


def _shut(sense: KitchenSense) -> Advice | None:
    fixture = sense.surrounding(sense.target)
    if fixture is None:
        return None
    opening = Subtask("open door", fixture)
    here = sense.held is None and sense.true("at", sense.robot, fixture)
    work = (opening,) if here else (go(fixture), opening)
    return _advice(sense, f"the {fixture} door is shut", sense.with_empty_hand(work), remedy=work)


def _loaded(sense: KitchenSense) -> Advice | None:
    if not sense.objects[sense.target].holds:
        return None  # nothing can lie on it: the checker errs
    load = next(
        (n for n in sense.objects if n != sense.target and sense.true("directly_on", n, sense.target)), None
    )
    work = None if load is None else sense.move_away(load)
    if load is None or work is None:
        return None
    return _advice(
        sense, f"the {load} lies on or in the {sense.target}", sense.with_empty_hand(work), remedy=work
    )


def _vessel_needed(sense: KitchenSense) -> Advice | None:
    kind = sense.kind(sense.target)
    if sense.held is None or getattr(kind, "kind", "") not in sense.objects[sense.held].needs_vessel_in:
        return None  # no object in hand needs one there: the checker errs
    vessels = [
        n
        for n, facts in sense.objects.items()
        if getattr(kind, "kind", "") in facts.vessel_in and n != sense.held
    ]
    for vessel in vessels:
        if sense.true("inside", vessel, sense.target):
            return _advice(sense, f"the {vessel} has to hold the {sense.held}", (), instead=put(vessel))
    if not vessels:
        return None
    goal = sense.request.view.goal
    vessel = min(vessels, key=lambda name: name not in goal)  # one that the goal names, else the first
    work = (go(vessel), take(vessel), go(sense.target), put(sense.target))
    reason = f"a vessel has to hold the {sense.held} in the {sense.target}"
    return _advice(sense, reason, sense.with_empty_hand(work), remedy=work, instead=put(vessel))


def _hand_is_full(sense: KitchenSense) -> Advice | None:
    if sense.held is None:
        return None  # the gripper feels nothing: the checker errs
    if sense.subtask == take(sense.held):
        return _leave_out(sense, f"the {sense.held} is in hand already")
    down = sense.put_down(avoid=(sense.target,))
    if down is None:
        return None
    reason = f"the hand has to be empty to {sense.subtask.text}"
    steps = (*down, go(sense.target))
    if sense.subtask.row.takes or sense.has_served() and not _uses_object(sense.rest):
        return _advice(sense, reason, steps, remedy=down)
    fetch: tuple[Subtask, ...] = ()
    if _uses_object(sense.rest):
        back = () if sense.rest and sense.rest[0].skill == "navigate to" else (go(sense.target),)
        fetch = (go(sense.held), take(sense.held), *back)
    return Advice(
        reason,
        (*steps, sense.subtask, *fetch),
        (*steps, sense.subtask, *fetch, *sense.rest),
        (go(sense.target), sense.subtask),
    )


def _uses_object(rest: tuple[Subtask, ...]) -> bool:
    """Whether what is in hand is placed before anything else is taken up."""
    return next((step.row.puts for step in rest if step.row.takes or step.row.puts), False)


def _must_be_shut(sense: KitchenSense) -> Advice | None:
    if not sense.fixtures[sense.target].door:
        return None
    work = (Subtask("close door", sense.target),)
    return _advice(
        sense, f"the {sense.target} runs only when it is shut", sense.with_empty_hand(work), remedy=work
    )


def _elsewhere(sense: KitchenSense) -> Advice | None:
    steps = (go(sense.target),)
    return _advice(sense, f"{sense.robot} has to stand at the {sense.target}", steps, remedy=steps)


def _no_room(sense: KitchenSense) -> Advice | None:
    if sense.held is None:
        return None
    facts, holding = sense.kind(sense.target), sense.objects[sense.held].holds > 0
    others = sense.inside(sense.target)
    kind = getattr(facts, "kind", "")
    for vessel in others:
        if kind and kind in sense.objects[vessel].vessel_in and not holding:
            return _advice(sense, f"the {vessel} stands in the {sense.target}", (), instead=put(vessel))
    if kind and len(getattr(facts, "slots", ())) > 1 and sense.request.executed[-1:] != (go(sense.target),):
        return _advice(sense, f"another part of the {sense.target} may have room", (go(sense.target),))
    obj = sense.lowest(others)
    work = None if obj is None else sense.move_away(obj)
    if obj is None or work is None:
        return None
    return _advice(sense, f"the {obj} is in the way", sense.with_empty_hand(work), remedy=work)


def _achieve(sense: KitchenSense) -> Advice | None:
    """By any skill of the table that achieves just what is false."""
    for condition in sense.failed("achieve"):
        for step in sense.achieving(condition):
            work = (step,) if not step.target or sense.true("at", sense.robot, step.target) else (go(step.target), step)
            needs_hand = any(r.condition.predicate == "hand_empty" for r in step.requirements(sense.robot))
            steps = sense.with_empty_hand(work) if needs_hand else sense.and_back(work)
            return _advice(sense, f"not true: {condition.sentence}", steps, remedy=work)
    return None


REPAIRS: dict[str, Repair] = {
    "leave out": _already_done,
    "leave out if held": _not_placed,
    "fetch again": _hand_is_empty,
    "fetch a shaker": _no_shaker,
    "open the door": _shut,
    "unload": _loaded,
    "use a vessel": _vessel_needed,
    "put down": _hand_is_full,
    "shut the door": _must_be_shut,
    "achieve": _achieve,
    "go there": _elsewhere,
    "make room": _no_room,
}
"""What rows of predicates call a repair -> it, in the order in which they are tried: those further up mend those below
as well."""
