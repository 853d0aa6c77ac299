"""Kitchens as an Inspect AI task: a model acts by a tool, round by round, and its plans go on our leaderboard as well.

    inspect eval examples/inspect/kitchen.py --model openai/gpt-4o -T task=HeatOnStove -T seeds=10
    remac bench run --planner answers:runs/inspect.json --methods BASE --robots 1 --seeds 0:10 --out runs/inspect

The first command leaves Inspect's log and what the model did, in runs/inspect.json. The second plays that again, which
is the same episode, and so makes records of it.
"""

import json
from pathlib import Path

from inspect_ai import Task, task
from inspect_ai.dataset import Sample
from inspect_ai.scorer import Score, accuracy, scorer, stderr
from inspect_ai.solver import solver
from inspect_ai.tool import tool

import remac_env

PLANS = Path("runs/inspect.json")
HOW = "\nPlay with the tool `act`, one command a round, until the goal is reached."


class Kitchen:
    """One robot in a kitchen, told by texts; `plan`: what it has done."""

    def __init__(self, name, seed, backend):
        self.env = remac_env.parallel_env(name, robots=1, backend=backend)
        _, infos = self.env.reset(seed=seed)
        self.info, self.plan = infos["robot_0"], []

    def act(self, command):
        if not self.env.agents:
            return f"The episode is over: {self.info['end']}."
        if command not in self.info["commands"]:
            return f"{command!r} is no command here; the commands are: {', '.join(self.info['commands'])}."
        self.info = self.env.step({"robot_0": self.info["commands"][command]})[4]["robot_0"]
        self.plan.append(command)
        outcome = self.info["outcome"]
        return f"{outcome['status']} {outcome['reason']} {self.info['end']}".strip()


@tool
def act(kitchen):
    async def execute(command: str):
        """Play one round.

        Args:
            command: one of the commands, such as "navigate to sink".
        """
        return kitchen.act(command)

    return execute


@solver
def play(backend):
    async def solve(state, generate):
        kitchen = Kitchen(state.metadata["task"], state.metadata["seed"], backend)
        state.user_prompt.text, state.tools = kitchen.info["text"] + HOW, [act(kitchen)]
        state = await generate(state, tool_calls="loop")
        state.metadata |= {"end": kitchen.info["end"], "plan": kitchen.plan}
        kitchen.env.close()
        return state

    return solve


@scorer(metrics=[accuracy(), stderr()])
def reached():
    async def score(state, target):
        plans = json.loads(PLANS.read_text()) if PLANS.exists() else {}
        PLANS.parent.mkdir(exist_ok=True)
        key = f"{state.metadata['task']}/{state.metadata['seed']}"
        PLANS.write_text(json.dumps(plans | {key: state.metadata["plan"]}, indent=1))
        return Score(value=state.metadata["end"] == "success", explanation=f"{state.metadata['end']}: {key}")

    return score


@task
def remac(task="OpenCabinetPnP", seeds=10, backend="symbolic"):
    cells = [{"task": task, "seed": seed} for seed in range(seeds)]
    samples = [Sample(id=f"{task}-{seed['seed']}", input=task, metadata=seed) for seed in cells]
    return Task(dataset=samples, solver=play(backend), scorer=reached(), message_limit=100)
