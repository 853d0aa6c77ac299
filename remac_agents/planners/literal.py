"""The literal planner: it follows the words of the goal sentence in their order, and what it was taught.

It knows no hidden constraint. It is not a language model and is never presented as one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from remac_agents.plan import Commands, Plan
from remac_agents.planners.dividing import allocated, decomposed
from remac_agents.planners.mending import corrected, next_steps
from remac_agents.planners.sentence import SentenceReader
from remac_agents.planning.exploring import explored, planned_before
from remac_agents.planning.lessons import read_lesson
from remac_agents.planning.rewriting import apply, tidy
from remac_agents.planning.teamwork import parts_of, share_out
from remac_agents.roles import PlanRequest
from remac_env.rules.subtasks import DONE, WAIT, Subtask


class LiteralPlanner:
    """Reads the sentence, then lets each reflection that it can read rewrite the plan, oldest first.

    Args:
        mends: it is going to be told why steps failed, and needs the rules to make something of it.
        explores: where a command failed every time in the iteration before, it tries something else around it.
    """

    needs_truth = False
    needs_rules = False  # these two also for planners made from this one that set up nothing
    _explores = False

    def __init__(self, *, mends: bool = False, explores: bool = False) -> None:
        self.needs_rules, self._explores = mends, explores

    def plan(self, request: PlanRequest) -> Plan | dict[str, Any]:
        """A row for the leading robot; empty when the sentence names nothing that can be done.

        Where several robots are to be planned for, what is independent by its words is shared out between them: the
        leading one keeps the chain around its object, another one works a switch. Told that steps failed, and why, it
        goes on from there by the rules of `mending`. SMART-LLM's questions are answered by the rules of `dividing`.
        """
        if request.question == "allocate":
            return allocated(request)
        commands = Commands(request.commands)
        reader = SentenceReader(request.facts, commands, request.verbs)
        steps = tidy(reader.read(request.goal), request.facts)
        if self._explores:
            steps = tidy(explored(steps, request), request.facts)
        for text in request.reflections:
            lesson = read_lesson(text, commands)
            if lesson is not None:
                steps = tidy(apply(steps, lesson), request.facts)
        if request.question == "decompose":
            return decomposed(steps, request)
        if request.question == "act":
            return Plan.of({request.lead: self._acting(steps, request)})
        if request.single_step:
            steps = next_steps(steps, request)
        elif request.explanation:
            steps = corrected(steps, request)
        elif len(request.robots) > 1:
            return self._shared(steps, request)
        return Plan.of({request.lead: steps})

    def _acting(self, steps: Sequence[Subtask], request: PlanRequest) -> list[Subtask]:
        """What a robot of a team does next: its own part of the work, which is shared out as all would do it.

        What has just failed is tried again once a teammate has done something.
        """
        row = share_out(parts_of(steps, fine=True), sorted(request.facts.robots), request.facts, places=False)
        left = next_steps([step for step in row.row(request.lead) if step != WAIT], request)
        failed = bool(request.history) and request.history[-1].succeeded is False
        busy = any(command != WAIT.text for command in request.teammates.values())
        return [WAIT, *left] if failed and busy and left else left or [DONE]

    def _shared(self, steps: Sequence[Subtask], request: PlanRequest) -> Plan:
        """The steps shared out; what has worked for these robots is not shared out anew."""
        if self._explores and request.previous is not None and request.previous.success:
            return Plan.of(planned_before(request.previous, Commands(request.commands)))
        names = sorted(request.robots, key=lambda robot: robot != request.lead)
        return share_out(parts_of(steps, fine=True), names, request.facts, places=False)
