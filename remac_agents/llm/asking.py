"""One call: requests until one is answered, or another would not help. Each is admitted, sent and booked here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from remac_agents.llm import booking
from remac_agents.llm.adapting import FAIR_TOKENS, Manner, Manners, adaptations, respond
from remac_agents.llm.budget import Budget
from remac_agents.llm.clock import Clock
from remac_agents.llm.judging import judge
from remac_agents.llm.limiter import Limiter
from remac_agents.llm.outcomes import KINDS, PATIENT, REASKS, Bill, ChatError, ChatReply
from remac_agents.llm.request import ChatRequest
from remac_agents.llm.retry import wait_before
from remac_agents.llm.transport import Transport

UNREACHABLE_S = 10.0
"""A server that nobody answers at is given up after so long: one that is down is told at once."""

MOST_CHANGES = 16
"""Changes of one call after what an endpoint refused; there are fewer fields than that."""

MORE = 4
"""An answer that hit its bound is asked for again with so many times the tokens, then with the most there may be."""

MOST_TOKENS = 32_768
"""The most there may be, where the data of a model do not say."""


@dataclass
class _Course:
    """A call under way."""

    asked: ChatRequest
    started: float
    deadline: float
    tries: dict[str, int] = field(default_factory=dict)
    attempts: int = 0
    bill: Bill = Bill()
    room: int | None = None
    changes: int = 0
    halved: int = 0
    raised: int = 0
    cut: ChatError | None = None
    learnt: Manner = Manner()


@dataclass(frozen=True)
class Asker:
    """What the calls of a client have in common. `tries`: requests of one call at most, those aside that an endpoint
    refuses and that are changed."""

    transport: Transport
    limiter: Limiter
    budget: Budget
    manners: Manners
    clock: Clock
    jitter: Callable[[], float]
    tries: int = PATIENT

    def ask(self, asked: ChatRequest, seconds: float) -> ChatReply | ChatError:
        """The outcome of a question, `seconds` from now at the latest."""
        started = self.clock.monotonic()
        left = self.budget.seconds_left()
        course = _Course(asked, started, started + (seconds if left is None else min(seconds, left)))
        try:
            return self._asked(course)
        finally:
            self.budget.book_seconds(self.clock.monotonic() - started)

    def _asked(self, course: _Course) -> ChatReply | ChatError:
        question = course.asked
        while True:
            manner = self.manners.of(question.endpoint) | course.learnt
            sent = manner.applied(course.asked, room=course.room)
            outcome = self._try(sent, course)
            if course.cut is not None and isinstance(outcome, ChatError) and outcome.kind == "over_budget":
                outcome = course.cut  # what was to be spent on a longer answer is not there; the answer was cut
            elif isinstance(outcome, ChatError) and self._goes_on(outcome, sent, manner, course):
                continue
            elif isinstance(outcome, ChatError):
                outcome = self._final(outcome, sent, manner, course)
            if isinstance(outcome, ChatReply) or outcome.status == 200:
                self.manners.learn(question.endpoint, course.learnt)  # asked in this manner, it answers
            return replace(
                outcome,
                attempts=course.attempts,
                seconds=self.clock.monotonic() - course.started,
                bill=course.bill,
                adaptations=adaptations(question, sent),
            )

    def _try(self, sent: ChatRequest, course: _Course) -> ChatReply | ChatError:
        """One request, or why it was not sent."""
        if sent.images and not sent.endpoint.model.images:
            told = f"{sent.endpoint.name} takes no pictures here: set images=false and let another one check"
            return ChatError("unsupported", told)
        with self.limiter.place(course.deadline) as got:
            if not got:
                return ChatError("timeout", "other requests, or a pause of the endpoint, left no time")
            worst = booking.worst(sent)
            broken = self.budget.refuse(worst)
            if broken:
                return ChatError("over_budget", broken)
            actual = worst
            try:
                raw = self.transport.send(sent, deadline=course.deadline)
                outcome = raw if isinstance(raw, ChatError) else judge(raw, sent)
                actual = booking.cost(outcome, sent)
            finally:
                self.budget.book(worst, actual)
            course.attempts += 1
            course.bill += booking.bill(outcome, sent)
            self._tell_limiter(outcome)
            return outcome

    def _goes_on(self, error: ChatError, sent: ChatRequest, manner: Manner, course: _Course) -> bool:
        """Prepare another request; False: none would help."""
        if error.kind == "cut_short":
            return self._raise(error, sent, course)
        if self._change(error, sent, manner, course):
            return True
        wait = self._wait(error, course)
        if wait is None:
            return False
        self.clock.sleep(wait)
        return True

    def _change(self, error: ChatError, sent: ChatRequest, manner: Manner, course: _Course) -> bool:
        """Adapt to what was refused."""
        found = respond(error, course.asked, sent, manner, course.halved)
        if isinstance(found, ChatError) or course.changes >= MOST_CHANGES:
            if isinstance(found, ChatError) and found.kind == "unsupported":
                self.manners.learn(sent.endpoint, replace(manner, left_out=manner.left_out | {"images"}))
            return False
        course.changes += 1
        if found.room is not None:
            course.halved += found.manner.context == manner.context
            course.room = found.room
        course.learnt |= found.manner
        return True

    def _raise(self, error: ChatError, sent: ChatRequest, course: _Course) -> bool:
        """Ask for a longer answer, up to the most that the model takes."""
        asked = course.asked
        longest = max(asked.endpoint.model.max_tokens_bound or MOST_TOKENS, asked.max_tokens)
        more = min(longest, MORE * asked.max_tokens) if course.raised == 0 else longest
        raised = replace(asked, max_tokens=more)
        manner = self.manners.of(asked.endpoint) | course.learnt
        longer = manner.applied(raised, room=course.room).max_tokens
        bounded = longer > sent.max_tokens and sent.endpoint.model.max_tokens_field
        if not bounded or course.raised + 1 >= min(REASKS, self.tries):
            return False
        course.asked, course.cut = raised, error
        course.raised += 1
        return True

    def _final(self, error: ChatError, sent: ChatRequest, manner: Manner, course: _Course) -> ChatError:
        """The last error, with the option that may help. What our request did not allow is not the model's fault."""
        if error.kind != "cut_short":
            found = respond(error, course.asked, sent, manner, course.halved)
            return found if isinstance(found, ChatError) else error
        kept = {"tokens_in": error.tokens_in, "tokens_out": error.tokens_out, "money": error.money}
        if not sent.endpoint.model.max_tokens_field:
            told = f"{error.detail}, by a bound of the endpoint's own, which was told none (option max_tokens_field)"
            return ChatError("unfinished", told, error.status, **kept)  # type: ignore[arg-type]
        if sent.max_tokens < min(FAIR_TOKENS, course.asked.max_tokens):
            told = f"{error.detail}: {sent.max_tokens} tokens at most were left for it (options context, max_tokens)"
            return ChatError("context_too_long", told, error.status, **kept)  # type: ignore[arg-type]
        return error

    def _wait(self, error: ChatError, course: _Course) -> float | None:
        """Seconds until another try; None: none would help, or there is no time for it."""
        tries = course.tries
        tries[error.kind] = tries.get(error.kind, 0) + 1
        total = sum(tries.values())
        if tries[error.kind] >= KINDS[error.kind].tries or total >= self.tries:
            return None
        if not error.infrastructure:
            return 0.0  # the endpoint is well and needs no rest
        wait = wait_before(total, error.retry_after, self.jitter)
        then = self.clock.monotonic() + wait
        if error.kind == "endpoint_unavailable" and then - course.started >= UNREACHABLE_S and not course.bill.requests:
            return None
        return None if then >= course.deadline else wait

    def _tell_limiter(self, outcome: ChatReply | ChatError) -> None:
        if isinstance(outcome, ChatReply) or not KINDS[outcome.kind].infrastructure:
            self.limiter.succeeded()
        elif outcome.kind == "rate_limited":
            self.limiter.rate_limited(wait_before(1, outcome.retry_after, self.jitter))
        elif KINDS[outcome.kind].weighs and not booking.unsent(outcome):
            self.limiter.failed()  # who is not there needs no rest, and is told of at once


