"""Whether a robot can handle every category of objects: `python benchmarks/certify_objects.py --trials 3`.

For each category, over seeds: pick it up from a worktop, put it back, pick it up again and put it into the bowl and
take it out (what is small enough) or into the open cabinet (the rest). Each step counts at its first try.
"""

from __future__ import annotations

from collections import defaultdict

from module_trials import OwnCategories
from remac_bench.columns import show
from remac_bench.command import run_script
from remac_bench.console import say
from remac_bench.flags import takes
from rich.table import Table

from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.kitchen.objects import catalogue
from remac_env.tasks.goals import Inside
from remac_env.tasks.spec import Role, TaskSpec

ROBOT = "robot_0"
AGAIN = ("pick up {0}", "navigate to counter", "place to counter", "navigate to {0}", "pick up {0}")
INTO_BOWL = ("navigate to bowl", "place to bowl", "pick up {0}", "navigate to counter", "place to counter")
INTO_CABINET = ("navigate to cabinet", "place to cabinet")
INTO_VESSEL = {"plate": "cabinet", "bowl": "sink", "pan": "stove"}


def steps(category: str) -> list[str]:
    """The chain of a category's subtasks."""
    facts = catalogue.get(category)
    if facts.holds:
        place = INTO_VESSEL[category]
        door = ["navigate to cabinet", "open cabinet door"] if place == "cabinet" else []
        chain = (*door, "navigate to {0}", *AGAIN, f"navigate to {place}", f"place to {place}")
    elif facts.small:
        chain = ("navigate to {0}", *AGAIN, *INTO_BOWL)
    else:
        chain = ("navigate to cabinet", "open cabinet door", "navigate to {0}", *AGAIN, *INTO_CABINET)
    return [text.format(category) for text in chain]


def trial(category: str, seed: int, body: str) -> str:
    """Run the chain once: "" where every step succeeded at its first try, else the first failure."""
    roles = [Role("object", (category,))]
    if catalogue.get(category).small:
        roles.append(Role("bowl", ("bowl",)))
    spec = TaskSpec(
        "ObjectChain", ("", "", ""), Inside("{object}", "fridge"), tuple(roles), fixtures=(), distractors=(0, 0)
    )
    worlds = OwnCategories(spec)
    start, _ = worlds.start(
        seed, style=None, layout=None, starts="paper", robots=(ROBOT,), perception_noise=0.0, body=body
    )
    backend = PhysicsBackend()
    backend.reset(start)
    for text in steps(category):
        subtask = worlds.vocabulary.subtask(worlds.vocabulary.encode(text))
        outcome = backend.run_round({ROBOT: subtask}).outcomes[ROBOT]
        if not outcome.success:
            return f"seed {seed}: {text}: {outcome.reason}: {outcome.detail}"
    return ""


@takes("certify_objects.trials", "script.first_seed", "certify_objects.only", "script.body")
def main(*, trials: int, first_seed: int, only: str, body: str) -> None:
    """Print a table of categories and every failure."""
    names = [name.strip() for name in only.split(",") if name.strip()] or list(catalogue.load())
    failures: dict[str, list[str]] = defaultdict(list)
    for name in names:
        for seed in range(first_seed, first_seed + trials):
            if problem := trial(name, seed, body):
                failures[name].append(problem)
                say(f"{name}: {problem}")
    table = Table("category", "trials", "without a failure", title=f"Handling objects in physics with body {body}")
    for name in names:
        table.add_row(name, str(trials), str(trials - len(failures[name])))
    show(table)
    say(f"{sum(not failures[name] for name in names)} of {len(names)} categories without a failure")


if __name__ == "__main__":
    run_script(main)
