"""`remac learn record-checker` and its kin: labels, files, levels and figures, on planted worlds and answers."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from remac_bench.cli import app
from remac_bench.errors import UsageError
from remac_bench.learning.cells import HELD_OUT, cells
from remac_bench.learning.checker_files import Row, Seen, albums, read_albums, write_album
from remac_bench.learning.checker_measure import LEAST_ALARM, NEVER, Judged, judge, least, measure, warmth
from remac_bench.learning.checker_paint import PaintedWorlds, painted
from remac_bench.learning.checker_poses import shuffled
from remac_bench.learning.checker_record import record
from remac_bench.learning.checker_scenes import Look, labels, seen_in
from remac_bench.learning.checker_sessions import evaluate_checker, spans, train_checker
from remac_bench.learning.checker_train import Recipe, codes, common_in, shares, train, words_in
from typer.testing import CliRunner

from remac_agents.vision.network import SIZE
from remac_agents.vision.questions import RARE, Question, predicates, question_of
from remac_agents.vision.weights import About
from remac_env.kitchen import layout as layouts
from remac_env.kitchen import style as styles
from remac_env.kitchen.worlds import TaskWorlds
from remac_env.rules.conditions import condition
from remac_env.state import FLOOR
from remac_env.tasks import get

ROBOT = "robot_0"
NONE = np.zeros((SIZE, SIZE, 3), np.uint8)


@pytest.fixture(scope="module")
def look() -> Look:
    start, _ = TaskWorlds(get("OpenMicrowavePnP")).start(
        3, style="modern_1", layout="one_wall_large", starts="paper", robots=(ROBOT,), perception_noise=0.0
    )
    world = start.world.with_robot(ROBOT, station=start.scene.fixtures["microwave"].station)
    return Look(start.scene, world, ROBOT, frozenset({"microwave"}))


def told(look: Look) -> dict[Any, tuple[bool, bool]]:
    return {label.condition: (label.truth, label.shown) for label in labels(look)}


def test_what_pictures_show_and_what_they_do_not(look: Look) -> None:
    found = told(look)
    assert found[condition("door_open", "microwave")] == (False, True), "the microwave is in the picture, shut"
    assert found[condition("door_open", "cabinet")] == (False, False), "the cabinet is not"
    assert found[condition("at", ROBOT, "microwave")] == (True, True)
    assert found[condition("at", ROBOT, "cabinet")] == (False, True), "its absence tells"
    assert found[condition("inside", "vegetable", "microwave")] == (False, False), "who knows what is behind a door"
    plate = condition("accessible", "plate")
    assert found[plate] == (False, True), "it must be behind the door that the robot stands before"
    assert condition("accessible", "vegetable") not in found, "nobody asks from here"
    opened = Look(look.rules, look.world.with_fixture("microwave", door="open"), ROBOT, look.seen)
    assert told(opened)[condition("inside", "vegetable", "microwave")] == (False, True)
    fallen = Look(look.rules, look.world.with_object("vegetable", place=FLOOR), ROBOT, look.seen | {"vegetable"})
    assert told(fallen)[condition("placed", "vegetable")] == (False, True)
    assert condition("placed", "sink") not in found and condition("station_free", ROBOT, "sink") not in found
    assert all(question_of(each) is not None for each in found)


def test_a_few_pixels_are_not_seen(look: Look) -> None:
    pixels = {"microwave/door": 30, "microwave/casing": 20, "sink/cabinet": 39, "vegetable": 10, "plate": 9}
    pixels |= {"room/floor": 900}
    assert seen_in(pixels, look.rules) == {"microwave", "vegetable"}


def planted(count: int, *, seed: int = 5, layout: str = "galley") -> list[Seen]:
    """Views whose door is open where the station's picture is bright; of the bowl nothing is seen."""
    views = []
    for index in range(count):
        bright = bool(index % 2)
        station: Any = np.full((SIZE, SIZE, 3), 220 if bright else 30, np.uint8)
        rows = (
            Row("door_open", ("microwave",), bright, True, True),
            Row("door_closed", ("microwave",), not bright, True, False),
            Row("inside", ("fish", "bowl"), bool(index % 3), False, False),
        )  # fmt: skip
        views.append(Seen(station, NONE, "fish" * (index % 2), seed, layout, "coastal", "DefrostInBowl", rows))
    return views


def test_albums_come_back_as_they_were_written_and_add_up(tmp_path: Path) -> None:
    write_album(tmp_path / "a.npz", planted(4))
    write_album(tmp_path / "b.npz", planted(3, seed=9, layout="wraparound"))
    album = read_albums(albums(tmp_path))
    assert album.station.shape == (7, SIZE, SIZE, 3)
    assert album.seeds == (5, 9) and album.layouts == ("galley", "wraparound")
    assert len(album.rows) == 21 and album.rows[-1, 0] == 6
    text = [[album.texts[n] for n in row[1:4]] for row in album.rows]
    assert text[0] == ["door_open", "microwave", ""] and text[-1] == ["inside", "fish", "bowl"]
    assert [album.texts[n] for n in album.view_facts[:2, 1]] == ["", "fish"]


def test_albums_that_are_none_are_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="record-checker"):
        albums(tmp_path)
    (tmp_path / "a.npz").write_bytes(b"no zip")
    with pytest.raises(UsageError, match="cannot be read"):
        read_albums(albums(tmp_path))


def test_what_is_rare_is_put_more_often_and_what_is_unknown_never(tmp_path: Path) -> None:
    write_album(tmp_path / "a.npz", planted(9))
    album = read_albums(albums(tmp_path))
    words = words_in(album)
    assert words.words == ("bowl", "fish", "microwave")
    asked, fine = codes(album, words)
    share = shares(album, asked, fine)
    opened = np.array([album.texts[row[1]] == "door_open" for row in album.rows])
    yes = album.rows[:, 4] == 1
    assert fine.all() and share[opened & yes].min() > share[opened & ~yes].max(), "4 are open, 5 are not"
    rows = album.rows.copy()
    rows[0, 6] = 0
    once = shares(replace(album, rows=rows), asked, fine)
    assert share[0] > once[0] > share[0] / 8, "what is asked at other moments comes between"
    small = type(words)(words.predicates, ("bowl", "fish"))
    assert not codes(album, small)[1][opened].any()


def about(levels: Any) -> About:
    return About(predicates=predicates(), words=(), common=("bowl", "fish", "microwave"), least=levels)


class Sure:
    """Judgements that are right with the probability that they state, and for one predicate wrong."""

    def __init__(self, album: Any, wrong: str = "") -> None:
        right = np.where(album.rows[:, 5] == 1, np.where(album.rows[:, 4] == 1, 0, 1), 2)
        off = np.array([album.texts[number] == wrong for number in album.rows[:, 1]])
        right = np.where(off & (right < 2), 1 - right, right)
        self.judged = Judged(album, 4.0 * np.eye(3)[right], np.ones(len(right), bool))


def test_levels_are_low_for_what_is_always_right_and_out_of_reach_for_what_is_wrong(tmp_path: Path) -> None:
    write_album(tmp_path / "a.npz", planted(200))
    album = read_albums(albums(tmp_path))
    good, bad = Sure(album).judged, Sure(album, "door_open").judged
    common = words_in(album).words
    assert least(good, 1.0, common)["door_open"] == (LEAST_ALARM, LEAST_ALARM), "either answer may be an alarm"
    assert least(good, 1.0, common)["inside"] == (0.5, LEAST_ALARM)
    levels = least(bad, 1.0, common)
    assert min(levels["door_open"]) > 0.95 and levels["door_closed"] == (LEAST_ALARM, LEAST_ALARM)
    figures = measure(bad, about(levels))["door_open"]
    assert figures["true"] == figures["false"] == 100 and figures["right true"] == figures["wrong true"] == 0
    loose = measure(bad, about(dict.fromkeys(levels, (0.5, 0.5))))["door_open"]
    assert loose["wrong true"] == loose["wrong false"] == 100
    assert measure(good, about(least(good, 1.0, common)))["inside"]["hidden told"] == 0
    assert set(measure(good, about(levels), asked_only=True)) == {"door_open"}
    assert warmth(good) < 1.0 < warmth(bad), "what is right may be surer, what is wrong must be less so"
    always = Judged(album, 9.0 * np.tile([1.0, -1.0, -1.0], (len(album.rows), 1)), good.known)
    assert least(always, 1.0, common)["inside"][0] == NEVER


def test_a_kind_with_few_rows_keeps_a_margin_or_takes_what_the_wider_one_has(tmp_path: Path) -> None:
    for count, low, high in ((20, NEVER, NEVER), (80, 0.98, 0.99), (400, 0.9, 0.9)):
        write_album(tmp_path / f"{count}.npz", planted(count))
        album = read_albums([tmp_path / f"{count}.npz"])
        doors = np.array([album.texts[number] == "door_open" for number in album.rows[:, 1]])
        logits = np.log(np.where(doors[:, None], [0.06, 0.88, 0.06], [0.01, 0.85, 0.14]))  # of all others "false"
        judged = Judged(album, logits, np.ones(len(album.rows), bool))
        found = least(judged, 1.0, ("microwave",))
        assert low <= found["door_open microwave"][1] <= high, count


def test_what_was_rarely_met_has_levels_of_its_own(tmp_path: Path) -> None:
    write_album(tmp_path / "a.npz", planted(200))
    album = read_albums(albums(tmp_path))
    judged = Sure(album, "door_open").judged
    for common, bad in ((("microwave",), "door_open"), ((), f"door_open {RARE}")):
        levels = least(judged, 1.0, common)
        other = ({"door_open", f"door_open {RARE}"} - {bad}).pop()
        assert min(levels[bad]) > 0.95 and set(levels) >= set(predicates())
        if common:
            assert levels["door_open microwave"] == levels[bad]
        assert levels[other] == least(judged, 1.0, common)["aside"], "without rows it has what all have together"


def test_words_are_common_that_many_episodes_ask_about(tmp_path: Path) -> None:
    for seed in range(8):
        write_album(tmp_path / f"{seed}.npz", planted(2 if seed else 3, seed=seed))
    album = read_albums(albums(tmp_path))
    assert common_in(album) == ("bowl", "fish", "microwave")
    rows = album.rows.copy()
    rows[rows[:, 0] >= 3, 3] = 0  # one of eight asks about the bowl
    assert common_in(replace(album, rows=rows)) == ("fish", "microwave")


def test_posed_kitchens_have_robots_and_objects_anywhere_and_are_sound() -> None:
    start, _ = TaskWorlds(get("DefrostInBowl")).start(
        3, style="modern_1", layout="one_wall_large", starts="paper", robots=(ROBOT, "robot_1"), perception_noise=0.0
    )
    worlds = [shuffled(start, np.random.default_rng(seed)).world for seed in range(60)]
    assert worlds[3] == shuffled(start, np.random.default_rng(3)).world
    for world in worlds:
        stations = [state.station for state in world.robots.values()]
        assert not start.scene.conflicting(*stations)
        held = {name: state.holding for name, state in world.robots.items() if state.holding}
        by_hand = {item.place.where: name for name, item in world.objects.items() if item.place.relation == "held"}
        assert by_hand == held
        slots = [item.place.where for item in world.objects.values() if item.place.relation == "slot"]
        assert len(slots) == len(set(slots)) and not any(item.place == FLOOR for item in world.objects.values())
    at_sink = [world for world in worlds if world.robots[ROBOT].station == start.scene.fixtures["sink"].station]
    there = {condition("inside", "bowl", "sink").holds(start.scene, world) for world in at_sink}
    assert there == {True, False}, "what is asked at a sink is true, and false"


def test_paint_mixes_styles_and_leaves_alone_what_they_have_in_common() -> None:
    names = ("modern_1", "rustic", "industrial")
    mixed, again, other = (painted(names, np.random.default_rng(seed)) for seed in (1, 1, 2))
    assert mixed.finishes == again.finishes != other.finishes
    given = [styles.load(name) for name in names]
    assert all(mixed[role] == given[0][role] for role in ("water", "glow", "lit_window"))
    assert mixed["counter"] not in [style["counter"] for style in given]
    assert all(mixed.models[kind] in {style.models[kind] for style in given} for kind in mixed.models)
    worlds = PaintedWorlds(get("DefrostInBowl"), mixed)
    assert worlds.layout("galley", "coastal") == layouts.load("galley", mixed.models)


def test_spans_name_seeds_and_parts_that_share_any_are_refused(tmp_path: Path) -> None:
    assert spans([3, 4, 9]) == "3:5,9:10" and spans([]) == ""
    for part in ("train", "calibrate", "test"):
        write_album(tmp_path / part / "a.npz", planted(2))
    with pytest.raises(UsageError, match="5:6"):
        list(train_checker(tmp_path, tmp_path / "w.npz", Recipe()))


def run(*line: str) -> tuple[int, str]:
    done = CliRunner().invoke(app, ["learn", *line])
    return done.exit_code, done.output


@pytest.mark.parametrize("line", [
    ("record-checker", "--backend", "dream", "--out", "x"), ("record-checker", "--episodes", "0", "--out", "x"),
    ("evaluate-checker", "--pictures", "nowhere"),
])  # fmt: skip
def test_wrong_lines_are_refused_in_one_line(line: tuple[str, ...]) -> None:
    code, said = run(*line)
    assert code == 2 and said.startswith("error: "), said


def test_without_torch_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "torch", None)
    code, said = run("train-checker", "--pictures", "x", "--weights", "y.npz")
    assert code == 2 and "remac-kitchen[learn]" in said


# -- the real thing --------------------------------------------------------------------------------------------------


@pytest.mark.long
@pytest.mark.parametrize("backend", ["symbolic", "physics"])
def test_episodes_are_recorded_alike_each_time_with_doors_open_shut_and_ajar(backend: str) -> None:
    seen, kept = cells("all", HELD_OUT)
    views, again = (list(record([110_000], seen, backend=backend)) for _ in range(2))
    assert len(views) > 20 and all(view.layout in seen.layouts for view in views)
    pairs = list(zip(views, again, strict=True))
    assert all(np.array_equal(one.station, other.station) and one.rows == other.rows for one, other in pairs)
    rows = [row for view in views for row in view.rows]
    assert {(row.truth, row.shown) for row in rows} == {(a, b) for a in (True, False) for b in (True, False)}
    assert any(row.asked for row in rows)
    assert not set(kept.layouts) & set(seen.layouts)


@pytest.mark.long
def test_what_is_trained_is_played_alike_and_learns_what_pictures_show(tmp_path: Path) -> None:
    pytest.importorskip("torch")
    for part, seed in (("train", 3), ("calibrate", 4), ("test", 5)):
        write_album(tmp_path / part / "a.npz", planted(96, seed=seed))
    lines = list(train_checker(tmp_path, tmp_path / "w.npz", Recipe(epochs=12, batch=16, questions=6)))
    assert "w.npz" in lines[-1]
    measured, album = evaluate_checker(tmp_path / "w.npz", tmp_path / "test", asked_only=False)
    assert measured["door_open"]["right true"] == measured["door_open"]["true"] == 48
    assert measured["inside"]["hidden told"] == 0 and album.seeds == (5,)
    with pytest.raises(UsageError, match="train"):
        evaluate_checker(tmp_path / "w.npz", tmp_path / "train", asked_only=False)
    network = train(read_albums(albums(tmp_path / "train")), Recipe(epochs=1, batch=16, questions=6))
    found = judge(network, album).logits[0]
    cells_ = network.look({"station": album.station[0], "wrist": album.wrist[0]})
    assert network.answer(cells_, [Question("door_open", ("microwave",))], "")[0] == pytest.approx(found, abs=1e-4)
