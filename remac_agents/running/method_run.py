"""One episode as a method sees it: the plan at hand, the roles to consult, and the book that is kept."""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from dataclasses import replace

from remac_agents.memory import Memory
from remac_agents.plan import Commands, Plan, PlanError
from remac_agents.report import Check
from remac_agents.roles import AdjustRequest, PlanRequest, ReflectRequest, Roles, Verdict, View
from remac_agents.running.asking import ask_planner, plan_request, ran_so_far, try_before
from remac_agents.running.briefing import Bounds, Briefing
from remac_agents.running.ledger import Ledger, really_done
from remac_agents.running.moments import Moment, shown
from remac_agents.running.tries import Try
from remac_env.rules.conditions import Condition
from remac_env.rules.facts import Rules
from remac_env.rules.subtasks import WAIT, Subtask
from remac_env.state import WorldState

Turns = Generator[dict[str, Subtask], View, None]
"""What a method is: it yields what its robots do next, and is sent the view after the round."""


class Episode:
    """The state of a method's run. Methods call the few verbs below; the agent calls `observe`."""

    def __init__(
        self,
        briefing: Briefing,
        roles: Roles,
        view: View,
        world: WorldState | None,
        rules: Rules,
        *,
        bounds: Bounds,
        memory: Memory,
    ) -> None:
        """Start at a reset; `rules` and `world` are handed only to roles that need them, and to the ledger."""
        self.briefing, self.roles, self.bounds, self.memory = briefing, roles, bounds, memory
        self.commands = Commands(briefing.commands)
        self.view, self._world = view, world
        self.rules: Rules = rules
        self.plan = Plan.of({})
        self.ledger = Ledger()
        self.lessons: tuple[str, ...] = ()
        self.reflecting = False
        self.rounds = 0
        self.moments: list[Moment] = []
        self.won: Try | None = None
        self._pending: set[str] = set()
        self._tries = 0
        self._adjustments = 0
        self._accepted: set[str] = set()
        self._slipped: set[str] = set()
        self._answers: dict[Condition, Verdict] = {}
        self._noted: set[tuple[str, Condition]] = set()

    # -- the plan --------------------------------------------------------------------------------------------

    @property
    def turn(self) -> dict[str, Subtask]:
        """What the plan's robots do next; those that are through with this round wait."""
        return {robot: step if robot in self._pending else WAIT for robot, step in self.plan.round().items()}

    @property
    def finished(self) -> bool:
        """True when the plan has ended or the bound on rounds is reached."""
        return self.plan.length == 0 or self.rounds >= self.bounds.rounds

    def recall(self) -> None:
        """Read the lessons of earlier iterations, and add to them from now on."""
        self.lessons = self.memory.lessons(self.briefing.task)
        self.reflecting = True

    def make_plan(self, robots: Sequence[str] | None = None) -> None:
        """Ask the planner; a reply that is no plan is sent back, and counts as an empty plan at last."""
        self.adopt(self.consult(self.plan_request(tuple(robots or (self.briefing.lead,)))))

    def consult(self, request: PlanRequest) -> Plan:
        """The planner's answer to a request; see `make_plan` for one that is no plan."""
        answer = self.answer_to(request)
        return Plan.of({}) if isinstance(answer, PlanError) else answer

    def answer_to(self, request: PlanRequest, *, most: int | None = None) -> Plan | PlanError:
        """The planner's answer, or what is wrong with its last; every answer that is no plan is noted."""
        most = self.bounds.replies if most is None else min(most, self.bounds.replies)
        came = ask_planner(self.roles.planner, request, self.commands, most=most)
        self.ledger.errors += [error.told for error in came if isinstance(error, PlanError)]
        return came[-1] if came else PlanError("the planner may not be asked")

    def plan_request(self, names: tuple[str, ...]) -> PlanRequest:
        """What a planner is told now."""
        return plan_request(self, names)

    def seen_by(self, role: object) -> View:
        """The present moment as this role may see it."""
        return shown(self.view, self.rules, self._world, role)

    def adopt(self, plan: Plan) -> None:
        """Carry out this plan from now on, as the first one."""
        self.ledger.initial = plan
        self.change_plan(plan)

    def change_plan(self, plan: Plan) -> None:
        """Carry out this plan from now on, in place of what remains of the one before."""
        self.plan = plan
        self._open_round()

    def advance(self, *, again: bool = False) -> None:
        """Go on to the next round of the plan; `again`: it is another try of this one."""
        if not again:
            self.ledger.close_round(self.plan.round())
        self.plan = self.plan.rest()
        self._open_round()

    # -- checks ----------------------------------------------------------------------------------------------

    def check_before(self) -> dict[str, tuple[Condition, ...]]:
        """Robot -> pre-conditions of its next subtask that are found false; none where it is ready."""
        failed: dict[str, tuple[Condition, ...]] = {}
        for robot, subtask in self.turn.items():
            if subtask == WAIT or robot in self._accepted:
                continue
            conditions = self.roles.conditions.before(subtask, robot, self.seen_by(self.roles.conditions))
            verdicts = self._judge(robot, conditions)
            self._note(self.ledger.pre_checks, robot, subtask, verdicts)
            wrong = tuple(condition for condition, verdict in verdicts.items() if verdict.value is False)
            if wrong:
                failed[robot] = wrong
        return failed

    def adjust(self, failed: Mapping[str, tuple[Condition, ...]]) -> None:
        """Let the adjuster change the rest of one robot's row; or else the subtask is tried as it is."""
        robot = min(failed)  # by name; the others' turn comes when the pre-conditions are checked again
        subtask = self.turn[robot]
        if self._adjustments >= self.bounds.adjustments:
            self._accepted.add(robot)
            return
        self._adjustments += 1
        held = self.view.holding.get(robot)
        request = AdjustRequest(
            failed=failed[robot],
            subtask=subtask,
            robot=robot,
            plan=self.plan,
            executed=tuple(played[robot] for played in self.ledger.finished if robot in played),
            commands=self.briefing.commands,
            view=self.seen_by(self.roles.adjuster),
            ask=lambda condition: self._ask(robot, subtask, condition),
            ran=ran_so_far(self.moments),
            previous=try_before(self),
        )
        advice = self.roles.adjuster.adjust(request)
        old = self.plan.row(robot)
        row = (*advice.next_steps, *old) if advice.row is None else advice.row
        row = tuple(step for step in row if self.commands.allows(step))
        if row == old:
            self._accepted.add(robot)
        else:
            self._replace_row(robot, row)
        if self.reflecting and robot not in self._slipped:
            seen = self.seen_by(self.roles.reflector)
            self.ledger.reflections += self.roles.reflector.reflect(
                ReflectRequest(self.briefing.goal, failed[robot], subtask, robot, held, advice, seen)
            )

    def check_after(self) -> None:
        """Check what was run; a robot whose post-conditions are found false tries again, at most `retries` times."""
        for robot, subtask in self.turn.items():
            last = self.moments[-1]
            view = shown(last.before, self.rules, last.world_before, self.roles.conditions)
            verdicts = self._judge(robot, self.roles.conditions.after(subtask, robot, view))
            self._note(self.ledger.post_checks, robot, subtask, verdicts)
            if not any(verdict.value is False for verdict in verdicts.values()):
                self._pending.discard(robot)
                if subtask != WAIT:
                    self._slipped.discard(robot)
            else:
                self._slipped.add(robot)
        self._tries += 1
        if not self._pending or (self._tries > self.bounds.retries and not self._leave_refused_behind()):
            self.advance()

    def _leave_refused_behind(self) -> bool:
        """Where only drives are still refused, the others go on: they may be in the way. False where none can."""
        refused = {robot for robot in self._pending if self.plan.round()[robot].skill == "navigate to"}
        rows = {robot: row if robot in refused else row[1:] for robot, row in self.plan.rows.items()}
        if refused != self._pending or {step for r, row in rows.items() if r not in refused for step in row} <= {WAIT}:
            return False
        self.ledger.close_round({r: step for r, step in self.plan.round().items() if r not in refused and step != WAIT})
        self.change_plan(Plan.of(rows))
        return True

    # -- what the agent calls --------------------------------------------------------------------------------

    def observe(self, view: View, world: WorldState | None, played: Mapping[str, Subtask]) -> None:
        """Take in the moment after a round, and score what was played by the truth."""
        for robot, subtask in played.items():
            if subtask == WAIT or robot not in self.plan.robots:
                continue
            report = view.reports.get(robot)
            done = None
            if self._world is not None and world is not None:
                done = really_done(self.rules, self._world, world, robot, subtask)
            status = None if report is None else report.status
            self.ledger.score(robot, subtask, status=status, done=done, round_=self.rounds)
        moment = Moment(self.rounds, dict(played), self.view, view, self._world, world)
        self.moments.append(moment)
        self.view, self._world = view, world
        self.rounds += 1
        self._accepted.clear()
        self._answers.clear()
        self._noted.clear()

    # -- inside ----------------------------------------------------------------------------------------------

    def _open_round(self) -> None:
        self._pending = set(self.plan.robots)
        self._tries = 0

    def _replace_row(self, robot: str, row: Sequence[Subtask]) -> None:
        """A new row; what other robots have done of this round already is closed as a round of its own."""
        self.ledger.adjusted = True
        through = {r: s for r, s in self.plan.round().items() if r not in self._pending and s != WAIT}
        if through:
            self.ledger.close_round(through)
            rows = {r: (WAIT, *old[1:]) if r in through else old for r, old in self.plan.rows.items()}
            self.plan = Plan.of(rows)
        self.ledger.current_done.clear()
        self.plan = self.plan.with_row(robot, row)
        self._open_round()

    def _judge(self, robot: str, conditions: Sequence[Condition]) -> dict[Condition, Verdict]:
        """Verdicts, None where the checker gives none; a question put twice at one moment is answered once."""
        fresh = [condition for condition in dict.fromkeys(conditions) if condition not in self._answers]
        if fresh:
            self._answers |= {condition: Verdict(condition, None, "not judged") for condition in fresh}
            moment = replace(self.seen_by(self.roles.checker), robot=robot, ran=ran_so_far(self.moments))
            for verdict in self.roles.checker.check(fresh, moment):
                self._answers[verdict.condition] = verdict
        return {condition: self._answers[condition] for condition in conditions}

    def _ask(self, robot: str, subtask: Subtask, condition: Condition) -> bool | None:
        verdicts = self._judge(robot, [condition])
        self._note(self.ledger.pre_checks, robot, subtask, verdicts, asked=True)
        return verdicts[condition].value

    def _note(
        self,
        book: list[Check],
        robot: str,
        subtask: Subtask,
        verdicts: Mapping[Condition, Verdict],
        *,
        asked: bool = False,
    ) -> None:
        for condition, verdict in verdicts.items():
            key = (f"{id(book)} {robot} {subtask.text}", condition)
            if key in self._noted:
                continue
            self._noted.add(key)
            book.append(Check.of(verdict, self.rounds, robot, subtask, self.rules, self._world, asked=asked))
