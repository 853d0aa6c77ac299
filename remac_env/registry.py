"""Names and makers of environments. Importing this loads neither a simulator nor Gymnasium."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from remac_env.envs.gymnasium_ids import enter_ids
from remac_env.errors import check_choice
from remac_env.option_rows import takes_options
from remac_env.options import CLOCKS, Options
from remac_env.tasks import add, get, known, names, timed
from remac_env.tasks.generated import SPEC
from remac_env.tasks.spec import TaskSpec

if TYPE_CHECKING:
    from remac_env.envs.aec import KitchenAECEnv
    from remac_env.envs.event_aec import KitchenEventAEC
    from remac_env.envs.parallel import KitchenParallelEnv

GENERATED = SPEC.name


def _with_ids() -> dict[str, dict[str, str]]:
    """Task -> what it cannot be played without. Tasks that need the event clock have it by their ids."""
    return {name: {} for name in (*known(), GENERATED)} | {name: {"clock": "events"} for name in timed()}


def tasks(clock: str = "rounds") -> list[str]:
    """The names of all tasks that can be played by a clock: some need clock="events", and come last.

    Raises:
        UnknownNameError: for another clock.
    """
    check_choice("clock", clock, CLOCKS)
    return [*names(), *(timed() if clock == "events" else ())]


def register_task(spec: TaskSpec) -> None:
    """Add a task from outside, and its Gymnasium id.

    Raises:
        OptionError: if the name is taken, or the task's parts do not fit together.
        UnknownNameError: for a role, fixture, style, layout or command in it that does not exist.
        KitchenFileError: for a malformed layout file or category.
    """
    from remac_env.validate import validate

    validate(spec)
    add(spec)
    enter_ids(_with_ids)


def generate(
    grade: int,
    seed: int,
    *,
    template: str | None = None,
    quirks: int = 0,
    knowledge: str = "full",
    robots: int = 1,
) -> TaskSpec:
    """A task that was made for these values, with a plan that is known to reach its goal.

    `spec.generated` says what it was made from, the bounds of its shortest plan, how that is proven ("search": the
    upper bound is the optimum; "witness": it is that of a plan that works), how many facts no sentence tells, and its
    problem. The same as the task `Generated` with these options, which draws one for every seed.

    Args:
        grade: 1 to 5: shortest known plans of at most 6, 12, 20, 40 and 80 rounds, quirks aside.
        seed: whole number from 0.
        template: the name of one; "held out", "teams", "physics", "physics teams", "built", "built held out" and "built
            teams" draw from those; None from all others. Only those of the last five can be played in physics.
        quirks: how many facts about its kitchen nobody is told.
        knowledge: full or seen.
        robots: for how many it is certified.

    Raises:
        UnknownNameError, OptionError: for values that are not valid.
        SamplingError: where no task was found that fits, saying of each template why.
    """
    from remac_env.generator import make

    return make(
        grade=grade, seed=seed, template=template, quirks=quirks, knowledge=knowledge, robots=robots
    ).spec


@takes_options(Options)
def parallel_env(task: str | TaskSpec, **options: Any) -> KitchenParallelEnv:
    """A task as a PettingZoo ParallelEnv. Everything is checked before anything is built.

    Args:
        task: one of `tasks()`, `Generated`, or a TaskSpec.
        {options}

    Raises:
        UnknownNameError: for an unknown task, style, layout or option value; lists the valid ones.
        OptionError: for a number outside its range.
    """
    from remac_env.envs.making import make_kitchen
    from remac_env.validate import check_playable

    chosen = Options(**options)
    if not isinstance(task, TaskSpec):
        return make_kitchen(get(task), chosen)
    check_playable(task)
    return make_kitchen(task, chosen)


def env(task: str | TaskSpec, robots: int = 2, **options: Any) -> KitchenAECEnv | KitchenEventAEC:
    """The same as a PettingZoo AEC environment; keywords as for `parallel_env`.

    With clock="events" it is a native one: robots are asked when they are ready, and nobody is asked who is busy.
    """
    from remac_env.envs.aec import KitchenAECEnv
    from remac_env.envs.event_aec import KitchenEventAEC
    from remac_env.envs.event_parallel import KitchenEventEnv

    kitchen = parallel_env(task, robots, **options)
    return KitchenEventAEC(kitchen) if isinstance(kitchen, KitchenEventEnv) else KitchenAECEnv(kitchen)


enter_ids(_with_ids)
