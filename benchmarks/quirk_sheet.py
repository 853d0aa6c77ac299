"""Every kind of quirk in a kitchen, tried and got round: `python benchmarks/quirk_sheet.py --picture sheet.png`.

Each kind has one trial in quirk_trials.toml: commands after which a condition is false that should be true, and
commands after which it is true all the same. They are played in physics (`--backend symbolic`: by the skill table), and
three pictures are taken of each: before, right after the try, and in the end. Printed are what became of each command
and whether the condition held.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from remac_bench.columns import show
from remac_bench.command import run_script
from remac_bench.console import say
from remac_bench.flags import takes
from rich.table import Table

import remac_env
from remac_env.backends import make_backend
from remac_env.backends.base import Backend
from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.envs.parallel import KitchenParallelEnv
from remac_env.files import prepare_file
from remac_env.kitchen import layout as layouts
from remac_env.rendering.cameras import SIDE
from remac_env.rendering.stage import Stage
from remac_env.rules.conditions import Condition
from remac_env.rules.facts import Quirk
from remac_env.rules.quirks import sentence_of
from remac_env.simulator import load_opencv
from remac_env.state import Door, Place, base_place
from remac_env.tasks.goals import DoorIs
from remac_env.tasks.setup import Setup
from remac_env.tasks.spec import TaskSpec

FILE = Path(__file__).with_name("quirk_trials.toml")
LAYOUT, STYLE = "rich_u_shaped", "modern_1"

_SIZE = 320  # pixels of a picture's side
_SMALL, _CAPTION, _ACROSS = 170, 36, 2  # of the same in the sheet, of a caption's height; kinds side by side

Picture = NDArray[np.uint8]


@dataclass(frozen=True, kw_only=True)
class Trial:
    """One row of the file, whose head says what stands in it."""

    about: str
    false: tuple[str, ...]
    tries: tuple[str, ...]
    remedy: tuple[str, ...]
    then: tuple[str, ...] = ()
    other: str = ""
    robots: int = 1
    objects: Mapping[str, str] = field(default_factory=dict)
    places: Mapping[str, str] = field(default_factory=dict)
    doors: Mapping[str, Door] = field(default_factory=dict)
    on: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    @property
    def looked_at(self) -> str:
        """What the pictures are of: that of which a condition is found false."""
        return self.false[-1] if self.false[0] != "marked" else self.about

    @property
    def looked_at_last(self) -> str:
        """What the last picture is of."""
        return self.then[-1] if self.then else self.looked_at


@dataclass(frozen=True)
class Shown:
    """What came of a trial: each command with its outcome, whether the condition held then and in the end, pictures."""

    kind: str
    sentence: str
    condition: str
    told: tuple[str, ...]
    held: bool
    held_then: bool
    pictures: tuple[Picture, ...]


def load() -> dict[str, Trial]:
    """Every trial by the kind of its quirk."""
    rows: dict[str, dict[str, Any]] = tomllib.loads(FILE.read_text("utf-8"))
    lists = ("tries", "remedy", "false", "then")
    made = {kind: {key: tuple(v) if key in lists else v for key, v in row.items()} for kind, row in rows.items()}
    return {kind: Trial(**row) for kind, row in made.items()}


def task_of(kind: str, trial: Trial, *, quirky: bool = True) -> TaskSpec:
    """A task in whose kitchen the trial takes place; its goal is never reached."""
    places = {
        noun: Place("vessel", at.removeprefix("vessel: ")) if at.startswith("vessel: ") else Place("slot", at)
        for noun, at in trial.places.items()
    }
    return TaskSpec(
        name="QuirkTrial",
        wordings=("shut the drawer",) * 3,
        goal=DoorIs("drawer", "open"),
        roles=(),
        fixtures=("drawer",),
        styles=(STYLE,),
        layouts=(LAYOUT,),
        nouns=layouts.nouns(LAYOUT),
        quirks=(Quirk(kind, trial.about, trial.other),) if quirky else (),
        setup=Setup(trial.objects, places, trial.doors, {name: tuple(on) for name, on in trial.on.items()}),
    )


def play(kind: str, trial: Trial, *, backend: str = "physics", pictures: bool = False, quirky: bool = True) -> Shown:
    """One trial; the same without its quirk where `quirky` is false."""
    spec = task_of(kind, trial, quirky=quirky)
    env = remac_env.parallel_env(spec, robots=trial.robots, backend=backend)
    env.reset(seed=1)
    stand = _Stand(env, make_backend(env.options, env.worlds))
    condition = Condition(trial.false[0], trial.false[1:])
    shots = [stand.picture(trial.looked_at)] if pictures else []
    told = list(stand.run(trial.tries))
    held = condition.holds(env.start.scene, stand.world)
    shots += [stand.picture(trial.looked_at)] if pictures else []
    told += ["-- then", *stand.run(trial.remedy)]
    final = Condition(trial.then[0], trial.then[1:]) if trial.then else condition
    then = final.holds(env.start.scene, stand.world)
    shots += [stand.picture(trial.looked_at_last)] if pictures else []
    sentence = sentence_of(Quirk(kind, trial.about, trial.other))
    return Shown(kind, sentence, condition.sentence, tuple(told), held, then, tuple(shots))


class _Stand:
    """The kitchen of a trial."""

    def __init__(self, env: KitchenParallelEnv, backend: Backend) -> None:
        self._env, self._backend = env, backend
        self.world = backend.reset(env.start)

    def run(self, commands: Sequence[str]) -> Iterator[str]:
        """Each command with its outcome."""
        for text in commands:
            parts = [part.strip() for part in text.split("|")]
            joint = dict(zip(self._env.start.scene.robots, map(self._env.vocabulary.parse, parts), strict=True))
            result = self._backend.run_round({name: subtask for name, subtask in joint.items() if subtask is not None})
            self.world = result.world
            yield f"{text}: " + " | ".join(result.outcomes[name].reason or "done" for name in joint)

    def picture(self, name: str) -> Picture:
        """A close look at a fixture or an object, as it is now."""
        start, world = self._env.start, self.world
        stage = Stage(start, self._env.worlds.layout_of(start), self._env.worlds.categories)
        if isinstance(self._backend, PhysicsBackend):
            stage.show_positions(self._backend.positions(), world)
        else:
            stage.show_world(start, world)
        picture = stage.look(SIDE.format(station=self._station(name)), size=_SIZE)
        stage.close()
        return picture

    def _station(self, name: str) -> str:
        """From where it is used."""
        scene = self._env.start.scene
        if name in scene.fixtures:
            return scene.stations_of(name)[0]
        place = base_place(self.world, name)
        return self.world.robots[place.where].station if place.relation == "held" else scene.slots[place.where].station


def sheet(shown: Sequence[Shown]) -> Picture:
    """All pictures as one: of each kind three side by side, before, after the try and in the end, under a caption."""
    cv2 = load_opencv()
    panels = []
    for each in shown:
        strip = np.hstack([cv2.resize(one, (_SMALL, _SMALL), interpolation=cv2.INTER_AREA) for one in each.pictures])
        caption = np.full((_CAPTION, strip.shape[1], 3), 255, np.uint8)
        lines = (each.sentence, f"before, after the try ({each.condition}: {each.held}), and in the end")
        for number, (line, scale) in enumerate(zip(lines, (0.40, 0.33), strict=True)):
            cv2.putText(
                caption, line, (4, 14 + 15 * number), cv2.FONT_HERSHEY_SIMPLEX, scale, (0, 0, 0), 1, cv2.LINE_AA
            )
        panel = np.vstack([caption, strip])
        panels.append(np.pad(panel, ((0, 4), (4, 4), (0, 0)), constant_values=255))
    panels += [np.full_like(panels[0], 255)] * (-len(panels) % _ACROSS)
    rows = [np.hstack(panels[at : at + _ACROSS]) for at in range(0, len(panels), _ACROSS)]
    return np.vstack(rows)


@takes("quirk_sheet.only", "backend", "quirk_sheet.picture")
def main(*, only: str, backend: str, picture: Path | None) -> None:
    """Print what became of each trial."""
    if picture is not None:
        prepare_file(picture, "--picture")
    shown = []
    table = Table("quirk", "condition", "after the try", "then", title=f"Quirks, {backend}")
    for kind, trial in load().items():
        if only in kind:
            each = play(kind, trial, backend=backend, pictures=picture is not None)
            shown.append(each)
            say(f"{kind}: {each.sentence}: {', '.join(each.told)}")
            table.add_row(kind, each.condition, str(each.held), str(each.held_then))
    show(table)
    if picture is not None:
        load_opencv().imwrite(str(picture), sheet(shown)[..., ::-1])


if __name__ == "__main__":
    run_script(main)
