"""A floor: a planner that knows one plan a task by heart. `benchmarks/fit_memorised.py` chose them on other seeds.

It reads the goal sentence, finds the task whose sentence it is, and answers with its plan, whatever the kitchen. Of
generated tasks it knows one plan for each template and number of objects (`benchmarks/fit_generated.py`): the longest
sentence whose clauses are all in the goal says which, and the objects that the goal means are put in in their order.
"""

from __future__ import annotations

import re
import tomllib
from functools import lru_cache
from importlib import resources

from remac_agents.plan import Commands, Plan
from remac_agents.planners.common_sense import members
from remac_agents.roles import PlanRequest
from remac_env.rules.scene import PublicScene
from remac_env.rules.subtasks import Subtask

FILE = "memorised.toml"
GENERATED = "memorised_generated.toml"

_FIELD = re.compile(r"\\\{([a-z_]+)\\\}")


class MemorisedPlanner:
    """One fixed plan a task, with the goal's own nouns put in. Rule-based."""

    needs_truth = needs_rules = False

    def plan(self, request: PlanRequest) -> Plan:
        """A row for the leading robot; empty for a goal that it has not learnt."""
        commands = Commands(request.commands)
        for sentence, row in _learnt():
            match = pattern(sentence).match(request.goal)
            if match is not None:
                steps = [commands.parse(text.format(**match.groupdict())) for text in row]
                return Plan.of({request.lead: [step for step in steps if isinstance(step, Subtask)]})
        meant = denoted(request.goal, request.facts)
        row = recalled(_generated(), clauses(request.goal), len(meant))
        steps = [commands.parse(text.format(*meant)) for text in row]
        return Plan.of({request.lead: [step for step in steps if isinstance(step, Subtask)]})


def denoted(goal: str, facts: PublicScene) -> tuple[str, ...]:
    """The objects that the words for kinds in a goal sentence mean, in the order of the words and of the kitchen."""
    words = re.findall(r"[a-z]+", goal.lower())
    return tuple(dict.fromkeys(name for word in words for name in members(f"every {word}", facts)))


def clauses(goal: str) -> str:
    """A goal sentence with commas alone between its clauses."""
    return goal.replace(" and ", ", ")


Known = tuple[tuple[str, int, tuple[str, ...]], ...]


def recalled(known: Known, goal: str, size: int) -> tuple[str, ...]:
    """The plan of the longest sentence whose clauses the goal has, for so many objects; else for the next fewer."""
    asked = set(goal.split(", "))
    fitting = [(len(said), n, row) for said, n, row in known if asked.issuperset(said.split(", ")) and n <= size]
    return max(fitting, key=lambda entry: entry[:2])[2] if fitting else ()


def templated(row: list[str], nouns: dict[str, str]) -> list[str]:
    """Commands with `{role}` in place of the role's noun; the inverse of what the planner does."""
    for role, noun in nouns.items():
        row = [re.sub(rf"\b{re.escape(noun)}\b", f"{{{role}}}", text) for text in row]
    return row


def pattern(sentence: str) -> re.Pattern[str]:
    """A goal sentence with `{role}` fields as an expression that finds the roles' nouns."""
    return re.compile("^" + _FIELD.sub(r"(?P<\1>.+?)", re.escape(sentence)) + "$")


@lru_cache(maxsize=1)
def _learnt() -> tuple[tuple[str, tuple[str, ...]], ...]:
    """(goal sentence, commands), both with `{role}` fields; a task has one entry for each wording of its goal."""
    data = tomllib.loads(resources.files("remac_agents").joinpath("planners", FILE).read_text("utf-8"))
    return tuple((sentence, tuple(entry["plan"])) for entry in data["task"] for sentence in entry["sentences"])


@lru_cache(maxsize=1)
def _generated() -> Known:
    """(clauses of the goal sentence, number of objects, commands with fields for them by their numbers)."""
    data = tomllib.loads(resources.files("remac_agents").joinpath("planners", GENERATED).read_text("utf-8"))
    return tuple((row["sentence"], row["objects"], tuple(row["plan"])) for row in data["template"])
