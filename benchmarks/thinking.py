"""What thinking costs a method that a model plans for: `python benchmarks/thinking.py`. No real model is asked.

A server on loopback stands in for one: it knows the truth, answers as the planner `timely` would, and says how many
tokens it wrote, drawn from `TOKENS` by the question's own text. The suite `timed`'s tasks by the event clock are played
with thinking at its five rates; then each episode is played again from its cassette, without the server.
"""

from __future__ import annotations

import json
import random
from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from itertools import product
from pathlib import Path
from statistics import mean
from tempfile import TemporaryDirectory
from threading import Thread
from typing import Any

from remac_bench.columns import show
from remac_bench.command import run_script
from remac_bench.flags import takes
from remac_bench.playing.job_lists import parse_names, parse_seeds
from rich.table import Table

import remac_agents
import remac_env
from remac_agents.planners.timely import TimelyPlanner
from remac_agents.roles import PlanRequest
from remac_env.events.clock import Span
from remac_env.rules.scene import public_scene

RATES = ("off", "tokens:10", "tokens:30", "tokens:100", "tokens:300")
"""Those of the suite `timed`: what fast, usual, slow and local models take for 1,000 tokens, s."""

TOKENS = {False: (400, 2500), True: (100, 900)}
"""Tokens of a plan and of a thought with one command: an assumption, as reasoning models write them."""

MAX_SECONDS = 1200.0
"""s on the clock, as in the suite."""


@dataclass
class Desk:
    """What the model that is stood in for looks at. `asked`: how many questions it has been put."""

    env: Any = None
    infos: Any = None
    asked: int = 0

    def answer(self, user: str) -> tuple[str, int]:
        """What it writes, and how many tokens."""
        self.asked += 1
        scene, acts = self.env.start.scene, "its next command" in user
        lead = user.split("Robot: ")[1].split(".")[0] if acts else scene.robots[-1]
        info = self.infos[lead]
        others = user.partition("The others are at:\n")[2] if acts else ""
        mates = [line.partition(": ") for line in others.splitlines()]
        request = PlanRequest(
            goal=info["goal"], scene="", facts=public_scene(scene), robots=(lead,) if acts else scene.robots,
            lead=lead, commands=tuple(info["commands"]), world=self.env.world, rules=scene, goal_test=self.env.goal,
            question="act" if acts else "plan", slow=info["processes"],
            teammates={name: text for name, _, text in mates if name in scene.robots},
        )  # fmt: skip
        plan = TimelyPlanner().plan(request)
        rows = getattr(plan, "rows", {lead: ()})
        said = {name: f"[{', '.join(step.text for step in row) or 'wait'}]" for name, row in rows.items()}
        text = f"Plan: {said[lead]}" if acts else "\n".join(f"{name}: {row}" for name, row in said.items())
        return text, random.Random(user).randint(*TOKENS[acts])


@contextmanager
def stand_in(desk: Desk) -> Iterator[str]:
    """The address of a server that speaks OpenAI's chat completions."""

    class Model(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            asked = json.loads(self.rfile.read(int(self.headers["content-length"])))
            text, tokens = desk.answer(asked["messages"][-1]["content"])
            usage = {"prompt_tokens": 1000, "completion_tokens": tokens, "total_tokens": 1000 + tokens}
            choice = {"index": 0, "message": {"role": "assistant", "content": text}, "finish_reason": "stop"}
            body = json.dumps({"model": "stand-in", "choices": [choice], "usage": usage}).encode()
            self.send_response(200)
            self.send_header("content-type", "application/json")
            self.send_header("content-length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, format: str, *args: Any) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Model)
    Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield f"http://127.0.0.1:{server.server_port}/v1"
    finally:
        server.shutdown()
        server.server_close()


@dataclass(frozen=True)
class Episode:
    """How one episode went, and whether it went the same from its cassette without a question."""

    success: bool
    seconds: float
    timeline: tuple[Span, ...] = field(repr=False)
    asked: int = 0
    same: bool = False


def play(desk: Desk, agent: Any, seed: int) -> Episode:
    """One episode in which thoughts cost what they do."""
    seen, desk.infos = desk.env.reset(seed=seed)
    agent.reset(seen, desk.infos)
    while desk.env.agents:
        tokens = agent.act(seen, desk.infos)
        for robot, thought in agent.thoughts().items():
            if desk.infos[robot]["ready"]:
                desk.env.note_thought(robot, thought)
        seen, _, _, _, desk.infos = desk.env.step(tokens)
    agent.close_episode(seen, desk.infos)
    told = next(iter(desk.infos.values()))
    return Episode(told["success"], told["seconds"], desk.env.timeline)


def episode(method: str, think: str, task: str, seed: int, cassette: Path) -> Episode:
    """One of two robots, by the server and then from the cassette."""
    desk = Desk(remac_env.parallel_env(
        task, robots=2, backend="symbolic", clock="events", think=think, max_seconds=MAX_SECONDS
    ))  # fmt: skip
    with stand_in(desk) as url:
        asks = {"planner": "custom:stand-in", "base_url": url, "cassette": cassette}
        first, asked = play(desk, remac_agents.make(method, **asks), seed), desk.asked
    again = play(desk, remac_agents.make(method, **asks, replay=True), seed)
    return Episode(first.success, first.seconds, first.timeline, asked, first == again and desk.asked == asked)


@takes("thinking.methods", "thinking.seeds", "script.tasks")
def main(*, methods: str, seeds: str, tasks: str | None) -> None:
    """Print five rows for each method."""
    kitchens = parse_names(tasks, "tasks") if tasks else [*remac_env.tasks()[:4], *_timed()]
    columns = ("method", "thinking", "n", "success", "makespan s", "thinks", "too late", "questions", "replayed")
    table = Table(*columns, title=f"Thinking of a model that is stood in for, seeds {seeds}")
    for method in parse_names(methods, "methods"):
        groups: dict[str, list[Episode]] = defaultdict(list)
        with TemporaryDirectory() as folder:
            for number, (think, task, seed) in enumerate(product(RATES, kitchens, parse_seeds(seeds))):
                groups[think].append(episode(method, think, task, seed, Path(folder) / f"{number}.jsonl"))
        for think, group in groups.items():
            table.add_row(method, think, *_row(group, groups[RATES[0]]))
    show(table)


def _timed() -> list[str]:
    return [name for name in remac_env.tasks("events") if name not in remac_env.tasks()]


def _row(group: Sequence[Episode], free: Sequence[Episode]) -> Iterator[str]:
    """`free`: the same without what thinking costs."""
    done = [each for each in group if each.success]
    late = [now.success for now, then in zip(group, free, strict=True) if then.success]
    thought = sum(span.ended - span.began for each in group for span in each.timeline if span.kind == "thought")
    yield from (str(len(group)), f"{len(done) / len(group):.0%}")
    yield f"{mean(each.seconds for each in done):.1f}" if done else ""
    yield f"{thought / sum(2 * each.seconds for each in group):.0%}"
    yield f"{1 - mean(late):.0%}" if late else ""
    yield str(sum(each.asked for each in group))
    yield f"{sum(each.same for each in group)} of {len(group)}"


if __name__ == "__main__":
    run_script(main)
