"""The options of a kitchen, checked once before anything is built."""

from __future__ import annotations

from dataclasses import dataclass

from remac_env.errors import OptionError, check_choice, real_number, whole_number
from remac_env.kitchen.starts import NAMINGS, STARTS
from remac_env.tasks.spec import WORDINGS
from remac_env.text import FEEDBACKS, TEXTS
from remac_env.values import python_fields

BACKENDS = ("physics", "symbolic")
OBSERVATIONS = ("state", "state+images")
REWARDS = ("sparse", "progress")
RENDER_MODES = (None, "rgb_array", "human")
MAX_ROBOTS = 2


@dataclass(frozen=True, kw_only=True)
class Options:
    """Keywords of `remac_env.parallel_env`; see there for what each does."""

    robots: int = 2
    backend: str = "physics"
    style: str | None = None
    layout: str | None = None
    starts: str = "paper"
    obs: str = "state"
    text: str = "plain"
    feedback: str = "status"
    wording: int = 3
    naming: str = "role"
    perception_noise: float = 0.0
    image_size: int = 128
    render_mode: str | None = None
    max_rounds: int = 30
    reward: str = "sparse"
    failure_rate: float = 0.0

    def __post_init__(self) -> None:
        """Refuse values that are not offered.

        Raises:
            UnknownNameError: for a name that is not among the valid ones.
            OptionError: for a number outside its range.
        """
        python_fields(self)
        check_choice("backend", self.backend, BACKENDS)
        check_choice("starts", self.starts, STARTS)
        check_choice("obs", self.obs, OBSERVATIONS)
        check_choice("text", self.text, TEXTS)
        check_choice("feedback", self.feedback, FEEDBACKS)
        check_choice("naming", self.naming, NAMINGS)
        check_choice("reward", self.reward, REWARDS)
        check_choice("render_mode", self.render_mode, RENDER_MODES)
        self._check_whole("wording", min(WORDINGS), max(WORDINGS))
        self._check_whole("robots", 1, MAX_ROBOTS)
        self._check_whole("image_size", 16, 1024)
        self._check_whole("max_rounds", 1, 100_000)
        self._check_real("perception_noise", 0.0, 0.1)
        self._check_real("failure_rate", 0.0, 1.0)
        if self.failure_rate and self.backend != "symbolic":
            raise OptionError("failure_rate is for backend='symbolic'; in physics use perception_noise")

    def _check_whole(self, name: str, least: int, most: int) -> None:
        object.__setattr__(self, name, whole_number(name, getattr(self, name), least, most))

    def _check_real(self, name: str, least: float, most: float) -> None:
        object.__setattr__(self, name, real_number(name, getattr(self, name), least, most))

    @property
    def robot_names(self) -> tuple[str, ...]:
        """`robot_0`, `robot_1`, ..."""
        return tuple(f"robot_{index}" for index in range(self.robots))
