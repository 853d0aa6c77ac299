"""ReAct: each robot by itself, asked for its next command whenever it is ready. The method made for the event clock.

After Yao et al., "ReAct: Synergizing Reasoning and Acting in Language Models" (2023, arXiv 2210.03629), a robot each as
in PARTNR (2024): thought, command, result, and the next thought. Nobody plans ahead, and nobody plans for another
robot; each is told what the others are at. With rounds all robots are asked in every round.
"""

from __future__ import annotations

from remac_agents.running.acting import Acting
from remac_agents.running.method_run import MethodRun, Turns


def react(run: MethodRun) -> Turns:
    """Ask for the robots that are ready, one after the other, until each has said that it is done."""
    acting = Acting(run)
    while not acting.over:
        yield acting.decide()
        acting.note_outcomes()
