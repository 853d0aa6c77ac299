"""What the literal planner makes of being told that a step failed: the repairs of the rule adjuster.

For them it needs the rules. It cannot look; it knows what it did, what each gripper feels and which conditions it was
told are false.
"""

from __future__ import annotations

from remac_agents.adjusters.rule import RuleAdjuster
from remac_agents.plan import Plan
from remac_agents.planning.rewriting import Steps, tidy
from remac_agents.planning.whereabouts import Whereabouts, hands
from remac_agents.roles import AdjustRequest, Attempt, PlanRequest, View
from remac_env.rules.conditions import Condition
from remac_env.rules.subtasks import Subtask


class Belief:
    """What a planner knows from its own steps."""

    def __init__(self, request: PlanRequest) -> None:
        self._request = request
        self.where = Whereabouts(request.facts)
        self.robot = request.lead
        self.executed: list[Subtask] = []
        self._support: dict[str, str] = {}

    def run(self, attempt: Attempt) -> None:
        """A step was run; one that failed changes nothing that is known."""
        if attempt.succeeded is False:
            return
        step, held = attempt.subtask, self.where.hand.get(self.robot)
        if step.row.takes:
            self._support.pop(step.target, None)
        elif step.row.puts and held is not None:
            self._support[held] = step.target
        self.where.run(self.robot, step)
        self.executed.append(step)

    def true(self, condition: Condition) -> bool:
        """Whether it is known to be true; room is taken for granted."""
        arguments = condition.args
        if condition.predicate == "at":
            return self.where.is_at(self.robot, arguments[1])
        if condition.predicate == "directly_on":
            return self._support.get(arguments[0]) == arguments[1]
        if condition.predicate == "inside":
            return self._inside(*arguments)
        return condition.predicate == "room"

    def _inside(self, obj: str, container: str) -> bool:
        seen: set[str] = set()
        while obj in self._support and obj not in seen:
            seen.add(obj)
            obj = self._support[obj]
            if obj == container:
                return True
        return False

    def mend(self, steps: Steps, false: tuple[Condition, ...], held: str | None) -> Steps:
        """The steps, repaired; as they are where no rule helps."""
        request = self._request
        if not steps or not false or request.rules is None:
            return steps
        advice = RuleAdjuster().adjust(
            AdjustRequest(
                failed=false,
                subtask=steps[0],
                robot=self.robot,
                plan=Plan.of({self.robot: steps}),
                executed=tuple(self.executed),
                commands=request.commands,
                view=View(request.goal, request.facts, {self.robot: held}, rules=request.rules),
                ask=self.true,
            )
        )
        return steps if advice.row is None else list(advice.row)


def next_steps(steps: Steps, request: PlanRequest) -> Steps:
    """What is left of a plan that is asked for step by step, after what was run and refused so far."""
    belief = Belief(request)
    for attempt in request.history:
        if not attempt.ran:
            left = steps if steps[:1] == [attempt.subtask] else [attempt.subtask, *steps]
            steps = belief.mend(left, attempt.false, belief.where.hand.get(belief.robot))
            continue
        belief.run(attempt)
        if steps[:1] == [attempt.subtask] and attempt.succeeded is not False:
            steps = steps[1:]
    return steps


def corrected(steps: Steps, request: PlanRequest) -> Steps:
    """The plan from the step at fault on, from the present state; the whole plan where no step is at fault."""
    belief, history = Belief(request), request.history
    for attempt in history:
        belief.run(attempt)
    faults = [index for index, attempt in enumerate(history) if attempt.false]
    faults += [index for index, attempt in enumerate(history) if attempt.succeeded is False]
    if not faults:
        return steps
    fault = faults[0]
    run = [attempt.subtask for attempt in history]
    redo = [run[fault]] + [a.subtask for a in history[fault + 1 :] if not (_lasts(a) and a.succeeded)]
    wanted, held = hands(run)[fault], request.holding.get(request.lead)
    ready: Steps = []
    if wanted is not None and held != wanted:
        ready = [Subtask("navigate to", wanted), Subtask("pick up", wanted)]
    place = next((step for step in run[:fault][::-1] if step.skill == "navigate to"), None)
    if place is not None and redo[0].skill != "navigate to":
        here = belief.where.is_at(belief.robot, place.target)
        ready += [] if here and not ready else [place]
    mended = belief.mend(redo, history[fault].false, wanted)
    return tidy([*ready, *mended], request.facts)


def _lasts(attempt: Attempt) -> bool:
    return attempt.subtask.row.lasting
