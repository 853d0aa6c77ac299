"""What is put to roles and what they answer, as frozen values: requests, the moment as a role sees it, replies."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from remac_agents.plan import Plan
from remac_agents.roles.accounts import Attempt, PreviousTry, Ran, Repair
from remac_env.rules.conditions import Condition
from remac_env.rules.facts import Rules
from remac_env.rules.scene import PublicScene
from remac_env.rules.subtasks import Subtask
from remac_env.state import WorldState
from remac_env.tasks.goals import Goal

ANSWERS = 3
"""How often a question is put: an answer that is of no use is sent back twice, with all that is wrong with it."""

Ask = Callable[[Condition], bool | None]
"""A question to the checker about the moment at hand; None: it cannot tell."""

Images = Mapping[str, Mapping[str, Any]]
"""Robot -> camera -> picture, shape (height, width, 3), uint8."""


@dataclass(frozen=True)
class Report:
    """How a robot's last subtask ended.

    Attributes:
        status: success or failure.
        reason: why it failed, where the kitchen's feedback says it.
        subtask: which it was; "": not known.
    """

    status: str
    reason: str | None = None
    subtask: str = ""


@dataclass(frozen=True)
class View:
    """What a role sees at one moment: the `goal`'s sentence, and the `scene`, which names all that can be named.

    `holding` is what every robot feels in its own gripper; `reports` how its last subtask ended, None before the first;
    `images` are the pictures of a role that asks for them, robot -> camera -> uint8 (size, size, 3).
    `text`: what the kitchen says of itself now, "" where nobody passed it on. `rules` and `world`: for roles that need
    them. `robot`, `ran`: whose subtask is checked ("": nobody's), and what was run so far, for checkers.
    `ready`: the robots that are to decide now; under the event clock `clock` is what it shows, s, and `running` what
    the others are at, robot -> command or "thinking". `slow`: what takes its time by itself, in words -> for how long
    it has gone on, s. `unseen`: the objects of which nobody knows where they are.
    """

    goal: str
    scene: PublicScene
    holding: Mapping[str, str | None]
    reports: Mapping[str, Report | None] = field(default_factory=dict)
    images: Images = field(default_factory=dict)
    world: WorldState | None = None
    text: str = ""
    rules: Rules | None = None
    robot: str = ""
    ran: tuple[Ran, ...] = ()
    ready: tuple[str, ...] = ()
    clock: float | None = None
    running: Mapping[str, str] = field(default_factory=dict)
    unseen: tuple[str, ...] = ()
    slow: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class PlanRequest:
    """What a planner is given.

    Attributes:
        goal: the goal sentence.
        scene: what the kitchen says of itself, as text; `facts` are the same facts as values.
        robots: whom to plan for; `lead` is the one whose row a bare list of commands is.
        commands: every legal command.
        reflections: what earlier iterations taught, oldest first.
        previous_plan: robot -> commands of the iteration before, if any.
        previous: the same iteration with how it went.
        executed: robot -> commands run so far in this episode.
        ran: the same commands in order, and how each ended.
        failure: why the last reply was no plan or its step was refused, "" at first.
        refusal: of that only why a step was refused (CAPE).
        repairs: this request's answers that were not plans, oldest first, and all that is wrong with each.
        holding: what each robot feels in its gripper.
        history: steps run and refused so far, oldest first, where the method tells them.
        single_step: only the next step is wanted; an empty answer or `done` ends the episode.
        explanation: why the episode failed so far; a corrected plan from the present state is wanted.
        events: the episode so far, one line an event, where `explanation` is given.
        images: pictures by robot and camera.
        verbs: goal verb -> commands that the verb itself implies.
        episode: the name of the task, under "task"; nothing that leads to this very start.
        rules: for planners that need them.
        world, goal_test: the truth and what is to become true, for planners that need it.
        question, skills, subtasks: "plan", or for SMART-LLM "decompose" or "allocate", robot -> its skills
            and the decomposition that is to be allocated, a mapping a subtask (docs/planners.md). "act": only the
            leading robot's next command is wanted (ReAct).
        teammates: robot -> the command that it is at or has just been given, where a robot is asked for by itself.
        slow: what takes its time by itself, in words -> for how long it has gone on, s.
    """

    goal: str
    scene: str
    facts: PublicScene
    robots: tuple[str, ...]
    lead: str
    commands: tuple[str, ...]
    reflections: tuple[str, ...] = ()
    previous_plan: Mapping[str, tuple[str, ...]] | None = None
    executed: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    failure: str = ""
    holding: Mapping[str, str | None] = field(default_factory=dict)
    history: tuple[Attempt, ...] = ()
    single_step: bool = False
    explanation: str = ""
    events: tuple[str, ...] = ()
    images: Images = field(default_factory=dict)
    verbs: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    episode: Mapping[str, Any] = field(default_factory=dict)
    world: WorldState | None = None
    goal_test: Goal | None = None
    rules: Rules | None = None
    previous: PreviousTry | None = None
    ran: tuple[Ran, ...] = ()
    refusal: str = ""
    repairs: tuple[Repair, ...] = ()
    question: str = "plan"
    skills: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    subtasks: tuple[Mapping[str, Any], ...] = ()
    teammates: Mapping[str, str] = field(default_factory=dict)
    slow: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Verdict:
    """A checker's answer to one `condition`, and the `reason` where it gives one.

    `value` None: it cannot tell, which is not false: the method goes on, and the record holds None beside the truth.
    """

    condition: Condition
    value: bool | None
    reason: str = ""


@dataclass(frozen=True)
class AdjustRequest:
    """A plan that met false pre-conditions.

    Attributes:
        failed: the conditions that were found false.
        subtask: what `robot` was to do next; the first of its row in `plan`.
        plan: what remains of the plan, for all robots.
        executed: the robot's subtasks so far, without their retries.
        ran: every command so far of every robot, and how each ended.
        previous: the iteration before this one and how that went, where the method learns and there was one.
        commands: every legal command.
        view: the moment.
        ask: puts further conditions to the checker.
    """

    failed: tuple[Condition, ...]
    subtask: Subtask
    robot: str
    plan: Plan
    executed: tuple[Subtask, ...]
    commands: tuple[str, ...]
    view: View
    ask: Ask
    ran: tuple[Ran, ...] = ()
    previous: PreviousTry | None = None


@dataclass(frozen=True)
class Advice:
    """The paper's analysis and adjustment.

    Attributes:
        reason: why the pre-conditions failed, in words.
        next_steps: the recommended steps, to be run before the rest of the old plan.
        row: the robot's whole new row; None means the recommended steps and then the old row.
        remedy: the steps that, done in time, would have made the failed condition true (for the reflection).
        instead: a subtask that should stand where the failed one stands.
        left_out: True when the failed subtask has nothing left to do.
    """

    reason: str
    next_steps: tuple[Subtask, ...] = ()
    row: tuple[Subtask, ...] | None = None
    remedy: tuple[Subtask, ...] = ()
    instead: Subtask | None = None
    left_out: bool = False


@dataclass(frozen=True)
class ReflectRequest:
    """A pre-check that failed, and what was made of it.

    Attributes:
        goal: the sentence.
        failed: the conditions that were called false, before `subtask` of `robot`.
        held: what the robot held then.
        advice: what the adjuster said.
        view: what was seen then.
    """

    goal: str
    failed: tuple[Condition, ...]
    subtask: Subtask
    robot: str
    held: str | None
    advice: Advice
    view: View


@dataclass(frozen=True)
class HandoverRequest:
    """A single-robot plan that succeeded, to be shared by a team.

    Attributes:
        goal: the sentence.
        plan: the row of the leading robot, `lead`, of the single-robot plan.
        helper: the robot that helps, or the first of those that do.
        reflections: the recorded lessons that shaped it.
        commands: what can be said in this kitchen.
        view: the start of this episode.
        helpers: further robots that help.
        untried: no other iteration follows, and no team has done this task yet.
        kept: steps of the plan that come undone by themselves unless a robot stays there.
        failing: steps of the plan, at switches, that never came about for a robot alone.
    """

    goal: str
    plan: tuple[Subtask, ...]
    lead: str
    helper: str
    reflections: tuple[str, ...]
    commands: tuple[str, ...]
    view: View
    helpers: tuple[str, ...] = ()
    untried: bool = False
    kept: tuple[Subtask, ...] = ()
    failing: tuple[Subtask, ...] = ()

    @property
    def team(self) -> tuple[str, ...]:
        """All robots that share, the leading one first."""
        return (self.lead, self.helper, *self.helpers)
