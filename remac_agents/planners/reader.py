"""A floor: a planner that reads the goal sentence with common sense, plans once, and looks at nothing.

It knows what anybody knows who was never in this kitchen: what has a door is opened before anything goes in, and shut
before it runs; what is heated lies in a vessel. It reads the goal, the commands and what the verb implies, and
no state. A task that it solves asks no planner to check, to search or to learn.
"""

from __future__ import annotations

from collections.abc import Sequence

from remac_agents.plan import Commands, Plan
from remac_agents.planners.common_sense import vessels
from remac_agents.planners.sentence import SentenceReader
from remac_agents.planning.rewriting import tidy
from remac_agents.roles import PlanRequest
from remac_env.rules.subtasks import Subtask


class ReaderPlanner:
    """The steps of the sentence, with doors opened and vessels fetched as common sense has it. Rule-based."""

    needs_truth = needs_rules = False

    def plan(self, request: PlanRequest) -> Plan:
        """A row for the leading robot; empty when the sentence names nothing that can be done."""
        commands = Commands(request.commands)
        steps = SentenceReader(request.facts, commands, request.verbs).read(request.goal)
        steps = _in_vessels(steps, request.goal, commands)
        steps = _behind_doors(steps, commands)
        return Plan.of({request.lead: tidy(steps, request.facts)})


def _in_vessels(steps: Sequence[Subtask], goal: str, commands: Commands) -> list[Subtask]:
    """Where common sense wants a vessel and the sentence names none, it is fetched first, for the object to go into."""
    done: list[Subtask] = list(steps)
    for verb, place, vessel in vessels():
        onto, fetch = Subtask("place to", place), Subtask("pick up", vessel)
        wanted = goal.lower().startswith(f"{verb} ") and onto in done and fetch not in done
        if not wanted or not commands.allows(fetch) or not commands.allows(Subtask("place to", vessel)):
            continue
        into = {onto: Subtask("place to", vessel), Subtask("navigate to", place): Subtask("navigate to", vessel)}
        at = done.index(onto)
        done = [into.get(step, step) for step in done[: at + 1]] + done[at + 1 :]
        done = [Subtask("navigate to", vessel), fetch, Subtask("navigate to", place), onto, *done]
    return done


def _behind_doors(steps: Sequence[Subtask], commands: Commands) -> list[Subtask]:
    """Doors are opened with empty hands before anything goes in, and shut before what is behind them is switched on."""
    done: list[Subtask] = []
    for step in steps:
        shut, opened = Subtask("close door", step.target), Subtask("open door", step.target)
        if step.skill == "turn on" and commands.allows(shut) and shut not in done:
            done.append(shut)
        if step.skill == "place to" and commands.allows(opened) and opened not in done:
            done = [Subtask("navigate to", step.target), opened, *done]
        done.append(step)
    return done
