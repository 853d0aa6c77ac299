"""One self-sufficient JSON line an episode. Every table is computed from these alone."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator

SCHEMA = 1
"""Raised whenever the meaning of a field changes; fields may be added without."""


class Model(BaseModel):
    """Unknown fields are ignored, so that records of a later version with added fields stay readable. Numbers are
    finite: one that is none cannot be counted, drawn or compared."""

    model_config = ConfigDict(
        frozen=True, extra="ignore", populate_by_name=True, protected_namespaces=(), allow_inf_nan=False
    )


class OutcomeEntry(Model):
    """How one robot's `subtask` of one round ended: `status`, and for a failure its `reason` and `detail`.

    `seconds` is simulated time. `began`, `ended`: on the kitchen's clock, s since the start; None in records from
    before they were kept.
    """

    subtask: str
    status: str
    reason: str | None = None
    detail: str = ""
    seconds: float = 0.0
    began: float | None = None
    ended: float | None = None


class OrderEntry(Model):
    """What a robot was told that had to decide: its `command`, and what went into it.

    `tokens`, `seconds`: what language models wrote and took; `declared`: seconds that other roles say they take.
    """

    command: str
    tokens: int = 0
    seconds: float = 0.0
    declared: float = 0.0


class SpanEntry(Model):
    """Something that lasted from `began` to `ended`, s on the kitchen's clock.

    `kind`: subtask, wait, thought or process; `who`: the robot, or what a process is about; `what`: the command, or the
    process; `status` "cut": the episode was over first; `reason`: of a failure.
    """

    who: str
    kind: str
    what: str
    began: float
    ended: float
    status: str = "success"
    reason: str | None = None


class CheckEntry(Model):
    """A checker's verdict on one condition beside the truth (None where the kitchen did not tell it).

    `condition` is the sentence, of the `subtask` of a `robot`. `verdict` None: the checker cannot tell; `truth`
    likewise. `round` counts the rounds played before it; `asked` marks a question of the adjuster's; `reason` is the
    checker's own, if any; `unmatched` marks a model's words that no predicate says.
    """

    round: int
    robot: str
    subtask: str
    condition: str
    verdict: bool | None
    truth: bool | None = None
    asked: bool = False
    reason: str = ""
    unmatched: bool = False


class ErrorEntry(Model):
    """An exception. `kind` agent: planner or method crashed: a failure; infrastructure: not scored.

    `type` and `message` are the exception's; `where` is where it was raised, a line a call, the innermost last.
    """

    kind: Literal["agent", "infrastructure"]
    type: str
    message: str
    where: list[str] = Field(default_factory=list)


class UsageEntry(Model):
    """What an episode took of language models. `calls` are questions; `requests` what was sent for them, repeated and
    failed requests included. `money`: US dollars, of the requests whose price is known; `unpriced` counts the others.
    `prompt_tokens` and `completion_tokens` are of all of them, `seconds` what they took, added up.

    `repeats`: questions that were not put because the same had been answered in this episode.
    """

    calls: int = 0
    prompt_tokens: int = 0
    completion_tokens: int = 0
    money: float = 0.0
    unpriced: int = 0
    seconds: float = 0.0
    repeats: int = 0
    requests: int = 0


class ExchangeEntry(Model):
    """One question of a `role` to a language model: its `messages` (who speaks, text) and the `reply`, cut where long.

    `label` says what about; `reasoning` is what the model showed of its thoughts; `tokens` of prompt and answer
    together, `money` US dollars (None: not known), `seconds` until the answer was there. `round` counts the rounds
    played before it; `pictures` are digests of the images shown, which lie in the records' folder as
    pictures/<digest>.png; `error` is the kind of a failed call; `requests` how often it had to be sent; `adaptations`
    how it was sent otherwise than asked.
    """

    round: int
    role: str
    label: str = ""
    messages: list[tuple[str, str]] = Field(default_factory=list)
    reply: str = ""
    reasoning: str = ""
    error: str | None = None
    tokens: int = 0
    money: float | None = None
    seconds: float = 0.0
    pictures: list[str] = Field(default_factory=list)
    requests: int = 0
    adaptations: list[str] = Field(default_factory=list)


class VideoEntry(Model):
    """The video of an episode, its path relative to the records' folder, or why there is none.

    `path` None: none, for the reason `error`. `rounds`: when each round begins in it, seconds of the video.
    """

    path: str | None = None
    rounds: list[float] = Field(default_factory=list)
    error: str | None = None


class Record(Model):
    """One episode.

    Attributes:
        schema_version: written as `schema`.
        job: key of the job that the episode belongs to; `iteration` counts from 0 within it.
        agent: the method with the options in which it departs from its defaults; `method` is its bare name.
        task, style, layout, starts, seed, robots, backend: the kitchen, as the options of those names say.
        goal: the goal's sentence, as the planner was told it; empty where the episode never began.
        digest: name of the exact start; None, like style and layout, where the episode never began.
        scored: this is the job's last iteration and no infrastructure error; only scored records count.
        success: the goal held at the end, and the agent did not crash.
        end: success, lost, done or truncated, None where an error ended it.
        progress: the fraction of the goal's parts that hold at the end.
        phases: phase -> whether it was reached, in order, for tasks that have phases.
        initial_plan_length, final_plan_length: in rounds; the latter of the plan in force at the end,
            retries not counted. None where the agent reports none.
        initial_plan, final_plan: those plans, robot -> commands.
        subtasks_done: rounds of the plan in force whose subtasks' post-conditions all held.
        rounds: rounds played, retries included. sim_seconds: each round as long as its slowest robot.
        wall_seconds: what the episode took on the clock on the wall. physics_steps: control steps.
        outcomes: a round an entry, robot -> how its subtask ended.
        robot_contacts, near_misses: control steps in which robots touched, or were within 0.05 m.
        worlds: the WorldState at the start and after each round, as plain values.
        clock: rounds, or events: then a round of `rounds`, `outcomes` and `worlds` is a decision point, and an outcome
            stands in that at which its subtask had ended.
        orders: what the robots that were ready were told in each step, and `timeline`: what lasted how long; both empty
            with rounds.
        pre_checks, post_checks: verdicts before and after subtasks, beside the truth.
        adjusted: whether the plan was changed on the way. retries: subtasks that were tried again.
        reflections: what was learnt, in words.
        truth_readers, rule_readers: the roles that were given the WorldState, and those that were given what the skill
            table enforces or advises; older records say nothing of the latter.
        weights: role -> the digest (sha256) of the file of numbers by which it answered.
        isolated: whether code from outside ran in processes of its own; None where there is none, or nobody knows.
        usage, exchanges: what language models were asked, and what that took.
        adaptations: how questions were sent otherwise than asked, because of what endpoints refuse, such as
            "max_tokens -> max_completion_tokens"; each once.
        planner_errors: replies of the planner that were no plans.
        video: the video, or why there is none; None where none was asked for.
        error: the exception that ended the episode. versions: package -> version.
        optimum_rounds: length of the shortest plan, where it was asked for and is known; `optimum_proof` says how it
            is known, and `optimum_lower` how long it is at least (`remac_env.oracle.Certificate`).
        optimum_seconds: the shortest makespan under the event clock, s, where it was asked for and is known;
            `optimum_seconds_lower`: no plan takes less.
        problem: digest of the start without looks and names; None for older records.
        littered: objects that were let fall and lie on the floor at the end.
        options: {"kitchen": ..., "agent": ...}: everything that the job was made with; "access": how language models
            were reached; "job_seconds": the bound on the job's wall time.
        started: when it began, UTC, ISO 8601 to the second; machine: system, processor and cores. None in records from
            before 2026-11-30.
        skills: skill -> "scripted", or the digest of the weights (sha256) by which it moved; empty where all of them
            were scripted.
        body, body_digest: the name of the robots' body, and a digest of what it is (`bodies.described`); None with the
            standard one, which is part of the code, and in records from before 2026-11-30.
        skill_cases: skill -> the cases, such as "food on surface", in which it moved by its weights; in all others it
            was scripted. Without the skills that do not depend on the case.
        suite, suite_version, suite_digest: the frozen list that the job belongs to, and the digest of its content;
            None for a job that was put together on the command line.
        template, known_rounds: of a generated task: its template, and the rounds of the shortest plan that is known.
            None in records from before 2026-11-30.
    """

    schema_version: int = Field(default=SCHEMA, alias="schema")
    job: str
    agent: str
    method: str
    task: str
    style: str | None = None
    layout: str | None = None
    starts: str
    seed: int
    goal: str = ""
    digest: str | None = None
    robots: int
    backend: str
    iteration: int
    scored: bool
    success: bool
    end: str | None = None
    progress: float = 0.0
    phases: dict[str, bool] = Field(default_factory=dict)
    subtasks_done: int = 0
    initial_plan_length: int | None = None
    final_plan_length: int | None = None
    rounds: int = 0
    sim_seconds: float = 0.0
    wall_seconds: float = 0.0
    initial_plan: dict[str, list[str]] = Field(default_factory=dict)
    final_plan: dict[str, list[str]] = Field(default_factory=dict)
    outcomes: list[dict[str, OutcomeEntry]] = Field(default_factory=list)
    worlds: list[dict[str, Any]] = Field(default_factory=list)
    clock: str = "rounds"
    orders: list[dict[str, OrderEntry]] = Field(default_factory=list)
    timeline: list[SpanEntry] = Field(default_factory=list)
    pre_checks: list[CheckEntry] = Field(default_factory=list)
    post_checks: list[CheckEntry] = Field(default_factory=list)
    adjusted: bool = False
    retries: int = 0
    reflections: list[str] = Field(default_factory=list)
    truth_readers: list[str] = Field(default_factory=list)
    rule_readers: list[str] = Field(default_factory=list)
    isolated: bool | None = None
    weights: dict[str, str] = Field(default_factory=dict)
    planner_errors: list[str] = Field(default_factory=list)
    usage: UsageEntry = Field(default_factory=UsageEntry)
    exchanges: list[ExchangeEntry] = Field(default_factory=list)
    adaptations: list[str] = Field(default_factory=list)
    robot_contacts: int = 0
    near_misses: int = 0
    physics_steps: int = 0
    optimum_rounds: int | None = None
    optimum_lower: int | None = None
    optimum_proof: str | None = None
    optimum_seconds: float | None = None
    optimum_seconds_lower: float | None = None
    littered: int = 0
    problem: str | None = None
    template: str | None = None
    known_rounds: int | None = None
    video: VideoEntry | None = None
    error: ErrorEntry | None = None
    options: dict[str, Any] = Field(default_factory=dict)
    versions: dict[str, str] = Field(default_factory=dict)
    skills: dict[str, str] = Field(default_factory=dict)
    skill_cases: dict[str, list[str]] = Field(default_factory=dict)
    body: str | None = None
    body_digest: str | None = None
    started: str | None = None
    machine: str | None = None
    suite: str | None = None
    suite_version: int | None = None
    suite_digest: str | None = None

    @field_validator("options")
    @classmethod
    def _tables(cls, options: dict[str, Any]) -> dict[str, Any]:
        wrong = [name for name in ("kitchen", "agent", "access") if not isinstance(options.get(name, {}), dict)]
        if wrong:
            raise ValueError(f"options.{wrong[0]} is no table")
        return options

    @property
    def infrastructure_error(self) -> bool:
        """True when the episode has to be run again."""
        return self.error is not None and self.error.kind == "infrastructure"

    def line(self) -> str:
        """The record as one line of JSON, without the line's end."""
        return self.model_dump_json(by_alias=True)
