"""A kitchen of your own, with a kind of fixture that the built-in ones lack: a drawer, and a task to go with it."""

from pathlib import Path

import remac_env
from remac_env.tasks.goals import All, DoorIs, Inside, Released
from remac_env.tasks.spec import Role, TaskSpec
from remac_env.testing import check_task
from remac_env.vocabulary import Noun

goal = All(Inside("{food}", "drawer"), DoorIs("drawer", "closed"), Released("{food}"))
drawer = Noun("drawer", "fixture", ("place to", "open door", "close door"))
layout = {"drawer_kitchen": str(Path(__file__).with_name("drawer_kitchen.toml"))}
words = ("put the {food} into the drawer and close it",) * 3
spec = TaskSpec("PotatoToDrawer", words, goal, (Role("food", ("potato",)),), ("counter", "drawer"),
                layouts=tuple(layout), nouns=(drawer,), layout_files=layout)  # fmt: skip
remac_env.register_task(spec)  # remac bench run --import examples/fixture.py --tasks PotatoToDrawer --out runs/mine
if __name__ == "__main__":
    check_task(spec, seeds=[0])
    print("PotatoToDrawer passes every check")
