"""A task of your own, with the checks that every task must pass."""

import remac_env
from remac_env.tasks.goals import All, Inside, Released
from remac_env.tasks.spec import Role, TaskSpec
from remac_env.testing import check_task

spec = TaskSpec(
    name="PotatoToSink",
    wordings=("pick up the {food} and place it into the sink",) * 2 + ("place the {food} into the sink",),
    goal=All(Inside("{food}", "sink"), Released("{food}")),
    roles=(Role("food", ("potato",)),),
    fixtures=("counter", "sink"),
)
remac_env.register_task(spec)  # remac bench run --import examples/task.py --tasks PotatoToSink --out runs/mine
if __name__ == "__main__":
    check_task(spec, seeds=[0])
    print("PotatoToSink passes every check")
