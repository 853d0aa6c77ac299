"""Proves every variant of fixture for every skill it offers: `python benchmarks/certify_modules.py`.

A variant stands alone at a plain wall with worktops beside it; robots of both names do the trials of module_trials.toml
there, every arrival off by up to 0.02 m and 0.03 rad, all links colliding. What came of it goes to
kitchen/fixtures/certified/<body>.toml, beside the variants, or for a body from outside to certified/<body>.toml beside
its code; layouts take no others than those of the standard body. `--check 5` proves a few again.
"""

from __future__ import annotations

import warnings
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import typer
from module_record import Touch
from module_trials import STATION, Found, any_layout, colliders_hash, origin, run, tables, trials, variants
from remac_bench.columns import show
from remac_bench.command import run_script
from remac_bench.console import say
from remac_bench.errors import UsageError
from remac_bench.flags import takes
from rich.table import Table

from remac_env.errors import UncertifiedWarning
from remac_env.files import prepare_file
from remac_env.kitchen.fixtures import Fixture, certificate_files, certificates
from remac_env.kitchen.fixtures.certificate_files import Certificate, Skill
from remac_env.robots import bodies
from remac_env.seeding import generator

# By how much a proof that is made again may leave what was found before: stance and reach in m, pitch in rad.
_STANCE_SLACK, _REACH_SLACK, _PITCH_SLACK = 0.15, 0.10, 0.45
_HEAD = (
    "# What is proven of each variant, by `python benchmarks/certify_modules.py`. certificate_files.py says what",
    "# the figures mean. m and rad, from the middle of the fixture, the line of fronts and the floor.",
)


def certificate(kind: str, variant: str, found: Iterable[Found], body: str) -> Certificate:
    """The certificate of a variant from all that was found with a body."""
    layout, parts = any_layout(kind, variant), defaultdict(list)
    for part in found:
        if part.skill:
            parts[part.skill].append(part)
    fixture = layout.fixtures[kind]
    slots = tables()[kind].get("slots")
    size = certificates.size(fixture)
    if slots:
        size = replace(
            size,
            low=(min(x for x, _ in slots), min(y for _, y in slots), fixture.slots[0].center[2]),
            high=(max(x for x, _ in slots), max(y for _, y in slots), fixture.slots[0].center[2]),
        )
    made = bodies.get(body)
    return Certificate(
        made.name,
        made.fingerprint,
        kind,
        variant,
        measures=certificates.measures_hash(kind, variant),
        colliders=colliders_hash(kind, variant),
        station=(-origin(kind, variant), layout.stations[STATION].y),
        size=size,
        sweep=_sweep(fixture),
        skills={name: _skill(some) for name, some in sorted(parts.items())},
    )


@takes(
    "certify_modules.only", "certify_modules.rounds", "certify_modules.check", "certify_modules.first_seed",
    "script.body",
)  # fmt: skip
def main(*, only: str, rounds: int, check: int, first_seed: int, body: str) -> None:
    """Print a table of every variant and skill, and every failure."""
    file = certificate_files.file_of(body)
    if file is None:
        raise UsageError(f"the code of body {body!r} lies in no file, beside which its certificates could be written")
    wanted = [name.strip() for name in only.split(",") if name.strip()]
    chosen = [(k, m) for k, m in variants() if not wanted or k in wanted or f"{k}.{m}" in wanted]
    if check:
        problems = _checked(chosen, check, first_seed, body)
        for problem in problems:
            say(problem)
        say(f"{check} trials proven again, {len(problems)} differences")
        raise typer.Exit(int(bool(problems)))
    prepare_file(file, "certificates")
    warnings.simplefilter("ignore", UncertifiedWarning)  # that is what is being mended
    proofs: dict[tuple[str, str], Certificate] = {}
    for kind, variant in chosen:
        found = []
        for trial in trials(kind, variant, first_seed, rounds, body):
            parts = run(trial)
            found += parts
            for part in parts:
                if part.problem:
                    say(f"{kind}.{variant} {trial.robot} seed {trial.seed}: {part.problem}")
        proofs[kind, variant] = certificate(kind, variant, found, body)
    proofs = {**certificate_files.load(body), **proofs}
    ordered = [proofs[name] for name in variants() if name in proofs]
    file.write_text("\n".join(as_toml(ordered)) + "\n", encoding="utf-8")
    show(_shown([proofs[name] for name in chosen], ordered[0].body))


def _checked(chosen: Sequence[tuple[str, str]], count: int, seed: int, body: str) -> list[str]:
    """Prove a seeded few again, from new seeds, and name what is not as certified."""
    known, chance, problems = certificate_files.load(body), generator(seed, "modules"), []
    for _ in range(count):
        kind, variant = chosen[int(chance.integers(len(chosen)))]
        if (kind, variant) not in known:
            problems.append(f"{kind}.{variant}: not proven with body {body!r}")
            continue
        proof = known[kind, variant]
        if proof.colliders != colliders_hash(kind, variant):
            problems.append(f"{kind}.{variant}: its colliders have changed since the proof")
        runs = trials(kind, variant, seed + 1000, body=body)
        trial = runs[int(chance.integers(len(runs)))]
        for part in run(trial):
            label = f"{kind}.{variant} {trial.robot} seed {trial.seed}: {part.skill}"
            if part.problem:
                problems.append(f"{label}: {part.problem}")
            elif part.skill not in proof.skills:
                problems.append(f"{label}: not in the proof")
            else:
                problems += [f"{label}: {text}" for text in differences(part, proof.skills[part.skill])]
    return problems


def differences(part: Found, skill: Skill) -> Iterator[str]:
    """What lies outside of the ranges of a proof."""
    (left, near, _), (right, far, _) = skill.stances
    for touch in part.touches:
        for name, value, low, high, slack in (
            ("stance x", touch.stance[0], left, right, _STANCE_SLACK),
            ("stance y", touch.stance[1], near, far, _STANCE_SLACK),
            ("reach", touch.reach, *skill.reach, _REACH_SLACK),
            ("pitch", touch.pitch, *skill.pitch, _PITCH_SLACK),
        ):
            if not low - slack <= value <= high + slack:
                yield f"{name} {value:.3f} is outside of [{low:.3f}, {high:.3f}] by more than {slack:g}"


def _skill(parts: Sequence[Found]) -> Skill:
    """Several tries of one skill as one."""
    touches = [touch for part in parts for touch in part.touches] or [Touch((0.0, 0.0, 0.0), 0.0, 0.0, 0.0)]
    stances = np.array([touch.stance for touch in touches])
    spans = np.array([(touch.reach, touch.pitch, touch.approach) for touch in touches])
    (reach, pitch, approach) = zip(spans.min(axis=0), spans.max(axis=0), strict=True)
    # How far a base goes to a side is how far it went where a wall was near on that side.
    left = min(part.floor[0][0] for part in parts if part.beside == "left")
    right = max(part.floor[1][0] for part in parts if part.beside == "right")
    near, far = min(part.floor[0][1] for part in parts), max(part.floor[1][1] for part in parts)
    return Skill(
        tries=len(parts),
        successes=sum(not part.problem for part in parts),
        stances=(tuple(np.min(stances, axis=0)), tuple(np.max(stances, axis=0))),
        reach=reach,
        pitch=pitch,
        approach=approach,
        floor=((left, near), (right, far)),
    )


def _sweep(fixture: Fixture) -> Any:
    if not fixture.swept_points:
        return None
    points = np.array(fixture.swept_points) - (certificates.anchor(fixture), 0.0, 0.0)
    return replace(certificates.size(fixture), low=tuple(points.min(axis=0)), high=tuple(points.max(axis=0)))


def as_toml(proofs: Iterable[Certificate]) -> Iterator[str]:
    """Lines of a TOML file, all of one body, that :mod:`remac_env.kitchen.fixtures.certificate_files` reads."""
    proofs = list(proofs)
    yield from _HEAD
    yield f'\nbody = "{proofs[0].body}"\nfingerprint = "{proofs[0].fingerprint}"'
    for proof in proofs:
        yield f"\n[{proof.kind}.{proof.variant}]"
        yield f'measures = "{proof.measures}"'
        yield f'colliders = "{proof.colliders}"'
        yield f"station = {_list(proof.station)}"
        yield f"size = {_list((*proof.size.low, *proof.size.high))}"
        if proof.sweep is not None:
            yield f"sweep = {_list((*proof.sweep.low, *proof.sweep.high))}"
        for name, skill in proof.skills.items():
            yield f'[{proof.kind}.{proof.variant}.skills."{name}"]'
            yield f"tries = {skill.tries}"
            yield f"successes = {skill.successes}"
            yield f"stance_low = {_list(skill.stances[0])}"
            yield f"stance_high = {_list(skill.stances[1])}"
            yield f"reach = {_list(skill.reach)}"
            yield f"pitch = {_list(skill.pitch)}"
            yield f"approach = {_list(skill.approach)}"
            yield f"floor = [{_list(skill.floor[0])}, {_list(skill.floor[1])}]"


def _shown(proofs: Iterable[Certificate], body: str) -> Table:
    heads = ("variant", "skill", "successes", "stance x", "stance y", "reach", "pitch", "approach")
    table = Table(*heads, title=f"Variants certified with body {body}, m and rad")
    for proof in proofs:
        for name, skill in proof.skills.items():
            (left, near, _), (right, far, _) = skill.stances
            spans = ((left, right), (near, far), skill.reach, skill.pitch, skill.approach)
            shown = (f"{low:.2f} to {high:.2f}" for low, high in spans)
            table.add_row(f"{proof.kind}.{proof.variant}", name, f"{skill.successes} of {skill.tries}", *shown)
    return table


def _list(values: Iterable[float]) -> str:
    return "[" + ", ".join(f"{round(float(value), 3) + 0.0:g}" for value in values) + "]"


if __name__ == "__main__":
    run_script(main)
