"""Robots that act each by itself: who is asked what, what each has done, and when it stops."""

from __future__ import annotations

from dataclasses import replace

from remac_agents.plan import Plan, PlanError
from remac_agents.roles import Attempt
from remac_agents.running.method_run import MethodRun
from remac_env.rules.subtasks import DONE, WAIT, Subtask
from remac_env.thinking import Thought

QUESTION = "act"
"""The question of a request for one robot's next command, whatever the others do (`PlanRequest.question`)."""


class Acting:
    """The commands of one episode. Each robot is asked as often as the method's bound on rounds allows."""

    def __init__(self, run: MethodRun) -> None:
        self._run = run
        self._histories: dict[str, list[Attempt]] = {robot: [] for robot in run.briefing.robots}
        self._left = dict.fromkeys(run.briefing.robots, run.bounds.rounds)
        self._at: dict[str, Subtask] = {}

    @property
    def over(self) -> bool:
        """Whether nobody is asked any more, and nobody is at anything."""
        return not self._at and not any(self._left.values())

    def decide(self) -> dict[str, Subtask]:
        """A command for every robot that is ready; one that has said `done`, or may not be asked, waits."""
        run, turn = self._run, dict[str, Subtask]()
        for robot in run.ready:
            before = run.spent()
            turn[robot] = self._ask(robot, turn) if self._left[robot] > 0 else WAIT
            tokens, seconds = run.spent()
            run.thoughts[robot] = Thought(tokens - before[0], round(seconds - before[1], 6), run.declared)
        self._at |= {robot: step for robot, step in turn.items() if self._left[robot] > 0 or step != WAIT}
        run.change_plan(Plan.of({robot: [step] for robot, step in self._at.items()}))
        return turn

    def note_outcomes(self) -> None:
        """What has ended is told to its robot's planner the next time."""
        ended = {robot: step for robot, step in self._at.items() if robot in self._run.ready}
        for robot, step in ended.items():
            del self._at[robot]
            report = self._run.book.view.reports.get(robot)
            succeeded = None if report is None else report.status == "success"
            reason = None if report is None else report.reason
            if step != WAIT:
                self._histories[robot].append(Attempt(robot, step, True, succeeded, reason=reason))
        if any(step != WAIT for step in ended.values()):
            self._run.book.ledger.close_round(ended)

    def _ask(self, robot: str, turn: dict[str, Subtask]) -> Subtask:
        run = self._run
        teammates = {name: step.text for name, step in (self._at | turn).items() if name != robot}
        request = replace(
            run.plan_request((robot,)),
            lead=robot,
            history=tuple(self._histories[robot]),
            single_step=True,
            question=QUESTION,
            teammates=teammates,
        )
        unusable = len(run.book.ledger.errors)
        plan = run.answer_to(request, most=self._left[robot])
        self._left[robot] -= len(run.book.ledger.errors) - unusable + isinstance(plan, Plan)
        # Waits at the end of a row are cut off, so that an answer of a wait alone is an empty row.
        step = DONE if isinstance(plan, PlanError) else next(iter(plan.row(robot)), WAIT)
        if step == DONE:
            self._left[robot] = 0
            return WAIT
        return step
