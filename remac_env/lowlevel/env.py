"""One skill as a gymnasium.Env: a robot at its station, twenty actions a second, until the skill has succeeded."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.error import ResetNeeded
from numpy.typing import NDArray

from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.backends.physics.controllers.learned.seen import Entry, entries
from remac_env.errors import ActionError, PhysicsError, check_choice, whole_number
from remac_env.lowlevel.control import Control, Hand, Joints
from remac_env.lowlevel.drawing import CAMERAS, Drawing, moment
from remac_env.lowlevel.names import skill_named
from remac_env.lowlevel.options import SkillOptions, targets
from remac_env.lowlevel.starts import ROBOT, Ready, get_ready
from remac_env.quoting import quoted
from remac_env.robots import bodies
from remac_env.seeding import SEED_MAX

_SEEDS = 100_000  # from which seeds of resets without one are drawn

Observation = NDArray[np.float32] | dict[str, NDArray[Any]]


class SkillEnv(gymnasium.Env[Any, Any]):
    """A skill as a Gymnasium environment; made by `gymnasium.make("RemacSkill-PickUp-v0", target="vegetable")`.

    Action: Box(-1, 1), what `action_names` says, for 0.05 s. Observation: Box, what `observation_names` says; with
    obs="state+images" a dict of `state` and the pictures `front`, `wrist` and `side` (uint8). An episode ends with
    success; Gymnasium cuts it off after 60 s.

    Attributes:
        action_names, observation_names: name, unit and range of each number.
        task_description: the present command as text.
    """

    metadata = {"render_modes": ["rgb_array", "work", "human"], "render_fps": 20}

    def __init__(self, skill: str, **options: Any) -> None:
        self._skill, self._options = skill_named(skill), SkillOptions(**options)
        if self._options.target is not None:
            check_choice(f"target of {skill}", self._options.target, targets(self._skill))
        self.render_mode = self._options.render_mode
        body = bodies.get(self._options.body)
        self._control: Control = Joints(body) if self._options.control == "joints" else Hand(body)
        self.action_names: tuple[Entry, ...] = self._control.names
        self.observation_names: tuple[Entry, ...] = entries(self._skill, self._options.body)
        self.action_space = spaces.Box(-1.0, 1.0, (len(self.action_names),), np.float32)
        self.observation_space = self._space()
        self._backends: dict[str, PhysicsBackend] = {}
        self._drawing = Drawing()
        self._ready: Ready | None = None
        self._running = False

    @property
    def task_description(self) -> str:
        """The command as text, "" before reset."""
        return "" if self._ready is None else self._ready.subtask.text

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin the episode of this seed; without one, draw it.

        Args:
            seed: the start depends on it alone, and on style, layout, skill and target.
            options: may hold "style" and "layout" for this episode; other keys are ignored, as in the task's.

        Raises:
            OptionError: if the seed is not a whole number in 0..2**63-1.
            UnknownNameError: for a style or layout that does not exist.
            SamplingError: if no start is found in which the skill can begin.
        """
        if seed is not None:
            seed = whole_number("seed", seed, 0, SEED_MAX)
        given = dict(options or {})
        super().reset(seed=seed)
        chosen = int(self.np_random.integers(_SEEDS)) if seed is None else seed
        self._ready, self._backend = get_ready(
            self._backends, self._skill, self._options.target, chosen,
            style=given.get("style", self._options.style), layout=given.get("layout", self._options.layout),
            body=self._options.body,
        )  # fmt: skip
        self._manual = self._backend.by_hand(ROBOT, self._ready.subtask)
        self._control.begin(self._manual)
        self._running, self._progress = True, self._manual.progress
        return self._observation(), self._info() | {"start": self._told(chosen)}

    def step(self, action: NDArray[np.float32]) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Run one control period. Numbers beyond -1..1 count as -1 or 1.

        Raises:
            gymnasium.error.ResetNeeded: before reset or after the end of the episode.
            ActionError: for an action of another shape, or with a number that is not finite; nothing has changed then.
        """
        if not self._running:
            raise ResetNeeded("step() needs an episode under way: call reset() first")
        values = self._checked(action)
        before, broken = self._progress, ""
        try:
            self._manual.command(*self._control.apply(values))
        except PhysicsError as error:
            broken = str(error)
        success = not broken and self._manual.success
        self._progress = before if broken else self._manual.progress
        self._running = not (success or broken)
        reward = self._progress - before if self._options.reward == "progress" else float(success)
        info = self._info() | ({"broken": broken} if broken else {})
        return self._observation(), float(reward), success, bool(broken), info

    def render(self) -> Any:
        """The kitchen, uint8 (432, 768, 3); "work": the robot at work (648, 768, 3); "human": a window shows it."""
        if self._ready is None:
            raise ResetNeeded("render() needs an episode under way: call reset() first")
        if self.render_mode is None:
            return None
        now = moment(self._ready, self._manual, self._backend)
        return self._drawing.of(self._ready).render(now, self.render_mode)

    def close(self) -> None:
        """Free the simulator and the renderer. May be called twice."""
        self._running = False
        for backend in self._backends.values():
            backend.close()
        self._backends.clear()
        self._drawing.close()

    def _space(self) -> spaces.Space[Any]:
        low, high = (np.array([getattr(e, end) for e in self.observation_names], np.float32) for end in ("low", "high"))
        state = spaces.Box(low, high, dtype=np.float32)
        if self._options.obs == "state":
            return state
        size = self._options.image_size
        pictures = {name: spaces.Box(0, 255, (size, size, 3), np.uint8) for name in CAMERAS}
        return spaces.Dict({"state": state, **pictures})

    def _checked(self, action: Any) -> NDArray[np.float32]:
        try:
            values = np.asarray(action, np.float32)
        except (TypeError, ValueError, OverflowError) as error:
            valid = f"valid: {len(self.action_names)} numbers"
            raise ActionError(f"action {quoted(action)} is not valid; {valid}") from error
        if values.shape != self.action_space.shape:
            raise ActionError(f"action of shape {values.shape} is not valid; valid: ({len(self.action_names)},)")
        if not np.isfinite(values).all():
            bad = [entry.name for entry, value in zip(self.action_names, values, strict=True) if not np.isfinite(value)]
            raise ActionError(f"action is not finite in {', '.join(bad)}; valid: numbers in -1..1")
        return values

    def _observation(self) -> Observation:
        state = self._manual.observe()
        if self._options.obs == "state":
            return state
        size = self._options.image_size
        return {"state": state, **self._drawing.observe(self._begun(), self._manual, self._backend, size=size)}

    def _info(self) -> dict[str, Any]:
        ready = self._begun()
        return {
            "is_success": self._manual.success,
            "progress": self._manual.progress,
            "command": ready.subtask.text,
            "token": ready.worlds.vocabulary.encode(ready.subtask.text),
        }

    def _told(self, seed: int) -> dict[str, Any]:
        """Which start this is; under "start", as learners put statistics of their own under "episode"."""
        ready = self._begun()
        start = ready.start
        return {
            "seed": seed, "task": ready.worlds.spec.name, "style": start.style, "layout": start.layout,
            "target": ready.subtask.target, "digest": start.digest, "before": [step.text for step in ready.before],
        }  # fmt: skip

    def _begun(self) -> Ready:
        if self._ready is None:
            raise ResetNeeded("this needs an episode under way: call reset() first")
        return self._ready

