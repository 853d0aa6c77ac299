"""A method with its roles filled, driven by the ordinary loop: reset, act, act, ..., close_episode."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from remac_agents.memory import Memory
from remac_agents.methods import Method
from remac_agents.plan import Commands
from remac_agents.planning.coalitions import skills_of
from remac_agents.report import EpisodeReport
from remac_agents.roles import Roles, StopEpisode, View
from remac_agents.roles.grants import declared_seconds, isolation, readers, reads_rules, reads_truth, weights
from remac_agents.running.bookkeeper import Bookkeeper
from remac_agents.running.briefing import Bounds, Briefing
from remac_agents.running.looking import check_told, look
from remac_agents.running.method_run import MethodRun
from remac_agents.running.pace import Pace, Told, goes_on, ready
from remac_agents.running.remembering import remembered
from remac_agents.running.tries import Try
from remac_agents.wiring.checked import checked, everyone
from remac_agents.wiring.correspondence import Correspondence
from remac_env.errors import LifecycleError, OptionError, check_choice
from remac_env.rules.subtasks import DONE, STEP_ASIDE, WAIT, Subtask
from remac_env.seeding import digest
from remac_env.thinking import Thought

SEEDS = 2**31
"""Seeds that are made for roles lie below it."""

_NEEDED = ("goal", "text", "commands", "scene")
"""What a kitchen must tell of itself in the infos of every robot."""


class Agent:
    """Keeps its memory from episode to episode; reset the kitchen with the same seed for iterations 0..k."""

    def __init__(
        self,
        method: Method,
        roles: Roles,
        *,
        memory: Memory,
        bounds: Bounds,
        lead: str | None = None,
        helper: str | None = None,
        iterations: int | None = None,
    ) -> None:
        """See `remac_agents.make`."""
        self.method, self.roles, self.memory, self.bounds = method, roles, memory, bounds
        self._lead, self._helper, self._last_iteration = lead, helper, iterations
        self._checked = checked(roles)
        self._correspondence = Correspondence(roles)
        self._infrastructure: str | None = None
        self._iterations: dict[str, int] = {}
        self._won: dict[str, Try] = {}
        self._run: MethodRun | None = None
        self._open = False
        self._success = False
        self._iteration = 0

    def __repr__(self) -> str:
        roles = ", ".join(f"{name} {type(role).__name__}" for name, role in self.roles.named().items())
        return f"<Agent {self.method.name}: {roles}>"

    @property
    def picture_viewers(self) -> tuple[str, ...]:
        """The roles that the method asks and that look at pictures: their kitchen needs obs="state+images"."""
        asked = {name: role for name, role in self.roles.named().items() if name == "planner" or self.method.checks}
        return tuple(name for name, role in asked.items() if getattr(role, "needs_images", False))

    def reset(self, obs: Told, infos: Told) -> None:
        """Begin an episode; one that was never closed is closed first, as a failure.

        Raises:
            UnknownNameError: if the leading or helping robot that was asked for is not in this kitchen.
            OptionError: for infos that are not those of a kitchen's reset, and where a role must see pictures and there
                are none.
        """
        check_told(obs, infos, _NEEDED)
        if self._open:
            self.close_episode({}, {})
        briefing = self._brief(infos)
        self._label = f"{briefing.task} {briefing.episode.get('digest', '')}"
        self._iteration = self._iterations.get(self._label, 0)
        self._iterations[self._label] = self._iteration + 1
        briefing = replace(briefing, last=self._iteration == self._last_iteration)
        for role in everyone(self._checked):
            role.begin_episode(int(briefing.episode.get("seed", 0)), _public_seed(briefing), self._iteration)
        view, world = look(obs, infos, briefing, {})
        self._check_pictures(view)
        book = Bookkeeper(view, world, infos[briefing.lead]["scene"])
        run = MethodRun(briefing, self._checked, book, bounds=self.bounds, memory=self.memory)
        run.won = self._won.get(self._label)
        run.spent, run.declared = lambda: self._correspondence.spent, declared_seconds(self.roles.named())
        seed = briefing.episode.get("seed", "")
        label = f"{self.method.name}/{briefing.task}/{seed}/{briefing.episode.get('digest', '')}/{self._iteration}"
        self._correspondence.begin_episode(label, book.ledger.errors)
        self._infrastructure = None
        self._run, self._turns = run, self.method.run(run)
        self._tokens = {robot: dict(infos[robot]["commands"]) for robot in infos}
        self._pace = Pace(in_step=not self.method.by_events)
        self._thoughts: dict[str, Thought] = {}
        self._spent, self._acts = (0, 0.0), 0
        self._played: dict[str, Subtask] | None = None
        self._sent: dict[str, Subtask] = {}
        self._open, self._success, self._ended = True, False, False

    def act(self, obs: Told, infos: Told) -> dict[str, int]:
        """The tokens of the next round or decision point, one for every robot in `infos`.

        Raises:
            LifecycleError: before reset or after close_episode.
            OptionError: for infos that name no robot.
        """
        run = self._running()
        if not self._open:
            raise LifecycleError("act() needs an episode under way: call reset(obs, infos) first")
        check_told(obs, infos)
        self._thoughts = {}
        run.book.steps, self._acts = self._acts, self._acts + 1
        if not self._pace.take_in(infos):
            return self._tokens_of({}, infos, WAIT)
        run.thoughts = {}
        turn = self._next_turn(obs, self._pace.gathered(infos))
        first, self._played = self._played is None, turn
        self._pace.asked_for(turn, infos)
        run.book.begin(turn)
        self._thoughts = self._costs(ready(infos))
        if not turn and self._ended:
            return self._tokens_of({}, infos, WAIT if goes_on(infos) else DONE)
        idle = STEP_ASIDE if first and (self.method.plans_ahead or not self.method.by_events) else WAIT
        asked = (robot for robot in ready(infos) if robot in run.briefing.robots)
        turn = {robot: turn.get(robot, idle) for robot in asked}
        self._sent |= turn
        self._pace.sent(turn)
        return self._tokens_of(turn, infos, WAIT)

    def thoughts(self) -> dict[str, Thought]:
        """What went into the tokens that `act` gave last, robot by robot; nothing where nobody was asked for them."""
        return dict(self._thoughts)

    def close_episode(self, obs: Told, infos: Told) -> None:
        """End the episode with what came last, if known (it may have crashed), and write the memory."""
        run = self._running()
        if not self._open:
            return
        if not isinstance(infos, Mapping) or infos:
            check_told(obs, infos)
        self._open = False
        if infos:
            run.book.steps = self._acts
            self._pace.take_in(infos)
            if self._played is not None:
                run.observe(*look(obs, self._pace.gathered(infos), run.briefing, self._sent), self._pace.played())
            self._success = any(bool(info.get("success")) for info in infos.values())
        review = getattr(self._checked.reflector, "review", None)
        if review is not None:
            run.book.ledger.reflections = review(run.book.ledger.reflections, success=self._success)
        if self._success and self.method.iterates:
            kept = Try.of(run.book.ledger, run.plan, run.commands)
            self._won.setdefault(self._label, kept)
        if self.method.remembers and self._infrastructure is None:
            self.memory.append(remembered(run, success=self._success))

    def report(self) -> EpisodeReport:
        """What the episode, running or closed, has come to so far."""
        run = self._running()
        ledger, final = run.book.ledger, run.book.ledger.plan_in_force(run.plan)
        return EpisodeReport(
            method=self.method.name,
            iteration=self._iteration,
            success=self._success,
            initial_plan=ledger.initial.as_text(),
            final_plan=final.as_text(),
            initial_plan_length=ledger.initial.length if self.method.plans_ahead else None,
            final_plan_length=final.length,
            subtasks_done=ledger.rounds_done(run.plan),
            executed=tuple(ledger.steps),
            pre_checks=tuple(ledger.pre_checks),
            post_checks=tuple(ledger.post_checks),
            adjusted=ledger.adjusted,
            retries=sum(step.retry for step in ledger.steps),
            reflections=tuple(ledger.reflections),
            truth_readers=readers(self._checked.named(), reads_truth),
            rule_readers=readers(self._checked.named(), reads_rules),
            isolated=isolation(self.roles.named()),
            weights=weights(self.roles.named()),
            errors=tuple(ledger.errors),
            infrastructure=self._infrastructure,
            **self._correspondence.fields(),
        )

    # -- inside ----------------------------------------------------------------------------------------------

    def _check_pictures(self, view: View) -> None:
        viewers = self.picture_viewers
        if viewers and not any(view.images.values()):
            raise OptionError(
                f"{', '.join(viewers)} of {self.method.name} must see pictures, and these observations hold none; "
                'valid: those of parallel_env(..., obs="state+images", image_size=512)'
            )
        for name in viewers:
            wanted = getattr(self.roles.named()[name], "cameras", ())
            if not any(set(wanted) <= set(seen) for seen in view.images.values()):
                raise OptionError(
                    f"{name} of {self.method.name} must see the pictures {', '.join(wanted)}; valid: "
                    f'parallel_env(..., obs="state+images", cameras="{",".join(wanted)}")'
                )

    def _next_turn(self, obs: Told, infos: Told) -> dict[str, Subtask]:
        """What the method yields next; nothing once it has ended."""
        run = self._running()
        if self._ended:
            return {}
        try:
            if self._played is None:
                return next(self._turns)
            view, world = look(obs, infos, run.briefing, self._sent)
            run.observe(view, world, self._pace.played())
            self._correspondence.begin_round(run.book.steps)
            return self._turns.send(view)
        except StopIteration:
            self._ended = True
        except StopEpisode as stop:
            self._ended = True
            run.book.ledger.errors.append(str(stop))
            self._infrastructure = str(stop) if stop.infrastructure else None
        return {}

    def _costs(self, robots: tuple[str, ...]) -> dict[str, Thought]:
        """What was thought since, for each of the robots: as the method says whose it was, or for all of them."""
        before, (tokens, seconds) = self._spent, self._correspondence.spent
        self._spent = (tokens, seconds)
        whole = Thought(tokens - before[0], round(seconds - before[1], 6), self._running().declared)
        own = self._running().thoughts
        return {robot: own.get(robot, whole) for robot in robots}

    def _tokens_of(self, turn: Mapping[str, Subtask], infos: Told, otherwise: Subtask) -> dict[str, int]:
        """A token for every robot: what it is to do, or to go on with what it is at."""
        able = set(ready(infos))
        return {
            robot: self._token(robot, turn.get(robot, otherwise)) if robot in able else int(info["continue"])
            for robot, info in infos.items()
            if robot in self._running().briefing.robots
        }

    def _running(self) -> MethodRun:
        if self._run is None:
            raise LifecycleError("no episode has begun: call reset(obs, infos) first")
        return self._run

    def _token(self, robot: str, subtask: Subtask) -> int:
        """The token of a subtask; a command that the kitchen lacks becomes a wait."""
        tokens = self._tokens[robot]
        return int(tokens.get(subtask.text, tokens.get(WAIT.text, 0)))

    def _brief(self, infos: Told) -> Briefing:
        robots = tuple(infos)
        lead = self._named(self._lead, robots, "leading robot")
        helper = self._named(self._helper, tuple(name for name in robots if name != lead), "helping robot")
        told = infos[lead]
        label = dict(told.get("episode", {}))
        return Briefing(
            goal=str(told["goal"]),
            text=str(told["text"]),
            commands=tuple(told["commands"]),
            robots=robots,
            lead=lead,
            helper=helper or None,
            helpers=tuple(sorted(name for name in robots if name not in (lead, helper))),
            task=str(label.get("task", told["goal"])),
            episode=label,
            verbs={verb: tuple(commands) for verb, commands in told.get("verbs", {}).items()},
            goal_test=told.get("goal_test"),
            skills={name: skills_of(Commands(info["commands"]).values()) for name, info in infos.items()},
        )

    def _named(self, wanted: str | None, robots: tuple[str, ...], what: str) -> str:
        """The robot asked for, else the first by name; "" where there is none to choose from."""
        if wanted is not None:
            check_choice(what, wanted, robots)
            return wanted
        return min(robots, default="")


def _public_seed(briefing: Briefing) -> int:
    """A seed made of what roles are told anyway: nobody learns from it which start this is."""
    return int(digest([briefing.task, briefing.goal, briefing.text, sorted(briefing.commands)]), 16) % SEEDS
