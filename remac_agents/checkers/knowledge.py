"""What the rules of the kitchen say of a condition of knowledge, once somebody has looked where objects are.

Answers have three values: None is "cannot tell", and stays so wherever the rest does not decide.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from remac_env.rules.conditions import Condition, condition
from remac_env.rules.facts import Rules

Look = Callable[[Condition], bool | None]
"""What somebody sees of a condition; None: cannot tell."""

Holding = Mapping[str, str | None]

FALSE_IF_UNSEEN = frozenset({"no_vessel_needed"})
"""What counts as false of a robot that holds something where looking does not tell: a vessel that was there after all
costs a detour, one that is missing costs the meal."""


def ruled(asked: Condition, rules: Rules, holding: Holding, look: Look) -> bool | None:
    """Whether a condition of the kind known holds; None where looking does not tell, or there is no rule for it."""
    rule = _RULES.get(asked.predicate)
    return None if rule is None else rule(rules, holding, look, *asked.args)


def any_of(answers: Iterable[bool | None]) -> bool | None:
    """True if one is, False if all are, else None."""
    found = list(answers)
    return True if True in found else None if None in found else False


def all_of(answers: Iterable[bool | None]) -> bool | None:
    """False if one is, True if all are, else None."""
    found = list(answers)
    return False if False in found else None if None in found else True


def _no_vessel_needed(rules: Rules, holding: Holding, look: Look, robot: str, target: str) -> bool | None:
    """It needs none there, or would come to lie in one: in the only place of the fixture, where a vessel with room is.

    Without such a vessel it would not, whatever else is there. Of a fixture with several places it is not known which
    are free, unless fewer objects can be there than places.
    """
    if robot not in holding:
        return None
    held = holding[robot]
    if held is None or target not in rules.fixtures:
        return True
    fixture = rules.fixtures[target]
    if fixture.kind not in rules.objects[held].needs_vessel_in:
        return True
    carried = {name for name in holding.values() if name is not None}
    free = [name for name in rules.objects if name not in carried]
    vessels = [name for name in free if fixture.kind in rules.objects[name].vessel_in]
    there = {name: look(condition("inside", name, target)) for name in vessels}
    if any_of(there.values()) is False:
        return False
    there |= {name: look(condition("inside", name, target)) for name in free if name not in there}
    places = [sum(station in rules.slots[slot].stations for slot in fixture.slots)
              for station in rules.stations_of(target)]  # fmt: skip
    if sum(answer is not False for answer in there.values()) < min(places, default=1):
        return False
    in_one = all_of([any_of(there[name] for name in vessels), look(condition("room", robot, target))])
    return in_one if in_one is False or max(places, default=0) == 1 else None


def _graspable(rules: Rules, holding: Holding, look: Look, target: str) -> bool | None:
    """It stands where a hand has room beside it, and in no vessel that is too deep for a hand there."""
    facts = rules.objects[target]
    vessels = {name: vessel.too_deep_in for name, vessel in rules.objects.items() if name != target and vessel.holds}
    hindered = []
    for name, fixture in rules.fixtures.items():
        deep = [vessel for vessel, kinds in vessels.items() if fixture.kind in kinds]
        if not fixture.slots or not (deep or fixture.kind in facts.too_big_for):
            continue
        within = look(condition("inside", target, name))
        if fixture.kind not in facts.too_big_for:
            within = all_of([within, any_of(look(condition("directly_on", target, vessel)) for vessel in deep)])
        hindered.append(within)
    found = any_of(hindered)
    return None if found is None else not found


_RULES: dict[str, Callable[..., bool | None]] = {"no_vessel_needed": _no_vessel_needed, "graspable": _graspable}
