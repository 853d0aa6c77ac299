"""What methods ask of language models, measured without one.

Every role is played by its offline rule, so that an episode goes as it does offline; beside it the role that is a
language model puts its real questions to a `Meter`, which answers what the rule did and counts. Nothing is sent.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy

import remac_agents
from remac_agents.llm import Budget, Cassette, ChatReply
from remac_agents.llm.request import CHARACTERS_PER_TOKEN, TOKENS_PER_PICTURE
from remac_agents.plan import Plan
from remac_agents.prompting import wording
from remac_agents.prompting.models import Models
from remac_agents.roles import AdjustRequest, Advice, HandoverRequest, PlanRequest, ReflectRequest, Verdict, View
from remac_agents.wiring.catalogue import MODEL_ROLES, make_role
from remac_agents.wiring.filling import DEFAULTS
from remac_bench.playing import agents
from remac_bench.preflight.estimates import Need
from remac_env.rules.conditions import Condition

MODEL = "openai:gpt-4o"
"""Whose questions are counted: it takes pictures. None is sent."""

_TOKENS_PER_MESSAGE = 8
_NUMBERED = re.compile(r"^\s*\d+\. (.*)$", re.M)


class Meter(Cassette):
    """In place of an endpoint: says what it is to say, and counts by role."""

    def __init__(self) -> None:
        self.needs: dict[str, Need] = defaultdict(Need)
        self._answers: list[str | Callable[[str], str]] = []
        self._silent = 0

    def says(self, *answers: str | Callable[[str], str]) -> None:
        """The answers to the next questions; the last one is repeated. A function is given the question."""
        self._answers = list(answers)

    @property
    def silent(self) -> bool:
        """Whether rules are at work that a model would not ask for."""
        return self._silent > 0

    @contextmanager
    def silence(self) -> Iterator[None]:
        """Nothing is asked inside."""
        self._silent += 1
        try:
            yield
        finally:
            self._silent -= 1

    def play(self, canonical: Mapping[str, Any]) -> ChatReply:
        """The next answer."""
        said = self._answers.pop(0) if len(self._answers) > 1 else self._answers[0]
        prompt = [text for _, text in canonical["messages"]]
        text = said if isinstance(said, str) else said(prompt[-1])
        pictures = TOKENS_PER_PICTURE * len(canonical["images"])
        counted = int(sum(map(len, prompt)) / CHARACTERS_PER_TOKEN) + _TOKENS_PER_MESSAGE * len(prompt) + pictures
        answered = int(len(text) / CHARACTERS_PER_TOKEN) + 1
        role = str(canonical["label"]).split("/")[-2]
        self.needs[role] = self.needs[role] + Need(1, counted, answered)
        return ChatReply(text=text, tokens_in=counted, tokens_out=answered, money=0.0)


class Shadow:
    """A role's rule, beside which the role that is a model asks."""

    def __init__(self, role: str, models: Models, meter: Meter) -> None:
        self.rule = make_role(role, DEFAULTS[role])
        self.model = make_role(role, MODEL, models=models)
        self.models, self.meter = models, meter
        self.needs_truth = bool(getattr(self.rule, "needs_truth", False))
        self.needs_rules = bool(getattr(self.rule, "needs_rules", False))

    def asks(self, verb: str, *given: Any, says: Sequence[str | Callable[[str], str]]) -> None:
        """Let the model ask, and answer so."""
        if not self.meter.silent:
            self.meter.says(*says)
            getattr(self.model, verb)(*given)


class ShadowPlanner(Shadow):
    """See Shadow."""

    def plan(self, request: PlanRequest) -> Any:
        """The rule's plan, or its answer to a stage of SMART-LLM."""
        made = self.rule.plan(request)
        if not isinstance(made, Plan):
            self.asks("plan", request, says=[json.dumps(made)])
            return made
        rows = {robot: list(row) for robot, row in made.as_text().items()}
        first = next(iter(rows.values()), [])
        text = f"Plan: [{', '.join(first)}]" if len(request.robots) == 1 else json.dumps({"plan": rows})
        self.asks("plan", request, says=[text])
        return made


class ShadowConditions(Shadow):
    """See Shadow."""

    def before(self, subtask: Any, robot: str, view: View) -> list[Condition]:
        """The rule's conditions."""
        return self._found("before", subtask, robot, view)

    def after(self, subtask: Any, robot: str, view: View) -> list[Condition]:
        """The rule's conditions."""
        return self._found("after", subtask, robot, view)

    def _found(self, verb: str, subtask: Any, robot: str, view: View) -> list[Condition]:
        found: list[Condition] = getattr(self.rule, verb)(subtask, robot, view)
        told = json.dumps({"conditions": [condition.sentence for condition in found]})
        self.asks(verb, subtask, robot, view, says=[told])
        return found


class ShadowChecker(Shadow):
    """See Shadow; the pictures are made up, one for every world, and count as real ones do."""

    def check(self, conditions: Sequence[Condition], view: View) -> list[Verdict]:
        """The truth."""
        found: list[Verdict] = self.rule.check(conditions, view)
        shown = replace(view, images={robot: _pictures(view, robot) for robot in view.scene.robots}, world=None)

        values = {verdict.condition.sentence: verdict.value for verdict in found}

        def verdicts(question: str) -> str:
            asked = _NUMBERED.findall(question)
            told = [values.get(sentence.strip()) for sentence in asked]
            return json.dumps({"verdicts": told, "reasons": ["it can be seen in the picture"] * len(asked)})

        self.asks("check", conditions, shown, says=[verdicts])
        return found


class ShadowAdjuster(Shadow):
    """See Shadow."""

    def adjust(self, request: AdjustRequest) -> Advice:
        """The rule's advice; what the rule asks the checker for it is not counted, a model decides without."""
        with self.meter.silence():
            advice: Advice = self.rule.adjust(request)
        steps = [step.text for step in advice.next_steps]
        old = request.plan.row(request.robot)
        row = [step.text for step in (advice.row if advice.row is not None else (*advice.next_steps, *old))]
        analysis = json.dumps({"reason": advice.reason, "next_steps": steps})
        self.asks("adjust", request, says=[analysis, f"Plan: [{', '.join(row)}]"])
        return advice


class ShadowReflector(Shadow):
    """See Shadow."""

    def reflect(self, request: ReflectRequest) -> list[str]:
        """The rule's lessons."""
        lessons: list[str] = self.rule.reflect(request)
        told = " ".join(lessons) or request.advice.reason
        answer = {"reason": request.advice.reason, "avoid": told, "remedy": told}
        self.asks("reflect", request, says=[json.dumps(answer)])
        return lessons

    def review(self, lessons: Sequence[str], *, success: bool) -> list[str]:
        """As the rule does."""
        return list(self.rule.review(lessons, success=success))


class ShadowSummariser(Shadow):
    """See Shadow."""

    def summarise(self, goal: str, steps: Sequence[Any]) -> Any:
        """The rule's summary."""
        summary = self.rule.summarise(goal, steps)
        told = json.dumps({"events": list(summary.events), "subgoals": list(summary.subgoals)})
        self.asks("summarise", goal, steps, says=[told])
        return summary

    def explain(self, request: Any) -> Any:
        """The rule's explanation."""
        with self.meter.silence():
            found = self.rule.explain(request)
        step = None if found.step is None else found.step + 1
        self.asks("explain", request, says=[json.dumps({"reason": found.reason, "step": step})])
        return found


class ShadowHandover(Shadow):
    """See Shadow."""

    def share(self, request: HandoverRequest) -> Plan | None:
        """The rule's rows for both, or none."""
        shared: Plan | None = self.rule.share(request)
        told = "alone" if shared is None else wording.rows(shared.as_text())
        self.asks("share", request, says=[told])
        return shared


SHADOWS: dict[str, type[Shadow]] = {
    "planner": ShadowPlanner,
    "conditions": ShadowConditions,
    "checker": ShadowChecker,
    "adjuster": ShadowAdjuster,
    "reflector": ShadowReflector,
    "handover": ShadowHandover,
    "summariser": ShadowSummariser,
}


def measure(method: str, task: str, *, seeds: Sequence[int], backend: str = "symbolic") -> dict[str, Need]:
    """Role -> what an episode takes of a language model in it: a mean over the seeds and the iterations of a job.

    Raises:
        RuntimeError: if a question got an answer that its role could not read, so that too many would be counted.
    """
    import remac_env

    meter = Meter()
    robots, iterations = agents.default_robots(method), agents.default_iterations(method)
    env = remac_env.parallel_env(task, backend=backend, robots=robots)
    for seed in seeds:
        models = Models(budget=Budget(), cassette=meter)
        roles: Any = {role: SHADOWS[role](role, models, meter) for role in MODEL_ROLES}
        agent = remac_agents.make(method, **roles)
        for _ in range(iterations + 1):
            _play(env, agent, seed)
            unread = [told for told in models.page.errors if told.partition(":")[0] in MODEL_ROLES]
            if unread:
                raise RuntimeError(f"{method}, {task}, seed {seed}: an answer was not read: {unread[0]}")
    env.close()
    episodes = len(seeds) * (iterations + 1)
    return {role: meter.needs[role].times(1 / episodes) for role in MODEL_ROLES if meter.needs[role].calls}


def _play(env: Any, agent: Any, seed: int) -> None:
    observations, infos = env.reset(seed=seed)
    agent.reset(observations, infos)
    while env.agents:
        observations, _, _, _, infos = env.step(agent.act(observations, infos))
    agent.close_episode(observations, infos)


def _pictures(view: View, robot: str) -> dict[str, Any]:
    """Two pictures, equal in equal worlds."""
    made = {}
    for camera in ("side", "wrist"):
        seen = hashlib.sha256(f"{camera} {robot} {view.world!r}".encode()).digest()
        made[camera] = numpy.frombuffer(seen[:27], dtype=numpy.uint8).reshape(3, 3, 3).copy()
    return made
