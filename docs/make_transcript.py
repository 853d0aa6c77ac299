"""Writes docs/transcript.md: one job of REMAC with every prompt that a model in every role gets.

    python docs/make_transcript.py

Nobody is asked: each role is played by its offline rule, and the model's answer is what the rule did.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from remac_bench.preflight.measuring import SHADOWS, Meter

import remac_agents
import remac_env
from remac_agents.llm import Budget
from remac_agents.prompting.models import Models
from remac_agents.prompting.prompt import load, names
from remac_agents.report import Exchange
from remac_agents.wiring.catalogue import MODEL_ROLES

PAGE = Path(__file__).parent / "transcript.md"
TASK, SEED, ITERATIONS = "OpenMicrowavePnP", 0, 3

HEAD = f"""# What a model sees

One job of REMAC on {TASK}, seed {SEED}: three iterations - alone, alone with what was learnt, as a team - with
every question that a model in every role is asked, in the order in which they are asked. Written by
`python docs/make_transcript.py`; no model was asked. Each role is played by its offline rule, and the answer that
stands under a question is what the rule did, in the form in which a model would say it. Pictures are left out: a
checker is shown the side and wrist cameras of the robots, 512 pixels each.

A question that was answered in this episode already is not put again, so that there are fewer of them than steps.
"""


def main() -> None:
    """Play the job and write the page."""
    argparse.ArgumentParser(description=f"Plays {TASK} with REMAC; writes {PAGE.name} beside this file.").parse_args()
    meter = Meter()
    models = Models(budget=Budget(), cassette=meter)
    roles: Any = {role: SHADOWS[role](role, models, meter) for role in MODEL_ROLES}
    agent = remac_agents.make("REMAC", **roles)
    env = remac_env.parallel_env(TASK, backend="symbolic", robots=2)
    parts, asked = [], []
    for iteration in range(ITERATIONS):
        observations, infos = env.reset(seed=SEED)
        agent.reset(observations, infos)
        while env.agents:
            observations, _, _, _, infos = env.step(agent.act(observations, infos))
        agent.close_episode(observations, infos)
        asked += models.exchanges
        parts.append(_iteration(iteration, agent.report(), models.exchanges))
    env.close()
    PAGE.write_text("\n".join([HEAD, _systems(asked), *parts]), "utf-8")


def _systems(asked: Sequence[Exchange]) -> str:
    """The system part of each prompt, once."""
    used = {_name(exchange): exchange.messages[0][1] for exchange in reversed(asked)}
    lines = ["## The system part of each prompt", ""]
    for name in dict.fromkeys(_name(exchange) for exchange in asked):
        lines += [f"### {name}", "", "```text", used[name].strip(), "```", ""]
    return "\n".join(lines)


def _iteration(number: int, report: Any, exchanges: Sequence[Exchange]) -> str:
    ended = "reached the goal" if report.success else "did not reach the goal"
    lines = [f"## Iteration {number}: {ended}, {len(exchanges)} questions", ""]
    for at, exchange in enumerate(exchanges, start=1):
        lines += [f"### {number}.{at} {_name(exchange)}, after {exchange.round} rounds", ""]
        lines += ["```text", exchange.messages[1][1].strip(), "```", "", "Answer:", ""]
        for role, text in exchange.messages[2:]:
            lines += [f"({role})", "", "```text", text.strip(), "```", ""]
        lines += ["```text", exchange.reply.strip(), "```", ""]
    return "\n".join(lines)


def _name(exchange: Exchange) -> str:
    """Which prompt a question comes from: the one whose system part begins as its own."""
    system = exchange.messages[0][1]
    return next(name for name in names() if load(name).system[:120] == system[:120])


if __name__ == "__main__":
    main()
