"""A task as a robosuite environment."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
import robosuite.macros as macros
from robosuite.environments.base import REGISTERED_ENVS
from robosuite.environments.manipulation.manipulation_env import ManipulationEnv
from robosuite.models.tasks import ManipulationTask
from robosuite.utils.observables import Observable

from remac_env.backends.physics.simulation import CONTROL_PERIOD
from remac_env.backends.physics.stage import pose_start
from remac_env.backends.physics.truth import Truth
from remac_env.errors import ActionError, PhysicsError, check_choice, whole_number
from remac_env.integrations.robosuite.arena import KitchenArena, recorded_facts
from remac_env.integrations.robosuite.episode import Cell, Episode, draw, redraw
from remac_env.integrations.robosuite.reading import Reading, check_robots
from remac_env.integrations.robosuite.sensors import task_sensors
from remac_env.integrations.robosuite.textures import missing, textures_here
from remac_env.kitchen.builder import show_switches
from remac_env.kitchen.starts import NAMINGS, STARTS
from remac_env.kitchen.worlds import TaskWorlds
from remac_env.options import MAX_ROBOTS
from remac_env.seeding import KEPT_SEEDS, SEED_MAX, generator
from remac_env.state import WorldState, switches_on
from remac_env.tasks.goals import progress
from remac_env.tasks.spec import TaskSpec

_MOUNT = "manipulator_mount"
"""A body to which robosuite 1.5.2 gives the same name in every mobile robot, so that a model could hold but one."""


class RemacKitchen(ManipulationEnv):  # type: ignore[misc]
    """A kitchen task in robosuite: `robosuite.make("RemacKitchen<Task>", robots=["PandaOmron", "PandaOmron"])`.

    Actions, controllers, cameras and wrappers are robosuite's; what is observed beside is told by
    `sensors.task_sensors`. An episode ends after `horizon` steps; `info` has `success` and `progress`.

    Args:
        robots: names of one to four of robosuite's robots with one gripper of two fingers. "PandaOmron" fits the
            kitchens: it is the body for which they are made.
        seed: of the start, which every reset brings back exactly; None draws another start for each hard reset.
            `set_seed` changes it. A start is the one that `remac_env.parallel_env(task).reset(seed=seed)` has.
        style: as for `remac_env.parallel_env`.
        layout: as for `remac_env.parallel_env`.
        starts: as for `remac_env.parallel_env`.
        naming: as for `remac_env.parallel_env`.
        looks: whether kitchens are drawn; without, a step is quicker and pictures show the robots alone.
        use_object_obs: whether objects and fixtures are observed.
        reward_shaping: the fraction of the goal's parts that hold, instead of 1 once the goal holds.
        reward_scale: factor on the reward.
        options: robosuite's, such as controller_configs, camera_names, horizon, hard_reset.

    Raises:
        UnknownNameError: for a style, layout, kind of start or naming that does not exist.
        OptionError: for a seed out of range, or robots that do not fit.
    """

    SPEC: ClassVar[TaskSpec]
    hard_reset: bool
    episode: Episode

    def __init__(
        self,
        robots: str | Sequence[str],
        *,
        seed: int | None = None,
        style: str | None = None,
        layout: str | None = None,
        starts: str = "paper",
        naming: str = "role",
        looks: bool = True,
        use_object_obs: bool = True,
        reward_shaping: bool = False,
        reward_scale: float = 1.0,
        **options: Any,
    ) -> None:
        check_choice("starts", starts, STARTS)
        check_choice("naming", naming, NAMINGS)
        self._worlds = TaskWorlds(self.SPEC)
        self._worlds.check_cell(style, layout)
        self._options: dict[str, Any] = {"style": style, "layout": layout, "starts": starts, "naming": naming}
        self._seeds = np.random.default_rng()
        self._visual, self.use_object_obs = bool(looks), bool(use_object_obs)
        self.reward_shaping, self.reward_scale = bool(reward_shaping), float(reward_scale)
        # As robosuite's own tasks have it.
        super().__init__(robots=robots, seed=_checked(seed), **{"initialization_noise": "default", **options})

    # -- which start ------------------------------------------------------------------------------------------------

    def set_seed(self, seed: int | None) -> None:
        """Have the start of this seed from the next reset on; None: another one for each hard reset."""
        self.seed = _checked(seed)

    def reset(self) -> Any:
        """Begin the start of the seed, or of a recording's facts (`set_ep_meta`); returns the observations."""
        hard = self.hard_reset
        wanted = None if self.deterministic_reset else self._wanted()
        self.hard_reset = hard or (wanted is not None and wanted.cell != self.episode.cell)
        try:
            return super().reset()
        finally:
            self.hard_reset = hard

    def reset_from_xml_string(self, xml_string: str) -> None:
        """Load a recorded model, and with it the episode that it is of; its states are then to be set.

        Raises:
            OptionError: if that start is another one today.
        """
        facts, hard = recorded_facts(xml_string), self.hard_reset
        if facts and facts != self.episode.facts:
            episode = redraw(self._worlds, facts, self.num_robots)
            super()._load_model()
            self._put_together(episode)
        if missing(self.edit_model_xml(xml_string)):
            KitchenArena(self.episode, visual=True)  # writes its textures
        self.hard_reset = True  # what is observed are the objects of this episode
        try:
            super().reset_from_xml_string(xml_string)
        finally:
            self.hard_reset = hard

    def get_ep_meta(self) -> dict[str, Any]:
        """Facts of the episode: `lang`, its sentence, and `remac`, from which `set_ep_meta` brings it back."""
        return {**super().get_ep_meta(), "lang": self.episode.sentence, "remac": self.episode.facts}

    def _wanted(self) -> Episode | None:
        """The episode that has been asked for, None where a new one may be drawn."""
        if "remac" in self._ep_meta:
            return redraw(self._worlds, self._ep_meta["remac"], self.num_robots)
        return None if self.seed is None else draw(self._worlds, self._cell(self.seed))

    def _cell(self, seed: int) -> Cell:
        return Cell(seed=seed, robots=self.num_robots, **self._options)

    # -- the model --------------------------------------------------------------------------------------------------

    def _check_robot_configuration(self, robots: Any) -> None:
        """Refuse more robots than a kitchen has room for."""
        whole_number("number of robots", len(robots) if isinstance(robots, list | tuple) else 1, 1, MAX_ROBOTS)

    def _load_model(self) -> None:
        """Draw the episode, and put its kitchen and the robots together."""
        super()._load_model()
        check_robots(self.robots)
        self._put_together(
            self._wanted() or draw(self._worlds, self._cell(int(self._seeds.integers(KEPT_SEEDS))))
        )

    def _put_together(self, episode: Episode) -> None:
        """Make the model of an episode's kitchen, with the robots that were just loaded at their places."""
        self.episode = episode
        start, asides = self.episode.start, self.episode.layout.asides
        for robot, (index, offset) in zip(self.robots, start.robots.values(), strict=True):
            for body in robot.robot_model.root.iter("body"):
                if body.get("name") == _MOUNT:
                    body.set("name", f"{robot.robot_model.naming_prefix}{_MOUNT}")
            place = asides[index]
            robot.robot_model.set_base_xpos([place.x + offset.dx, place.y + offset.dy, 0.0])
            robot.robot_model.set_base_ori([0.0, 0.0, place.yaw + offset.yaw])
        arena = KitchenArena(self.episode, visual=self._visual)
        self.model = ManipulationTask(mujoco_arena=arena, mujoco_robots=[robot.robot_model for robot in self.robots])
        arena.rule(self.model, macros.SIMULATION_TIMESTEP)

    def edit_model_xml(self, xml_str: str) -> str:
        """A recorded model with its files as they are called on this machine."""
        return textures_here(super().edit_model_xml(xml_str))

    def _reset_internal(self) -> None:
        """Pose the start. Robots are posed by robosuite, with noise that depends on the seed alone."""
        self.rng = generator(self.episode.cell.seed, "robosuite")
        super()._reset_internal()
        episode = self.episode
        self._bodies = Reading(self.sim, dict(zip(episode.start.scene.robots, self.robots, strict=True)))
        if not self.deterministic_reset:  # else a recorded state is about to be set
            pose_start(self._bodies, episode.layout, episode.objects, episode.start)
        self._truth = Truth(self._bodies, episode.start, episode.layout, episode.objects)
        self._substeps, self._period = 0, max(1, round(CONTROL_PERIOD / self.model_timestep))
        self._shown: frozenset[str] = frozenset()
        self._show(self.world)

    # -- what is true -----------------------------------------------------------------------------------------------

    @property
    def world(self) -> WorldState:
        """The truth about the kitchen now; also where a state has been set from outside (see `update_state`)."""
        return self._truth.read()

    def update_state(self) -> None:
        """Take a state that was set from outside into account, as robosuite's step does of itself.

        Called for each state of a recording, in order, 20 a second, it sees buttons being pressed and shakers shaken.
        """
        self._truth.update()
        self._show(self._truth.read())

    def step(self, action: Any) -> tuple[Any, float, bool, dict[str, Any]]:
        """One control step; see robosuite. `action`, (action_dim,) in `action_spec`, is left as it is.

        Raises:
            ActionError: for an action of another shape, or that is not finite.
            PhysicsError: if the simulation has become unstable.
        """
        # A copy, for robosuite writes into what it is given: recordings would hold what nobody commanded.
        taken = np.array(action, float)
        if taken.shape != (self.action_dim,) or not np.isfinite(taken).all():
            raise ActionError(f"action {action!r} is not valid; valid: {self.action_dim} finite numbers")
        observations, reward, done, info = super().step(taken)
        if self._bodies.data.warning.number.any():
            raise PhysicsError(f"MuJoCo warned after {self.timestep} steps: {', '.join(self._bodies.warnings())}")
        return observations, reward, done, info

    def _pre_action(self, action: Any, policy_step: bool = False) -> None:
        """Called before every step of the simulation; what happens is watched 20 times a second."""
        super()._pre_action(action, policy_step)
        self._substeps += 1
        if self._substeps % self._period == 0:
            self.update_state()

    def _post_action(self, action: Any) -> tuple[float, bool, dict[str, Any]]:
        """Reward, whether the episode has ended, and whether and how far the goal is reached."""
        reward, done, info = super()._post_action(action)
        scene, world = self.episode.start.scene, self.world
        facts = {
            "success": self.episode.goal.holds(scene, world),
            "progress": progress(self.episode.goal, scene, world),
        }
        return reward, done, {**info, **facts}

    def _check_success(self) -> bool:
        """Whether the goal holds."""
        return bool(self.episode.goal.holds(self.episode.start.scene, self.world))

    def reward(self, action: Any = None) -> float:
        """1 once the goal holds; with `reward_shaping` the fraction of it that holds, 0..1; times `reward_scale`."""
        scene, world = self.episode.start.scene, self.world
        if self.reward_shaping:
            return self.reward_scale * progress(self.episode.goal, scene, world)
        return self.reward_scale * float(self.episode.goal.holds(scene, world))

    # -- what is seen -----------------------------------------------------------------------------------------------

    def _setup_observables(self) -> Any:
        """robosuite's observables, and those of the task."""
        observables = super()._setup_observables()
        if self.use_object_obs:
            sensors = task_sensors(
                self.episode, self.SPEC.fixtures, self.num_robots, lambda: self._bodies, self._switched
            )
            for name, read in sensors:
                observables[name] = Observable(name=name, sensor=read, sampling_rate=self.control_freq)
        return observables

    def _switched(self, fixture: str) -> list[float]:
        """Of each switch of a fixture, 1 where it is on."""
        on = self._truth.seen().fixtures[fixture].on
        return [float(switch in on) for switch in self.episode.layout.fixtures[fixture].switches]

    def _show(self, world: WorldState) -> None:
        """Let water, flames and lamps be seen where something is on."""
        on = switches_on(world)
        if self._visual and on != self._shown:
            show_switches(self._bodies.model, on)
        self._shown = on


def _checked(seed: int | None) -> int | None:
    """A seed in range, or None."""
    return None if seed is None else whole_number("seed", seed, 0, SEED_MAX)


REGISTERED_ENVS.pop(RemacKitchen.__name__, None)  # no task of its own
