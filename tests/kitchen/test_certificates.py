"""Every variant is proven, and a layout that is not put together from proven variants is refused."""

from __future__ import annotations

import subprocess
import sys
import warnings
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import certify_modules
import module_trials
import pytest

from remac_env.errors import KitchenFileError, UncertifiedWarning
from remac_env.kitchen import layout as layouts
from remac_env.kitchen import style as styles
from remac_env.kitchen.blocks import Block
from remac_env.kitchen.fixtures import certificate_files, certificates, models
from remac_env.kitchen.fixtures.base import ONE_VARIANT
from remac_env.kitchen.fixtures.certificate_files import Certificate
from remac_env.robots import bodies
from remac_env.robots.panda.body import Panda
from remac_env.state import FrozenMap

NAME = "one_wall_large"
TEXT = (layouts.FOLDER / f"{NAME}.toml").read_text(encoding="utf-8")
CABINET = ("cabinet", "left_bar")
KNOWN = certificate_files.load()
VARIANTS = module_trials.variants()


def offered(kind: str, variant: str) -> set[str]:
    """What robots can do with a variant, by its parts; of several switches, which are named like slots, with each."""
    fixture = module_trials.any_layout(kind, variant).fixtures[kind]
    found = {"open door", "close door"} if fixture.door else set()
    found |= {"place to", "pick up"} if fixture.slots else set()
    if len(fixture.switches) > 1:
        worked = ("turn on", "turn off", *sorted(found))
        return found | {f"{skill} {switch}" for skill in worked for switch in fixture.switches}
    return found | ({"turn on", "turn off"} if fixture.switches else set())


def refused(text: str, match: str) -> None:
    with pytest.raises(KitchenFileError, match=match):
        layouts.parse(text, name="odd", file="odd.toml")
    layouts.parse(text, name="odd", file="odd.toml", certified=False)


def changed(fixture: str, key: str, value: str) -> str:
    """The layout's text with another value for one key of one fixture."""
    head, found, tail = TEXT.partition(f"[fixtures.{fixture}]\n")
    lines = tail.splitlines(keepends=True)
    index = next(i for i, line in enumerate(lines) if line.startswith(f"{key} ="))
    return head + found + "".join([*lines[:index], f"{key} = {value}\n", *lines[index + 1 :]])


def known_with(**changes: object) -> Mapping[tuple[str, str], Certificate]:
    return {**KNOWN, CABINET: replace(KNOWN[CABINET], **changes)}  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def layout() -> layouts.Layout:
    return layouts.load(NAME)


# -- what is proven ----------------------------------------------------------------------------------------------------


def test_nothing_else_is_proven_than_the_variants() -> None:
    assert set(KNOWN) == set(VARIANTS) >= {(kind, name) for kind in models.kinds() for name in models.names(kind)}
    kitchens = [layouts.load(name) for name in layouts.names()]
    used = {fixture.kind for kitchen in kitchens for fixture in kitchen.fixtures.values() if fixture.door}
    assert used | {"counter"} <= {kind for kind, _ in KNOWN}
    assert offered("stove", "top") >= {"place to", "turn on stove.3", "pick up stove.0"}
    assert offered("oven", ONE_VARIANT) == {"open door", "close door", "place to", "pick up", "turn on", "turn off"}


@pytest.mark.parametrize(("kind", "variant"), VARIANTS)
def test_every_variant_is_proven_for_every_skill(kind: str, variant: str) -> None:
    proof = KNOWN[kind, variant]
    assert set(proof.skills) == offered(kind, variant)
    assert all(skill.proven and skill.tries >= 4 for skill in proof.skills.values()), "by both robots, twice"
    assert proof.measures == certificates.measures_hash(kind, variant), "run benchmarks/certify_modules.py"
    assert proof.colliders == module_trials.colliders_hash(kind, variant), "run benchmarks/certify_modules.py"


def test_a_proof_says_where_robots_stood() -> None:
    for proof in KNOWN.values():
        for name, skill in proof.skills.items():
            (left, near, turned), (right, far, other) = skill.stances
            assert -0.5 < left <= right < 0.5 and -1.04 < near <= far <= -0.19, (proof.kind, proof.variant, name)
            assert 1.2 < turned <= other < 1.95
            assert 0.3 < skill.reach[0] <= skill.reach[1] < 0.95
            (low, _), (high, front) = skill.floor
            assert low < left and high > right and front < 0.0
    door = KNOWN[CABINET].sweep
    assert door is not None and door.low[1] < -0.1, "the door swings towards the robot"
    assert KNOWN["stove", "top"].sweep is None


def test_fingerprints_tell_variants_apart_that_differ() -> None:
    assert len({proof.measures for proof in KNOWN.values()}) == len(KNOWN)
    same_to_the_touch = {("cabinet", variant) for variant in models.names("cabinet")}
    assert len({KNOWN[name].colliders for name in same_to_the_touch}) == len(same_to_the_touch)


def test_trials_are_by_both_robots_with_a_wall_on_either_side() -> None:
    runs = module_trials.trials("cabinet", "double_bar", 0)
    pairs = {(name, side) for name in module_trials.ROBOTS for side in module_trials.SIDES}
    assert {(run.robot, run.beside) for run in runs} == pairs
    assert len({run.seed for run in runs}) == len(runs)
    twice = module_trials.trials("cabinet", "double_bar", 0, rounds=2)
    assert len({run.seed for run in twice}) == 2 * len(runs)


def test_a_proof_can_be_made_again() -> None:
    trial = next(t for t in module_trials.trials("faucet", "goose", 45000) if t.robot == "robot_1")
    found = module_trials.run(trial)
    assert [part.skill for part in found] == ["turn on", "turn off"] * 2
    for part in found:
        assert part.problem == "" and len(part.touches) == 1
        assert not list(certify_modules.differences(part, KNOWN["faucet", "goose"].skills[part.skill]))
        far = replace(part, touches=(replace(part.touches[0], reach=part.touches[0].reach + 0.4),))
        assert list(certify_modules.differences(far, KNOWN["faucet", "goose"].skills[part.skill]))


def test_what_is_written_is_read_again(tmp_path: Path) -> None:
    path = tmp_path / "panda.toml"
    path.write_text("\n".join(certify_modules.as_toml(KNOWN.values())), encoding="utf-8")
    assert certificate_files.read(path) == KNOWN


# -- what layouts are refused ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("index", range(max(len(models.names(kind)) for kind in models.kinds())))
def test_every_variant_is_accepted(index: int) -> None:
    made = {kind: models.names(kind)[index % len(models.names(kind))] for kind in models.kinds()}
    kitchen = layouts.load("one_wall_small", FrozenMap(made))
    assert {f.kind: f.variant for f in kitchen.fixtures.values() if f.kind in made} == made


@pytest.mark.long
@pytest.mark.parametrize("name", layouts.names())
def test_every_layout_with_every_style_is_accepted(name: str) -> None:
    for style in styles.names():
        assert layouts.load(name, styles.load(style).models).name == name


def test_a_variant_without_a_certificate_is_refused(layout: layouts.Layout) -> None:
    known = {name: proof for name, proof in KNOWN.items() if name != CABINET}
    text = r"odd\.toml: fixtures\.cabinet\.model: .*left_bar.*has no certificate for body 'panda'; valid: right_bar"
    with pytest.raises(KitchenFileError, match=text):
        certificates.check(layout, "odd.toml", known)
    certificates.check(layout, "odd.toml", KNOWN)


def test_a_variant_that_has_changed_is_refused(layout: layouts.Layout) -> None:
    with pytest.raises(KitchenFileError, match=r"left_bar.*measures have changed.*double_bar"):
        certificates.check(layout, "odd.toml", known_with(measures="0" * 12))


def test_a_proof_with_another_body_is_refused(layout: layouts.Layout) -> None:
    with pytest.raises(KitchenFileError, match=r"left_bar.*its proof is of body 'low panda', not 'panda'"):
        certificates.check(layout, "odd.toml", known_with(body="low panda"))
    with pytest.raises(KitchenFileError, match=r"left_bar.*body 'panda' has changed since the proof"):
        certificates.check(layout, "odd.toml", known_with(fingerprint="0" * 12))


def test_another_body_trusts_no_proof_of_the_pandas(layout: layouts.Layout) -> None:
    low = Panda(name="low panda", mount_height=0.62)
    bodies.register_body(low)
    try:
        assert certificate_files.load(low.name) == {}
        with pytest.raises(KitchenFileError, match="it has no certificate for body 'low panda'"):
            certificates.check(layout, "odd.toml", body=low.name)
        with pytest.raises(KitchenFileError, match="its proof is of body 'panda', not 'low panda'"):
            certificates.check(layout, "odd.toml", KNOWN, body=low.name)
        used = certificates.uncertified(layout, low.name)
        assert {"cabinet", "microwave", "stove"} <= set(used) and "fridge" not in used
        with pytest.warns(UncertifiedWarning, match="'low panda' nothing is .*cabinet.*certified with: panda"):
            certificates.warn_uncertified(layout, low.name)
        own = {name: replace(proof, body=low.name, fingerprint=low.fingerprint) for name, proof in KNOWN.items()}
        certificates.check(layout, "odd.toml", own, body=low.name)
    finally:
        bodies._BODIES.pop(low.name)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        certificates.warn_uncertified(layout, bodies.STANDARD)


def test_a_variant_that_failed_is_refused(layout: layouts.Layout) -> None:
    skills = KNOWN[CABINET].skills
    failed = {**skills, "open door": replace(skills["open door"], successes=skills["open door"].tries - 1)}
    with pytest.raises(KitchenFileError, match="left_bar.*open door failed in the proof"):
        certificates.check(layout, "odd.toml", known_with(skills=failed))


def test_a_station_off_its_place_is_refused(layout: layouts.Layout) -> None:
    x = layout.fixtures["faucet"].x  # type: ignore[attr-defined]
    layouts.parse(changed("faucet", "x", f"{x + 0.015:.3f}"), name="odd", file="odd.toml")
    off = changed("faucet", "x", f"{x + 0.04:.3f}")
    refused(off, r"odd\.toml: fixtures\.faucet\.station: .*'goose', off its proof; valid: \(-0\.010, -0\.850\)")


def test_a_cabinet_of_another_size_or_height_is_refused() -> None:
    refused(changed("cabinet", "z", "[1.37, 1.95]"), r"fixtures\.cabinet: the variant 'left_bar' is .*valid: .*1\.350")


def test_floor_that_is_not_free_is_refused(layout: layouts.Layout) -> None:
    skills = dict(KNOWN[CABINET].skills)
    (left, near), (right, far) = skills["open door"].floor
    onto_counter = replace(skills["open door"], floor=((left, near), (right, far + 0.4)))
    with pytest.raises(KitchenFileError, match="fixtures.cabinet: open door needs floor where counter"):
        certificates.check(layout, "odd.toml", known_with(skills={**skills, "open door": onto_counter}))
    wide = replace(skills["open door"], floor=((-9.0, near), (right, -0.1)))
    with pytest.raises(KitchenFileError, match="open door needs floor where .* stands; valid: free from"):
        certificates.check(layout, "odd.toml", known_with(skills={**skills, "open door": wide}))


def test_a_slot_out_of_reach_is_refused(layout: layouts.Layout) -> None:
    counter = KNOWN["counter", ONE_VARIANT]
    narrow = replace(counter, size=Block((-0.1, 0.24, 0.9), (0.1, 0.24, 0.9)))
    with pytest.raises(KitchenFileError, match=r"fixtures\.counter\.slots \(counter\.0\).*off its proof"):
        certificates.check(layout, "odd.toml", {**KNOWN, ("counter", ONE_VARIANT): narrow})


def test_a_malformed_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "bad.toml"
    head = 'body = "bad"\nfingerprint = "0"\n'
    path.write_text(f"{head}[cabinet.left_bar]\nmeasures = 3\n", encoding="utf-8")
    with pytest.raises(KitchenFileError, match=r"bad\.toml: cabinet\.left_bar"):
        certificate_files.read(path)
    with pytest.raises(KitchenFileError, match=r"none\.toml: file: cannot be read"):
        certificate_files.read(tmp_path / "none.toml")
    path.write_text(head.replace("bad", "panda"), encoding="utf-8")
    with pytest.raises(KitchenFileError, match=r"bad\.toml: body: .*panda.*valid: bad"):
        certificate_files.read(path)


def test_loading_needs_no_simulator_and_no_file_at_import() -> None:
    code = (
        "import sys; from remac_env.kitchen import layout; from remac_env.kitchen.fixtures import certificates as c; "
        f"assert c.load.cache_info().currsize == 0; layout.load({NAME!r}); "
        "assert c.load.cache_info().currsize == 1; assert 'mujoco' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd=Path(__file__).parents[2])
