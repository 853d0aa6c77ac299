"""The options of a kitchen, one row each, checked once before anything is built."""

from __future__ import annotations

from dataclasses import dataclass, fields

from remac_env.errors import OptionError
from remac_env.option_rows import Choice, Names, Real, Switch, Whole, Word, check_rows, option
from remac_env.quoting import quoted
from remac_env.skill_sources import SCRIPTED, SkillValues
from remac_env.thinking import ThinkValues
from remac_env.values import python_fields

BACKENDS = ("physics", "symbolic")
"""Who decides what comes of a round."""

STARTS = ("paper", "mixed")
"""How kitchens begin."""

KNOWLEDGE = ("full", "seen")
"""What robots know of where objects are."""

GRADES = (1, 2, 3, 4, 5)
"""Grades of generated tasks."""

MOST_QUIRKS = 3
"""Quirks that a generated task has at most."""

TEXTS = ("plain", "states")
"""What planners are told."""

FEEDBACKS = ("status", "reason")
"""What planners are told about a failure."""

NAMINGS = ("role", "category")
"""What objects are called that play a task's role: by the role's noun ("vegetable"), or as what they are ("carrot")."""

WORDINGS = (1, 2, 3)
"""1: word order follows the subtasks; 2: it does not; 3: the simplest sentence (paper, appendix)."""

OBSERVATIONS = ("state", "state+images")
"""Without pictures, or with."""

CAMERAS = ("front", "wrist", "side", "station")
"""Pictures of a robot: what each shows, `remac_env.sights` says."""

USUAL_CAMERAS = CAMERAS[:3]
"""Those that observations have unless others are asked for, and that controllers look at."""

REWARDS = ("sparse", "progress", "distance", "nearest")
"""See `remac_env/rewards.py`."""

MASKS = ("grammar", "feasible")
"""Which tokens masks mark."""

OBS_FORMATS = ("dict", "flat")
"""How observations come."""

CLOCKS = ("rounds", "events")
"""rounds: all robots begin and end together; events: each is asked again when what it does has ended."""

RENDER_MODES = (None, "rgb_array", "work", "human")
"""How an environment is looked at; None: not at all."""

MAX_ROBOTS = 4
"""Robots of a team at most."""

_ROBOTS, _WORDING = Whole(1, MAX_ROBOTS), Whole(min(WORDINGS), max(WORDINGS))


@dataclass(frozen=True)
class Options:
    """Keywords of `remac_env.parallel_env`."""

    robots: int = option(2, f"1 to {MAX_ROBOTS}; they are called robot_0, robot_1, ...", _ROBOTS)
    backend: str = option("physics", "physics (MuJoCo decides) or symbolic (the skill table).", Choice(BACKENDS))
    body: str = option(
        "panda", "The kind of robot: panda, another name that is known here, or yours: path/file.py:Name or "
        "package.module:Name.", Word(),
    )  # fmt: skip
    style: str | None = option(None, "Name of a style; by default the seed picks.")
    layout: str | None = option(None, "Name of a floor plan; by default the seed picks.")
    starts: str = option("paper", "paper (doors closed, all off) or mixed.", Choice(STARTS))
    grade: int | None = option(
        None, "Grade of generated tasks, 1 to 5: shortest known plans of at most 6, 12, 20, 40 and 80 rounds.",
        Whole(min(GRADES), max(GRADES)),
    )  # fmt: skip
    template: str | None = option(
        None, "Template of generated tasks, or from which the seed picks: held out, teams, physics (what physics can "
        "have too), physics teams, built (annexes in physics), built held out or built teams; by default all others.",
        Word(),
    )  # fmt: skip
    quirks: int = option(
        0, "How many facts about its kitchen a generated task hides: no text says them.", Whole(0, MOST_QUIRKS)
    )
    knowledge: str = option(
        "full", "What robots know of where objects are: full, or seen (what stands in the open, and what they have "
        "seen behind a door).", Choice(KNOWLEDGE),
    )  # fmt: skip
    obs: str = option(
        "state", "state or state+images (see cameras); jobs have images if a role looks at them.",
        Choice(OBSERVATIONS),
    )  # fmt: skip
    text: str = option("plain", "What planners are told: plain (names) or states.", Choice(TEXTS))
    feedback: str = option("status", "What planners are told about a failure: status or reason.", Choice(FEEDBACKS))
    wording: int = option(3, "Goal sentence 1, 2 or 3 (the simplest).", _WORDING)
    naming: str = option(
        "role", "What objects in a role are called: role (vegetable) or category (carrot); the goal sentence "
        "always uses the role's noun.", Choice(NAMINGS),
    )  # fmt: skip
    perception_noise: float = option(
        0.0, "Standard deviation of the error in the poses that controllers perceive, m (physics).", Real(0.0, 0.1)
    )
    image_size: int = option(
        128, "Width and height of observation images, pixels; jobs use 512, or what their roles need.", Whole(16, 1024)
    )
    cameras: str = option(
        ",".join(USUAL_CAMERAS), "Pictures of obs='state+images': front, wrist, side, station, with commas; jobs have "
        "those that their roles look at.", Names(CAMERAS),
    )  # fmt: skip
    render_mode: str | None = option(None, "human (watch), rgb_array or work (from near by).", Choice(RENDER_MODES))
    max_rounds: int = option(30, "Rounds after which an episode is truncated.", Whole(1, 100_000))
    reward: str = option(
        "sparse", "sparse (1 on success), progress (newly reached parts of the goal; 1 in all), "
        "distance (1 on success, plus the rounds by which the goal has come closer, by search) or nearest (the same "
        "for the robot that would reach it first alone; for teams that learn).", Choice(REWARDS),
    )  # fmt: skip
    masks: str = option(
        "grammar", "grammar (what names something in this kitchen) or feasible (also only what the skill table "
        "would not refuse now; for learners).", Choice(MASKS), spoken=False,
    )  # fmt: skip
    obs_format: str = option(
        "dict", "dict (observation, action_mask, pictures) or flat (the vector alone; masks in infos).",
        Choice(OBS_FORMATS), spoken=False,
    )  # fmt: skip
    failure_rate: float = option(0.0, "Probability that a subtask slips (symbolic).", Real(0.0, 1.0))
    skills: str = option(
        "scripted", "Who moves robots (physics): scripted, learned (the package's weights), a folder of weights, or "
        "SKILL=one of these with commas between them; skills without weights are scripted.", SkillValues(),
    )  # fmt: skip
    clock: str = option(
        "rounds", "rounds (all robots begin and end together) or events (each is asked again when it has ended).",
        Choice(CLOCKS),
    )  # fmt: skip
    max_seconds: float = option(
        300.0, "Simulated seconds after which an episode is truncated (clock='events').", Real(1.0, 86_400.0)
    )
    think: str = option(
        "off", "What thinking costs (clock='events'): off, fixed:S (seconds a command), tokens:S (seconds per 1,000 "
        "tokens) or recorded (the time that it took).", ThinkValues(),
    )  # fmt: skip

    interrupts: bool = option(
        False, "Robots at work may be told to stop (clock='events').", Switch(), spoken=False
    )  # fmt: skip

    def __post_init__(self) -> None:
        """Refuse values that are not offered.

        Raises:
            UnknownNameError: for a name that is not among the valid ones.
            OptionError: for a number outside its range.
        """
        python_fields(self)
        check_rows(self)
        if self.failure_rate and self.backend != "symbolic":
            raise OptionError("failure_rate is for backend='symbolic'; in physics use perception_noise")
        if self.skills != SCRIPTED and self.backend != "physics":
            given = f"skills={quoted(self.skills)} is for backend='physics'"
            raise OptionError(f"{given}; valid: {SCRIPTED!r}, as the skill table moves nothing")
        if self.think != "off" and self.clock != "events":
            given = f"think={self.think!r} is for clock='events'"
            raise OptionError(f"{given}; valid: 'off', as with clock='rounds' thinking costs nothing")
        if self.interrupts and self.clock != "events":
            raise OptionError("interrupts=True is for clock='events'; valid: False; in a round nobody is told anything")
        if self.obs_format == "flat" and self.obs != "state":
            raise OptionError(f"obs_format='flat' has no room for the pictures of obs={self.obs!r}; valid: obs='state'")

    @property
    def pictures(self) -> tuple[str, ...]:
        """Names of the pictures in observations, where there are any."""
        return tuple(self.cameras.split(",")) if self.obs == "state+images" else ()

    @property
    def chosen(self) -> list[str]:
        """The options that are not the default ones, as keywords: `backend='symbolic'`."""
        return [f"{f.name}={getattr(self, f.name)!r}" for f in fields(self) if getattr(self, f.name) != f.default]

    @property
    def robot_names(self) -> tuple[str, ...]:
        """`robot_0`, `robot_1`, ..."""
        return tuple(f"robot_{index}" for index in range(self.robots))
