"""What methods take of language models, as measured (model_costs.toml), and what that costs with a model."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from remac_agents.llm import Model

FILE = Path(__file__).parents[1] / "model_costs.toml"


@dataclass(frozen=True)
class Need:
    """What an episode takes, a mean: calls, tokens of prompts with their pictures, of answers without thoughts."""

    calls: float = 0.0
    prompt: float = 0.0
    completion: float = 0.0

    def __add__(self, other: Need) -> Need:
        return Need(self.calls + other.calls, self.prompt + other.prompt, self.completion + other.completion)

    def times(self, factor: float) -> Need:
        """So many episodes."""
        return Need(self.calls * factor, self.prompt * factor, self.completion * factor)

    def answers(self, model: Model) -> float:
        """Tokens of answers with what the model thinks."""
        return self.completion + self.calls * model.reasoning_tokens

    def money(self, model: Model) -> float | None:
        """US dollars by the model's list price; None where that is not known."""
        return model.money(round(self.prompt), round(self.answers(model)))


@dataclass(frozen=True)
class Costs:
    """Method -> task -> role -> what an episode takes."""

    needs: Mapping[str, Mapping[str, Mapping[str, Need]]]
    command: str = ""

    def of(self, method: str, task: str) -> Mapping[str, Need] | None:
        """Role -> what an episode takes; the mean over all tasks for a task that was not measured; None: unknown."""
        tasks = self.needs.get(method)
        if not tasks:
            return None
        if task in tasks:
            return tasks[task]
        mean: dict[str, Need] = {}
        for each in tasks.values():
            for role, need in each.items():
                mean[role] = mean.get(role, Need()) + need.times(1 / len(tasks))
        return mean

    def whole(self, method: str, task: str, *, images: bool) -> Need | None:
        """An episode with a model in every role that it can fill: the checker only where it takes pictures."""
        roles = self.of(method, task)
        if roles is None:
            return None
        return sum((need for role, need in roles.items() if images or role != "checker"), Need())


@cache
def measured() -> Costs:
    """The table that comes with the benchmark; an empty one where there is none."""
    if not FILE.is_file():
        return Costs({})
    data = tomllib.loads(FILE.read_text("utf-8"))
    needs = {
        method: {task: {role: Need(*numbers) for role, numbers in roles.items()} for task, roles in tasks.items()}
        for method, tasks in data["needs"].items()
    }
    return Costs(needs, data.get("command", ""))
