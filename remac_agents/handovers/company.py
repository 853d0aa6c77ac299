"""Company: what two robots try where one alone never got there, whatever the reason may be.

Rules of thumb that name no kitchen: what comes undone as soon as its robot leaves is attended by a helper; what never
comes about for a robot alone may do so while another one stands elsewhere, so the helper goes from place to place.
"""

from __future__ import annotations

from collections.abc import Sequence

from remac_agents.plan import Plan
from remac_agents.planning.whereabouts import Whereabouts, way_to
from remac_agents.roles import HandoverRequest
from remac_env.rules.scene import PublicScene
from remac_env.rules.subtasks import STEP_ASIDE, WAIT, Subtask


def attended(request: HandoverRequest) -> Plan | None:
    """The helper does what comes undone and stays there, but when the leading robot needs the place; None: not told
    where that is.
    """
    facts, step = request.view.scene, request.kept[0]
    where = Whereabouts(facts)
    place, way = where.of(step.target), way_to(step.target)
    if place is None:
        return None
    first = [way, step]
    lead, helper = list[Subtask](), list(first)
    main = _without(request.plan, step)
    last = max((i for i, each in enumerate(main) if each.moves and where.of(each.target) == place), default=-1)
    for index, each in enumerate(main):
        leaves = each.moves and where.station.get(request.lead) == place
        comes = each.moves and where.goal(request.lead, each) == place
        if comes or each.target == step.target:
            _until(lead, len(first))
        if comes or (leaves and index < last):
            _until(helper, len(lead))
            helper.append(STEP_ASIDE if comes else way)
        where.run(request.lead, each)
        lead.append(each)
    return Plan.of({request.lead: lead, request.helper: helper})


def accompanied(request: HandoverRequest) -> Plan | None:
    """Whenever the leading robot tries what never came about, the helper goes to one place after the other."""
    facts, where = request.view.scene, Whereabouts(request.view.scene)
    lead, helper = list[Subtask](), list[Subtask]()
    for step in request.plan:
        places = _elsewhere(step, where.station.get(request.lead), facts) if step in request.failing else []
        if places:
            _until(lead, len(helper) + 1)
            _until(helper, len(lead) - 1)
            helper += [*map(way_to, places), STEP_ASIDE]
        lead += [step] * max(1, len(places))
        where.run(request.lead, step)
    return Plan.of({request.lead: lead, request.helper: helper}) if helper else None


def _without(steps: Sequence[Subtask], step: Subtask) -> list[Subtask]:
    """The rest, without ways on which there was nothing else to do."""
    rest: list[Subtask] = []
    for each, following in zip(steps, [*steps[1:], None], strict=True):
        if each != step:
            rest.append(each)
        elif rest[-1:] == [way_to(step.target)] and (following is None or following.moves):
            rest.pop()
    return rest


def _elsewhere(step: Subtask, here: str | None, facts: PublicScene) -> list[str]:
    """What the skill could be about instead, of which a robot can stand at one place while another one stands here."""
    names = [name for name in facts.names(step.row.target) if name != step.target and name in facts.fixtures]  # type: ignore[arg-type]
    return [name for name in names if not any(facts.conflicting(here or "", at) for at in facts.stations_of(name))]


def _until(row: list[Subtask], length: int) -> None:
    """Wait until so many rounds are over."""
    row += [WAIT] * (length - len(row))
