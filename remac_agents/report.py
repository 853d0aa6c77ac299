"""What an episode of an agent leaves behind: steps, verdicts beside the truth, what models were asked - as values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from remac_agents.roles import FreeText, Verdict
from remac_agents.roles.free_text import truth_of
from remac_env.rules.facts import Rules
from remac_env.rules.subtasks import Subtask
from remac_env.state import WorldState


@dataclass(frozen=True)
class Check:
    """One verdict (None: the checker cannot tell) beside the truth (None where the kitchen did not tell it).

    `round` counts the rounds (by the event clock: decision points) before it; `robot` is about to run `subtask`, or has
    run it, and `condition` is the sentence that was judged (`verdict`, beside `truth`); `asked` marks a question of the
    adjuster's, which is no pre-check itself; `reason` is the checker's, where it gives one; `unmatched` marks words
    that no predicate says.
    """

    round: int
    robot: str
    subtask: str
    condition: str
    verdict: bool | None
    truth: bool | None
    asked: bool = False
    reason: str = ""
    unmatched: bool = False

    @classmethod
    def of(
        cls,
        verdict: Verdict,
        steps: int,
        robot: str,
        subtask: Subtask,
        scene: Rules,
        world: WorldState | None,
        *,
        asked: bool = False,
    ) -> Check:
        """A verdict about a moment, beside what was true then."""
        condition = verdict.condition
        return cls(
            round=steps,
            robot=robot,
            subtask=subtask.text,
            condition=condition.sentence,
            verdict=verdict.value,
            truth=truth_of(condition, scene, world),
            asked=asked,
            reason=verdict.reason,
            unmatched=isinstance(condition, FreeText),
        )


@dataclass(frozen=True)
class Step:
    """A `subtask` that `robot` ran in a `round` (from 0). `status`: success or failure, None where it was cut short.

    `done`: its post-conditions then held. `retry`: not its first try.
    """

    round: int
    robot: str
    subtask: str
    status: str | None
    done: bool | None
    retry: bool


@dataclass(frozen=True)
class Usage:
    """What an episode took of language models.

    Attributes:
        calls: questions.
        requests: what was sent for them, repeated and failed requests included.
        prompt_tokens, completion_tokens: of all requests, as far as endpoints told.
        money: US dollars, of the requests whose price is known; `unpriced` counts the others.
        seconds: spent in calls, waiting included.
        repeats: questions that were not put because the same had been answered in this episode.
    """

    calls: int = 0
    prompt_tokens: int = 0
    completion_tokens: int = 0
    money: float = 0.0
    unpriced: int = 0
    seconds: float = 0.0
    repeats: int = 0
    requests: int = 0


@dataclass(frozen=True)
class Exchange:
    """One question to a language model and its answer.

    Attributes:
        round: rounds played before it; by the event clock decision points.
        role, label: who asked, and what about.
        messages: (role, text) in order.
        reply, reasoning: the answer, and the reasoning text that came apart from it.
        error: the kind of a failed call (remac_agents.llm.KINDS), else None.
        tokens, money, seconds: what it took; money in US dollars, None where the price is not known.
        pictures: digests of the images shown.
        requests: how often it had to be sent.
        adaptations: how it was sent otherwise than asked, because of what the endpoint refuses.
    """

    round: int
    role: str
    label: str = ""
    messages: tuple[tuple[str, str], ...] = ()
    reply: str = ""
    reasoning: str = ""
    error: str | None = None
    tokens: int = 0
    money: float | None = None
    seconds: float = 0.0
    pictures: tuple[str, ...] = ()
    requests: int = 0
    adaptations: tuple[str, ...] = ()


@dataclass(frozen=True)
class EpisodeReport:
    """One episode of an agent.

    Attributes:
        method, iteration, success: which method, the number of the episode on this start, and how it ended.
        initial_plan: the first plan, robot -> commands.
        final_plan: the plan in force at the end: steps executed, retries not counted, plus those that remain.
        initial_plan_length, final_plan_length: in rounds; the former None for a method that plans step by step.
        subtasks_done: rounds of the final plan whose subtasks' post-conditions all held.
        executed: every step in order, retries included.
        pre_checks, post_checks: verdicts beside the truth.
        adjusted: whether the plan was changed on the way.
        retries: how many steps were second or later tries.
        reflections: what this episode taught.
        truth_readers, rule_readers: the roles that were given the WorldState, and those that were given the Rules.
        isolated: whether roles that are code from outside ran in processes of their own; None where none is.
        weights: role -> the digest (sha256) of the file of numbers by which it answered; roles that have none left out.
        errors: replies of the planner that were not plans, other answers of models that were of no use, and why the
            episode was ended, if a role had to.
        usage, exchanges: what language models were asked, and what that took.
        pictures: digest -> PNG of every image that a language model was shown.
        infrastructure: why the episode counts for nothing (an endpoint that was down), None where it counts.
    """

    method: str
    iteration: int
    success: bool
    initial_plan: Mapping[str, tuple[str, ...]]
    final_plan: Mapping[str, tuple[str, ...]]
    initial_plan_length: int | None
    final_plan_length: int
    subtasks_done: int
    executed: tuple[Step, ...]
    pre_checks: tuple[Check, ...]
    post_checks: tuple[Check, ...]
    adjusted: bool
    retries: int
    reflections: tuple[str, ...]
    truth_readers: tuple[str, ...]
    errors: tuple[str, ...]
    usage: Usage = field(default_factory=Usage)
    exchanges: tuple[Exchange, ...] = ()
    pictures: Mapping[str, bytes] = field(default_factory=dict)
    infrastructure: str | None = None
    rule_readers: tuple[str, ...] = ()
    isolated: bool | None = None
    weights: Mapping[str, str] = field(default_factory=dict)

    @property
    def adaptations(self) -> tuple[str, ...]:
        """How questions were sent otherwise than asked, because of what endpoints refuse; each once."""
        notes = [note for exchange in self.exchanges for note in exchange.adaptations]
        # A bound on tokens is reduced by what each prompt leaves: the first one tells of them all.
        first = {note.rpartition(" -> ")[0] or note: note for note in reversed(notes)}
        return tuple(note for note in dict.fromkeys(notes) if note in first.values())
