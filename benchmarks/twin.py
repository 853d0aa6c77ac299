"""Do the two backends tell the same story? `python benchmarks/twin.py --seeds 70000:70040`.

In physics, robots do what was done least so far: of all (skill, reason) that the table predicts for some command, the
rarest is chosen, half of the time among those that succeed. Where a pair needs a preparation (a full hand before a
closed door), one robot's shortest way there is searched for and gone, half of the rounds. Each round is foretold by the
table from the world before it, and compared: outcomes robot by robot, and the whole world after it. Where in physics an
object slips out of a hand and in the table it does not, the round is listed apart; anything else is a disagreement,
printed with what differs. Refusals, which both backends read from one function, and what robots never try as a rule
(`forbidden` of controllers/scripted/room.py) are counted apart too: that they agree is not a finding. With
`--grades 1,2 --quirks 2` the tasks are generated ones, and the table knows their quirks.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, replace
from itertools import product
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from remac_bench.columns import show
from remac_bench.command import run_script
from remac_bench.console import say
from remac_bench.flags import takes
from remac_bench.playing.job_lists import parse_names, parse_seeds
from rich.table import Table
from twin_agenda import Agenda, Stratum, foretell

import remac_env
from remac_env.backends.physics.controllers.scripted.room import forbidden
from remac_env.backends.symbolic import SymbolicBackend
from remac_env.envs.parallel import KitchenParallelEnv
from remac_env.files import prepare_file
from remac_env.rules.claims import first_false, settle_claims
from remac_env.rules.outcomes import Outcome
from remac_env.rules.subtasks import Subtask
from remac_env.seeding import generator
from remac_env.state import WorldState, supports
from remac_env.tasks.spec import TaskSpec

SLIPS = ("slipped", "dropped")
"""Reasons that physics alone may give: the table does not know them."""


@dataclass(frozen=True)
class Compared:
    """One robot's subtask in one round.

    verdict: agree, slip or disagree; differs: what does, in words; by_rule: both backends keep to the same rule, and
    nothing was tried.
    """

    task: str
    robots: int
    seed: int
    layout: str
    round: int
    robot: str
    subtask: str
    skill: str
    foretold: str
    happened: str
    verdict: str
    differs: str
    by_rule: bool = False


def play(
    task: str, robots: int, seed: int, rounds: int, *, template: str | None = None, quirks: int = 0
) -> list[Compared]:
    """One episode of varied commands; ends with the goal or after so many rounds.

    A task that is a number is a generated one of that grade, with a `template` and `quirks`.
    """
    made: str | TaskSpec = task
    if task.isdecimal():
        spec = remac_env.generate(int(task), seed, template=template or "physics", quirks=quirks, robots=robots)
        made = replace(spec, rounds=rounds)
    env = remac_env.parallel_env(made, robots=robots, starts="mixed", max_rounds=rounds)
    env.reset(seed=seed)
    chance, seen, found = generator(seed, "twin", task, robots), Counter[Stratum](), list[Compared]()
    agendas = {name: Agenda(chance, env.start.scene) for name in env.agents}
    while env.agents:
        joint = _choose(env, seen, chance, agendas)
        before = env.world
        _, _, _, _, infos = env.step({name: env.vocabulary.encode(subtask.text) for name, subtask in joint.items()})
        told = {name: info["outcome"] for name, info in infos.items()}
        outcomes = {name: Outcome(**each | {"reason": each["reason"] or None}) for name, each in told.items()}
        number = infos[next(iter(infos))]["round"]
        for line in compare(env, before, joint, outcomes, round_=number, task=task):
            found.append(line)
            seen[line.skill, line.foretold] += 1
    env.close()
    return found


def compare(
    env: KitchenParallelEnv, before: WorldState, joint: Mapping[str, Subtask], outcomes: Mapping[str, Outcome],
    *, round_: int = 0, task: str = "",
) -> Iterator[Compared]:
    """The table's story of a round beside what happened; `env` stands after it."""
    after, foretold = _foretold(env, before, joint)
    slipped = any(outcomes[n].reason in SLIPS and foretold[n].success for n in joint) or _fell(after, env.world)
    changes = () if slipped else tuple(_differences(after, env.world))
    for name, subtask in joint.items():
        table, real = foretold[name].reason or "success", outcomes[name].reason or "success"
        differs = [f"{table} was predicted, {real} happened: {outcomes[name].detail}"] if table != real else []
        differs += changes
        slip = slipped and (table == real or outcomes[name].reason in SLIPS)
        verdict = "slip" if slip else "disagree" if differs else "agree"
        where = (task or env.worlds.spec.name, len(joint), env.start.seed, env.start.layout, round_, name)
        ruled = _by_rule(env, before, joint, name)
        yield Compared(*where, subtask.text, subtask.skill, table, real, verdict, "; ".join(differs), ruled)


def _by_rule(env: KitchenParallelEnv, before: WorldState, joint: Mapping[str, Subtask], robot: str) -> bool:
    """Whether nothing is tried of this robot's subtask: both backends keep to one and the same rule."""
    scene, subtask = env.start.scene, joint[robot]
    refused, _ = settle_claims(scene, before, joint)
    if robot in refused:
        return True
    false = first_false(scene, before, robot, subtask, "attempt")
    return false is not None and false.condition.predicate == "room" and _forbidden(env, before, robot, subtask.target)


def _forbidden(env: KitchenParallelEnv, before: WorldState, robot: str, target: str) -> bool:
    """Whether a rule keeps what the robot holds from being put there."""
    scene, categories = env.start.scene, env.worlds.categories
    around = [target] if target in scene.fixtures else supports(scene, before, target)
    kind = next((scene.fixtures[name].kind for name in around if name in scene.fixtures), "")
    obj = categories[env.start.categories[str(before.robots[robot].holding)]]
    dish = categories[env.start.categories[target]] if target in scene.objects else None
    return forbidden(obj, kind, dish) is not None


def _fell(foretold: WorldState, happened: WorldState) -> bool:
    """Whether an object that should be in a hand lies on the floor."""
    return any(
        item.place.relation == "held" and happened.objects[name].place.relation == "floor"
        for name, item in foretold.objects.items()
    )


def _choose(
    env: KitchenParallelEnv, seen: Counter[Stratum], chance: np.random.Generator, agendas: Mapping[str, Agenda]
) -> dict[str, Subtask]:
    """For each robot its agenda's next command, or one of the rarest stratum; half of those succeed."""
    scene, joint = env.start.scene, {}
    parsed = [env.vocabulary.parse(text) for text in env.vocabulary.commands(scene)]
    commands = [subtask for subtask in parsed if subtask is not None and subtask.skill != "done"]
    for name in env.agents:
        agenda = agendas[name].next(env, name, _about_few(env, commands)) if chance.random() < 0.5 else None
        joint[name] = agenda or _rarest(env, name, commands, seen, chance)
        seen[joint[name].skill, foretell(scene, env.world, name, joint[name])] += 1
    return joint


def _about_few(env: KitchenParallelEnv, commands: Sequence[Subtask]) -> list[Subtask]:
    """The commands about fixtures, the goal's objects and one more, so that searches stay small."""
    scene, named = env.start.scene, env.goal.names()
    others = [name for name, facts in scene.objects.items() if name not in named and facts.small]
    few = {*scene.fixtures, *named, *others[:1], *(name for name, facts in scene.objects.items() if facts.seasons), ""}
    return [subtask for subtask in commands if subtask.target in few]


def _rarest(
    env: KitchenParallelEnv, name: str, commands: Sequence[Subtask], seen: Counter[Stratum], chance: np.random.Generator
) -> Subtask:
    """A command of the stratum seen least."""
    strata: dict[Stratum, list[Subtask]] = {}
    for subtask in commands:
        strata.setdefault((subtask.skill, foretell(env.start.scene, env.world, name, subtask)), []).append(subtask)
    legal = [key for key in strata if key[1] == "success" and key[0] != "wait"]
    illegal = [key for key in strata if key[1] != "success"]
    keys = legal if legal and (not illegal or chance.random() < 0.5) else illegal
    least = sorted(key for key in keys if seen[key] == min(seen[k] for k in keys))
    options = strata[least[int(chance.integers(len(least)))]]
    return options[int(chance.integers(len(options)))]


def _foretold(
    env: KitchenParallelEnv, before: WorldState, joint: Mapping[str, Subtask]
) -> tuple[WorldState, Mapping[str, Outcome]]:
    backend = SymbolicBackend()
    backend.reset(replace(env.start, world=before))
    result = backend.run_round(joint)
    return result.world, result.outcomes


def _differences(one: WorldState, other: WorldState) -> Iterator[str]:
    for part in ("robots", "objects", "fixtures"):
        for name, state in getattr(one, part).items():
            if state != getattr(other, part)[name]:
                yield f"{name}: {state} predicted, {getattr(other, part)[name]} happened"


@takes(
    *("twin.seeds", "script.tasks", "twin.grades", "template", "quirks", "twin.rounds", "script.processes"),
    "script.file",
)
def main(
    *, seeds: str, tasks: str | None, grades: str, template: str | None, quirks: int, rounds: int, processes: int,
    file: Path | None,
) -> None:  # fmt: skip
    """Print every disagreement and slip, and a table a skill and reason."""
    if file is not None:
        prepare_file(file, "--json")
    asked, kind = (grades, "grades") if grades else (tasks, "tasks")
    names = remac_env.tasks() if asked is None else parse_names(asked, kind)
    cells = [(*cell, rounds) for cell in product(names, (1, 2), parse_seeds(seeds))]
    found = list[Compared]()
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        for lines in pool.map(_job, [(cell, template, quirks) for cell in cells]):
            found += lines
            for line in lines:
                if line.verdict != "agree":
                    where = f"{line.task} {line.robots} seed {line.seed} {line.layout} round {line.round} {line.robot}"
                    say(f"{line.verdict}: {where}: {line.subtask}: {line.differs}")
    show(table(found, f"Both backends on one round, seeds {seeds}"))
    if file is not None:
        file.write_text(json.dumps([asdict(line) for line in found], indent=1), encoding="utf-8")


def _job(job: tuple[tuple[str, int, int, int], str | None, int]) -> list[Compared]:
    cell, template, quirks = job
    return play(*cell, template=template, quirks=quirks)


def table(found: Sequence[Compared], title: str) -> Table:
    """Counts a skill and reason, and the share of agreement without slips; what is decided by rule stands apart."""
    shown = Table("skill", "predicted", "n", "agree", "slips", "disagree", title=title)
    tried, ruled = ([line for line in found if line.by_rule is by_rule] for by_rule in (False, True))
    for lines in (tried, ruled):
        for skill, reason in sorted({(line.skill, line.foretold) for line in lines}):
            _add(shown, (skill, reason), [line for line in lines if (line.skill, line.foretold) == (skill, reason)])
        shown.add_section()
    _add(shown, ("tried, succeeds", ""), [line for line in tried if line.foretold == "success"])
    _add(shown, ("tried, fails", ""), [line for line in tried if line.foretold != "success"])
    _add(shown, ("tried, all", ""), tried)
    _add(shown, ("by rule", ""), ruled)
    return shown


def _add(shown: Table, name: tuple[str, str], lines: Sequence[Compared]) -> None:
    counts = Counter(line.verdict for line in lines)
    judged = len(lines) - counts["slip"]
    share = f"{counts['agree']} ({100 * counts['agree'] / judged:.1f}%)" if judged else "0"
    shown.add_row(*name, str(len(lines)), share, str(counts["slip"]), str(counts["disagree"]))


if __name__ == "__main__":
    run_script(main)
