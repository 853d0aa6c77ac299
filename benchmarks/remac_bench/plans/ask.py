"""Asks a planner for one plan at the start of an episode, as a method would, and nothing more."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from typing import Any

import remac_agents
from remac_agents import Bounds, Memory, Plan, PlanError
from remac_agents.agent import Agent
from remac_agents.methods import Method
from remac_agents.roles import PreviousTry, Ran, StopEpisode
from remac_agents.running.asking import previous_try
from remac_agents.running.method_run import MethodRun, Turns
from remac_agents.text.printable import type_name, words
from remac_bench.asked import Asked
from remac_bench.entries import MESSAGE_MAX
from remac_bench.plans.judge import Judgement, judge
from remac_bench.playing.episodes import BlamedError, blaming
from remac_bench.redaction import redact
from remac_env.option_rows import rows, same
from remac_env.options import Options
from remac_env.oracle import certify


@dataclass(frozen=True, kw_only=True)
class Cell:
    """Where a plan is asked for: keywords of `remac_env.parallel_env` without the backend, and a seed."""

    task: str
    robots: int = same(Options, "robots", default=1)
    seed: int = 0
    starts: str = same(Options, "starts")
    wording: int = same(Options, "wording")
    style: str | None = same(Options, "style")
    layout: str | None = same(Options, "layout")
    naming: str = same(Options, "naming")
    text: str = same(Options, "text")

    @property
    def options(self) -> dict[str, Any]:
        """What the kitchen is made with."""
        return {name: getattr(self, name) for name in rows(Cell)}


@dataclass(frozen=True)
class Taught:
    """What an earlier iteration left behind: its first plan, how that went, and its reflections.

    `usage`: what it took; None where no language model was asked.
    """

    previous: PreviousTry
    reflections: tuple[str, ...]
    usage: Asked | None = None

    @property
    def plan(self) -> Mapping[str, tuple[str, ...]]:
        """Its first plan, robot -> commands."""
        return self.previous.plan

    def as_json(self) -> dict[str, Any]:
        """The same as values that json.dumps takes; `usage` only where there is one."""
        told = asdict(self)
        return told if self.usage is not None else {name: value for name, value in told.items() if name != "usage"}

    @classmethod
    def from_json(cls, told: Mapping[str, Any]) -> Taught:
        """What `as_json` made, read again."""
        previous = told["previous"]
        plan = {robot: tuple(row) for robot, row in previous["plan"].items()}
        ran = tuple(Ran(**each) for each in previous["ran"])
        usage = Asked.from_json(told.get("usage"))
        return cls(PreviousTry(plan, previous["success"], ran), tuple(told["reflections"]), usage)


def kitchen(cell: Cell) -> Any:
    """The cell's kitchen on the symbolic backend.

    Raises:
        UnknownNameError, OptionError: for names and numbers that are not valid.
    """
    import remac_env

    return remac_env.parallel_env(cell.task, backend="symbolic", **cell.options)


@lru_cache(maxsize=4096)
def optimum(cell: Cell) -> int | None:
    """Rounds of the shortest plan of a cell's start, None where none is known to be; its wording does not matter."""
    if cell.wording != 3 or cell.text != "plain":
        return optimum(replace(cell, wording=3, text="plain"))
    env = kitchen(cell)
    env.reset(seed=cell.seed)
    return certify(env.start.scene, env.world, env.goal).optimum


def judged(cell: Cell, planner: object, taught: Taught | None = None) -> Judgement:
    """Ask the planner for a plan for all robots of the cell, and judge it.

    Args:
        planner: a ready planner (`remac_agents.wiring.catalogue.make_role`). What it raises counts as an answer that
            is not a plan, and so does a budget that is spent.
        taught: what it is told of an earlier iteration.

    Raises:
        StopEpisode: where it could not answer for a reason that is not its own, such as an endpoint that is down.
    """
    env = kitchen(cell)
    plan, usage = ask(env, planner, cell.seed, taught)
    return replace(judge(env.start.scene, env.world, env.goal, plan, optimum(cell)), usage=usage)


def ask(env: Any, planner: object, seed: int, taught: Taught | None = None) -> tuple[Plan | PlanError, Asked | None]:
    """The planner's answer at the start of the episode, and what asking took; None where no language model was asked.

    An answer that is not a plan is sent back as in an episode.

    Raises:
        StopEpisode: see `judged`.
    """
    answers: list[Plan | PlanError] = []

    def ask_once(run: MethodRun) -> Turns:
        request = run.plan_request(tuple(run.briefing.robots))
        if taught is not None:
            told = {"previous": taught.previous, "previous_plan": taught.plan, "reflections": taught.reflections}
            request = replace(request, **told)  # type: ignore[arg-type]
        answers.append(run.answer_to(request))
        yield from ()

    roles = remac_agents.make("BASE", planner=planner).roles
    agent = Agent(Method(name="PLAN", run=ask_once), roles, memory=Memory(), bounds=Bounds())
    observations, infos = env.reset(seed=seed)
    _renew(planner)
    try:
        with blaming("agent"):
            agent.reset(observations, infos)
            agent.act(observations, infos)
    except BlamedError as fault:
        return no_plan(fault), None
    report = agent.report()
    if answers:
        return answers[0], _taken(report)
    if report.infrastructure is not None:
        raise StopEpisode(report.infrastructure, infrastructure=True)
    return PlanError(report.errors[-1] if report.errors else "the planner gave no answer"), _taken(report)


def no_plan(fault: BlamedError) -> PlanError:
    """What a planner raised, as the answer that it did not give."""
    return PlanError(f"{type_name(fault.error)}: {redact(words(fault.error))}"[:MESSAGE_MAX])


def _taken(report: Any) -> Asked | None:
    """What an episode took of language models; None where none was asked."""
    taken = Asked.of(report.usage, report.exchanges)
    return None if taken == Asked() else taken


def _renew(*roles: object) -> None:
    """Give models a whole budget: it bounds a plan, or a first iteration, as it bounds a job."""
    for role in roles:
        budget = getattr(getattr(role, "models", None), "budget", None)
        if budget is not None:
            budget.renew()


@lru_cache(maxsize=4096)
def teach(cell: Cell) -> Taught:
    """Play the first iteration with condition checks and rule-based roles, and keep what it wrote down.

    The lead works alone, whether there is a second robot or not: reflection comes before sharing.
    """
    return teach_by(cell, planner="literal", reflector="rule")


def teach_by(cell: Cell, *, planner: object, reflector: object) -> Taught:
    """The same with a planner and a reflector of one's own; conditions, checker and adjuster stay rules.

    Raises:
        StopEpisode: where a role could not go on for a reason that is not its own, such as an endpoint that is down.
        BlamedError: what a role raised.
    """
    env = kitchen(cell)
    agent = remac_agents.make("REMAC", planner=planner, reflector=reflector)  # its first iteration, one robot
    observations, infos = env.reset(seed=cell.seed)
    _renew(planner, reflector)
    with blaming("agent"):
        agent.reset(observations, infos)
        while env.agents:
            observations, _, _, _, infos = env.step(agent.act(observations, infos))
        agent.close_episode(observations, infos)
    report = agent.report()
    if report.infrastructure is not None:
        raise StopEpisode(report.infrastructure, infrastructure=True)
    (run,) = agent.memory.runs(cell.task)
    return Taught(previous_try(run), agent.memory.lessons(cell.task), _taken(report))
