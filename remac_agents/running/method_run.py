"""A method's run of one episode: the plan and how far it has come, the roles to consult, and the book that is kept."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping, Sequence

from remac_agents.memory import Memory
from remac_agents.plan import Commands, Plan, PlanError
from remac_agents.roles import PlanRequest, PreviousTry, Roles, View
from remac_agents.running.asking import ask_planner, plan_request, previous_try
from remac_agents.running.bookkeeper import Bookkeeper
from remac_agents.running.briefing import Bounds, Briefing
from remac_agents.running.round_state import RoundState
from remac_agents.running.tries import Try
from remac_env.rules.subtasks import Subtask
from remac_env.state import WorldState
from remac_env.thinking import Thought

Turns = Generator[dict[str, Subtask], View, None]
"""What a method is: it yields what its robots do next, and is sent the view after the round."""


class MethodRun:
    """What a method has in hand. It calls the verbs below and those of `running.checks`; the agent calls `observe`.

    Attributes:
        briefing, roles, book, bounds, memory: as given.
        commands: what can be said in this kitchen.
        state: where the episode is now.
        lessons: what the memory says of this task; reflecting: whether failures are to be learnt from.
        won: the first try at this episode that reached the goal, None before.
        thoughts: robot -> what its last decision took; spent: tokens and seconds of models so far; declared: seconds
            that other roles said they take.
    """

    def __init__(
        self, briefing: Briefing, roles: Roles, book: Bookkeeper, *, bounds: Bounds, memory: Memory
    ) -> None:
        """Start at a reset, without a plan."""
        self.briefing, self.roles, self.book = briefing, roles, book
        self.bounds, self.memory = bounds, memory
        self.commands = Commands(briefing.commands)
        self.state = RoundState()
        self.lessons: tuple[str, ...] = ()
        self.reflecting = False
        self.won: Try | None = None
        self.thoughts: dict[str, Thought] = {}
        self.spent: Callable[[], tuple[int, float]] = lambda: (0, 0.0)
        self.declared = 0.0

    @property
    def plan(self) -> Plan:
        """What remains of the plan in force."""
        return self.state.plan

    @property
    def turn(self) -> dict[str, Subtask]:
        """What the plan's robots do next; those that are through with this round wait."""
        return self.state.turn

    @property
    def ready(self) -> tuple[str, ...]:
        """The robots that are to decide now: with rounds all."""
        return self.book.view.ready

    @property
    def by_events(self) -> bool:
        """Whether the kitchen runs by the event clock."""
        return self.book.view.clock is not None

    @property
    def finished(self) -> bool:
        """True when the plan has ended or the bound on rounds is reached."""
        return self.plan.length == 0 or self.book.rounds >= self.bounds.rounds

    @property
    def previous(self) -> PreviousTry | None:
        """The iteration before this one, where the method learns and there was one."""
        runs = self.memory.runs(self.briefing.task) if self.reflecting else ()
        return previous_try(runs[-1]) if runs else None

    def recall(self) -> None:
        """Read the lessons of earlier iterations, and add to them from now on."""
        self.lessons = self.memory.lessons(self.briefing.task)
        self.reflecting = True

    def make_plan(self, robots: Sequence[str] | None = None) -> None:
        """Ask the planner; a reply that is not a plan is sent back, and counts as an empty plan at last."""
        self.adopt(self.consult(self.plan_request(tuple(robots or (self.briefing.lead,)))))

    def plan_request(self, robots: tuple[str, ...]) -> PlanRequest:
        """What a planner is told now."""
        return plan_request(
            self.briefing, self.book, robots, planner=self.roles.planner, lessons=self.lessons, previous=self.previous
        )

    def consult(self, request: PlanRequest) -> Plan:
        """The planner's answer to a request; see `make_plan` for one that is not a plan."""
        answer = self.answer_to(request)
        return Plan.of({}) if isinstance(answer, PlanError) else answer

    def answer_to(self, request: PlanRequest, *, most: int | None = None) -> Plan | PlanError:
        """The planner's answer, or what is wrong with its last; every answer that is not a plan is noted."""
        most = self.bounds.replies if most is None else min(most, self.bounds.replies)
        came = ask_planner(self.roles.planner, request, self.commands, most=most)
        self.book.ledger.errors += [error.told for error in came if isinstance(error, PlanError)]
        return came[-1] if came else PlanError("the planner may not be asked")

    def adopt(self, plan: Plan) -> None:
        """Carry out this plan from now on, as the first one."""
        self.book.ledger.initial = plan
        self.change_plan(plan)

    def change_plan(self, plan: Plan) -> None:
        """Carry out this plan from now on, in place of what remains of the one before."""
        self.state = self.state.opened(plan)

    def advance(self, *, again: bool = False) -> None:
        """Go on to the next round of the plan; `again`: it is another try of this one."""
        if not again:
            self.book.ledger.close_round(self.plan.round())
        self.change_plan(self.plan.rest())

    def observe(self, view: View, world: WorldState | None, played: Mapping[str, Subtask]) -> None:
        """Take in the moment after a round."""
        self.book.observe(view, world, played, robots=self.plan.robots)
        self.state = self.state.at_next_moment()
