"""A task of your own with instances of a kind, a choice of places, a stated start and a quirk."""
import remac_env
from remac_env.rules.facts import Quirk
from remac_env.state import Place
from remac_env.tasks.compound import AnyOf, ForAll
from remac_env.tasks.goals import Inside
from remac_env.tasks.setup import Setup
from remac_env.tasks.spec import Role, TaskSpec
from remac_env.testing import check_task

mugs = {"red mug": Place("slot", "counter.0"), "blue mug": Place("slot", "counter.1")}
goal = ForAll("mug", AnyOf(Inside("{each}", "pantry"), Inside("{each}", "chest")), tuple(mugs))
spec = TaskSpec(
    name="MugsAway", goal=goal, wordings=(goal.told(1), goal.told(2), goal.told(3)), fixtures=("pantry", "chest"),
    roles=tuple(Role(n, (n,)) for n in mugs), nouns=remac_env.generate(1, 0).nouns, annexes=("pantry", "chest"),
    quirks=(Quirk("jammed door", "pantry"),), setup=Setup(dict.fromkeys(mugs, "mug"), mugs),
)  # fmt: skip
if __name__ == "__main__":
    check_task(spec, seeds=[0], robots=[1], starts=["paper"], rounds=8)
    print(f"{spec.name} passes every check: {spec.wordings[2]}")
