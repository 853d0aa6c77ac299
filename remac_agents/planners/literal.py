"""The literal planner: it follows the words of the goal sentence in their order, and what it was taught.

It knows no hidden constraint. It is no language model and is never presented as one.
"""

from __future__ import annotations

from remac_agents.lessons import read_lesson
from remac_agents.plan import Commands, Plan
from remac_agents.planners.mending import corrected, next_steps
from remac_agents.planners.rewriting import apply, tidy
from remac_agents.planners.sentence import SentenceReader
from remac_agents.roles import PlanRequest


class LiteralPlanner:
    """Reads the sentence, then lets each reflection that it can read rewrite the plan, oldest first."""

    needs_truth = False

    def plan(self, request: PlanRequest) -> Plan:
        """A row for the leading robot; empty when the sentence names nothing that can be done.

        Told that steps failed, and why, it goes on from there by the rules of `mending`.
        """
        commands = Commands(request.commands)
        reader = SentenceReader(request.facts, commands, request.verbs)
        steps = tidy(reader.read(request.goal), request.facts)
        for text in request.reflections:
            lesson = read_lesson(text, commands)
            if lesson is not None:
                steps = tidy(apply(steps, lesson), request.facts)
        if request.single_step:
            steps = next_steps(steps, request)
        elif request.explanation:
            steps = corrected(steps, request)
        return Plan.of({request.lead: steps})
