"""`remac learn`: what is recorded comes back as it was, trains, and is measured; without the libraries it says so."""

from __future__ import annotations

import importlib.util
import json
import re
import sys
import types
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from bench_helpers import record
from remac_bench.cli import app
from remac_bench.errors import UsageError
from remac_bench.learning import train as learning
from remac_bench.learning.cells import HELD_OUT, cells
from remac_bench.learning.chats import chats, write_chats
from remac_bench.learning.demos import Demo, check_body, file_digest, read_demos, shards, write_shard
from remac_bench.learning.evaluate import evaluate, score
from remac_bench.learning.record import Recorder
from remac_bench.learning.sessions import shown_cases, train_together
from remac_bench.learning.train import Frames, Recipe, frames, train
from remac_bench.records import ExchangeEntry, OutcomeEntry
from typer.testing import CliRunner

from remac_env.backends.physics.controllers.learned.network import HAND, Network
from remac_env.backends.physics.controllers.learned.seen import entries
from remac_env.backends.physics.controllers.learned.weights import About, Weights, save_weights
from remac_env.errors import UnknownNameError
from remac_env.lowlevel.control import Joints
from remac_env.robots import bodies
from remac_env.robots.panda import measures as panda
from remac_env.rules.skills import SKILLS

ARRAYS = ("observations", "actions", "commands", "measured", "states", "rewards")


def run(*line: str) -> tuple[int, str]:
    done = CliRunner().invoke(app, ["learn", *line])
    return done.exit_code, done.output


@pytest.fixture(scope="module")
def demo() -> Demo:
    made = Recorder("turn on", "faucet").record(1000, style="modern_1", layout="one_wall_large")
    assert made is not None
    return made


def test_a_demonstration_has_clean_labels_under_disturbed_servos(demo: Demo) -> None:
    steps = len(demo.actions)
    assert demo.observations.shape[0] == steps + 1 and demo.states.shape[0] == steps
    assert np.abs(demo.actions).max() <= 1.0 and demo.rewards[-1] == 1.0 and demo.rewards[0] == 0.0
    calm = Recorder("turn on", "faucet", disturb=0.0).record(1000, style="modern_1", layout="one_wall_large")
    assert calm is not None
    # The scripted way is as smooth as ever in what is asked for; what was measured is not.
    asked, done = (np.abs(np.diff(part[:, 4:11], n=2, axis=0)).mean() for part in (demo.commands, demo.measured))
    quiet = np.abs(np.diff(calm.measured[:, 4:11], n=2, axis=0)).mean()
    assert done > 2 * quiet and asked < done


def test_actions_lead_from_one_set_point_to_the_next() -> None:
    q = panda.tucked(1.0, 2.0, 0.7)
    control = Joints(bodies.get())
    control.begin(_Robot(q))  # type: ignore[arg-type]
    action = np.array([0.5, -0.3, 0.2, 0.1, *[0.4] * 7, 0.6])
    after, opening = control.apply(action.astype(np.float32))
    assert control.action(q, after, opening) == pytest.approx(action, abs=1e-6)


class _Robot:
    """Set-points, and a robot that is where they are."""

    def __init__(self, q: np.ndarray) -> None:
        self._q, self.sensing = q, self
        self.body = self

    @property
    def q(self) -> np.ndarray:
        return self._q.copy()


def test_frames_tell_what_comes_next_from_where_the_robot_is(demo: Demo) -> None:
    data = frames([demo], 5)
    assert data.wanted.shape[1:] == (5, 12)
    assert len(data.seen) < len(demo.actions), "frames in which nothing moves are left out"
    first = demo.commands[0] - np.append(demo.measured[0], 0.0)
    assert np.allclose(data.wanted[0, 0], first, atol=1e-6)


@pytest.mark.filterwarnings("ignore::remac_env.errors.UncertifiedWarning")
def test_another_body_is_recorded_and_learnt_from_with_its_own_joints(
    demo: Demo, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bodies, "_BODIES", dict(bodies._BODIES))
    name = f"{Path(__file__).parents[1] / 'robots' / 'six_joints.py'}:SixJoints"
    other = Recorder("turn on", "faucet", body=name).record(1000, style="modern_1", layout="one_wall_large")
    assert other is not None and other.body == name
    assert other.actions.shape[1:] == other.commands.shape[1:] == (11,) and other.measured.shape[1:] == (10,)
    data = frames([other], 16, hand=True)
    assert data.wanted.shape[1:] == (16, 11 + HAND) and np.abs(data.wanted[:, 0, 11:14]).max() < 0.3
    fingerprint = bodies.get(name).fingerprint
    check_body(tmp_path, name, fingerprint)
    for body, found, told in (("panda", fingerprint, name), (name, bodies.get().fingerprint, "panda")):
        with pytest.raises(UsageError, match=re.escape(f"was recorded with body {told!r}, not {body!r}; give --body")):
            check_body(tmp_path, body, found)


def test_headings_are_told_within_half_a_turn(demo: Demo) -> None:
    turned = replace(demo, commands=demo.commands.copy(), measured=demo.measured.copy())
    turned.commands[:, 2], turned.measured[:, 2] = -np.pi + 0.01, np.pi - 0.02  # on both sides of where they are cut
    data = frames([turned], 5)
    assert np.allclose(data.wanted[..., 2], 0.03, atol=1e-5)
    assert np.array_equal(np.delete(data.wanted, 2, axis=2), np.delete(frames([demo], 5).wanted, 2, axis=2))


def test_what_is_overlooked_has_no_weight() -> None:
    pytest.importorskip("torch")
    chance, inputs = np.random.default_rng(0), 6
    seen = chance.normal(size=(64, inputs)).astype(np.float32)
    wanted = np.repeat(seen[:, None, :1], 12, axis=2)
    network = train(Frames(seen, wanted, [0, 3]), Recipe(epochs=1, width=8, depth=1, batch=16))
    other = seen[0].copy()
    other[[0, 3]] += 100.0
    assert np.allclose(network.commands(other), network.commands(seen[0]), atol=1e-5)
    other[1] += 1.0
    assert not np.allclose(network.commands(other), network.commands(seen[0]), atol=1e-5)


def test_training_is_the_same_with_any_number_of_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    torch = pytest.importorskip("torch", reason="torch is not installed: docs/learning.md says how")
    chance = np.random.default_rng(0)
    seen = chance.normal(size=(2048, 56)).astype(np.float32)
    data, recipe = Frames(seen, np.repeat(seen[:, None, :12], 16, axis=1), []), Recipe(epochs=2)

    def weights(threads: int) -> bytes:
        torch.set_num_threads(threads)
        network = train(data, recipe)
        assert torch.get_num_threads() == threads, "as it was before"
        return network.last[0].tobytes()

    before = torch.get_num_threads()
    try:
        assert weights(1) == weights(2) == weights(3)
        ours = weights(1)
        monkeypatch.setattr(learning, "THREADS", 2)
        assert weights(1) != ours, "so it does depend on them"
    finally:
        torch.set_num_threads(before)


def test_cells_that_are_held_out_are_never_recorded() -> None:
    seen, kept = cells("table", HELD_OUT)
    assert not set(HELD_OUT) & {*seen.styles, *seen.layouts}
    assert set(HELD_OUT) == {*kept.styles, *kept.layouts}
    assert {seen.of(seed, "turn on")[1] for seed in range(60)} == set(seen.layouts)
    with pytest.raises(UnknownNameError, match="igloo"):
        cells("table", ("igloo",))


@pytest.mark.long
def test_only_what_is_asked_for_is_recorded_and_what_was_shown_is_measured() -> None:
    case = "food in vessel on surface"
    made = Recorder("place to", case=case).record(1000)
    assert made is not None and made.case == case
    data = frames([made], 4, hand=True)
    assert data.wanted.shape[1:] == (4, 21)
    whole = frames([replace(made, skill="open door")], 4, hand=True)
    assert len(data.seen) < len(whole.seen), "what is put is over soon after, and a door is not"
    network = train(data, Recipe(epochs=1, width=8, depth=1)) if importlib.util.find_spec("torch") else None
    if network is not None:
        told = "place to " + case
        about = About(skill="place to", targets=(), execute=4, cases=(told,), measured={told: _NEVER})
        weights = Weights(about=about, network=network, sample=data.seen[:2])
        (trial,) = evaluate("place to", weights, range(50_000, 50_001), cells("table", ())[0])
        assert trial.case == trial.what == case and not trial.outcome.success, "it is not played by the script"


@pytest.mark.long
def test_a_pan_stands_on_the_stove_before_food_is_put_into_it_there() -> None:
    made = Recorder("place to", "pan", case="food in vessel on burner").record(1000)
    assert made is not None and made.case == "food in vessel on burner" and made.command == "place to pan"


@pytest.mark.long
def test_weights_lead_and_the_script_goes_on_from_where_they_have_come(tmp_path: Path) -> None:
    case, inputs = "food on surface", len(entries(SKILLS["pick up"]))
    zeros, raised = np.zeros((8, 12), np.float32), np.zeros(96, np.float32)
    raised[3::12] = 0.02  # the lift, m
    layer = (np.zeros((4, inputs), np.float32), *[np.zeros(4, np.float32)] * 3)
    network = Network(np.zeros(inputs, np.float32), np.ones(inputs, np.float32), (layer,),
                      (np.zeros((96, 4), np.float32), raised), zeros, zeros + 1.0)  # fmt: skip
    about = About(skill="pick up", targets=(), execute=8, cases=("pick up " + case,))
    sample = np.ones((1, inputs), np.float32)
    save_weights(tmp_path / "PickUp.npz", Weights(about=about, network=network, sample=sample))
    alone, led = (Recorder("pick up", case=case, led_by=by, disturb=0.0).record(1003) for by in (None, tmp_path))
    assert alone is not None and led is not None and led.rewards[-1] == 1.0
    assert led.measured[0][3] > alone.measured[0][3] + 0.01, "the lift is up when the demonstration begins"
    with pytest.raises(UsageError, match="no weights for 'place to'"):
        Recorder("place to", led_by=tmp_path).record(1003)


def test_cases_count_as_shown_from_twenty_demonstrations_on(demo: Demo) -> None:
    often, rarely = (replace(demo, skill="pick up", case=case) for case in ("food on surface", "vessel on surface"))
    assert shown_cases([often] * 20 + [rarely] * 19) == ("pick up food on surface",)
    told = ("pick up food on surface", "pick up vessel on surface")
    assert shown_cases([often, rarely]) == told, "of a few, all of them"
    assert shown_cases([demo]) == ()


def test_drives_and_other_skills_do_not_see_the_same(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="one kind together"):
        next(train_together(["navigate to", "open door"], tmp_path, tmp_path, Recipe()))


_NEVER = {"trials": 9, "successes": 0}


@pytest.mark.long
def test_the_scripted_controllers_are_measured_likewise() -> None:
    seen, _ = cells("table", HELD_OUT)
    (trial,) = evaluate("turn on", None, range(50_000, 50_001), seen, target="faucet")
    assert trial.target == "faucet" and score("x", [trial]).trials == 1


@pytest.mark.parametrize("line", [
    ("record", "--skills", "Juggle", "--out", "x"), ("record", "--skills", "NavigateAside", "--out", "x"),
    ("record", "--cells", "moon", "--out", "x"), ("record", "--hold-out", "igloo", "--out", "x"),
    ("record", "--episodes", "0", "--out", "x"), ("evaluate", "--weights", "nowhere", "--trials", "1"),
    ("record", "--skills", "OpenDoor", "--led-by", "x", "--out", "x"),
])  # fmt: skip
def test_wrong_lines_are_refused_in_one_line(line: tuple[str, ...]) -> None:
    code, said = run(*line)
    assert code == 2 and said.startswith("error: "), said


@pytest.mark.parametrize(("missing", "line"), [
    ("h5py", ("record", "--out", "x")), ("h5py", ("train", "--demos", "x", "--weights", "y")),
    ("torch", ("train", "--demos", "x", "--weights", "y")),
])  # fmt: skip
def test_without_the_libraries_it_says_what_to_install(
    missing: str, line: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "h5py", types.ModuleType("h5py"))
    monkeypatch.setitem(sys.modules, missing, None)
    monkeypatch.chdir(tmp_path)
    code, said = run(*line)
    assert code == 2 and "remac-kitchen[learn]" in said and missing in said, said
    assert not list(tmp_path.iterdir())


def test_shards_come_back_as_they_were_written_in_robomimics_layout(demo: Demo, tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py", reason="h5py is not installed: docs/learning.md says how")
    path = tmp_path / "TurnOn_001000.hdf5"
    write_shard(path, [demo, demo])
    assert shards(tmp_path, "turn on") == [path] and len(file_digest([path])) == 12
    for again in read_demos([path]):
        for name in (*ARRAYS, "target", "seed", "layout"):
            assert np.array_equal(getattr(again, name), getattr(demo, name)), name
    with h5py.File(path, "r") as file:
        assert file["data"].attrs["total"] == 2 * len(demo.actions)
        made = json.loads(file["data"].attrs["env_args"])
        assert made["env_name"] == "RemacSkill-TurnOn-v0" and made["env_kwargs"] == {"control": "joints"}
        one = file["data/demo_0"]
        assert {*one} >= {"actions", "dones", "rewards", "states"} and "state" in one["obs"]
        assert one.attrs["num_samples"] == len(one["actions"]) == len(one["obs/state"]) == len(one["next_obs/state"])
        assert [*file["mask/train"]] + [*file["mask/valid"]] == [b"demo_0", b"demo_1"]


@pytest.mark.long
def test_thirty_demonstrations_are_enough_for_a_faucet(tmp_path: Path) -> None:
    torch = pytest.importorskip("torch", reason="torch is not installed: docs/learning.md says how")
    pytest.importorskip("h5py")
    torch.set_num_threads(1)
    seen, kept = cells("table", HELD_OUT)
    recorder, demos = Recorder("turn on", "faucet"), []
    for seed in range(1000, 1030):
        style, layout = seen.of(seed, "turn on")
        demos.append(recorder.record(seed, style=style, layout=layout))
    data = frames([made for made in demos if made is not None], 16)
    network = train(data, Recipe(epochs=60))
    about = About(skill="turn on", targets=("faucet",), execute=8)
    weights = Weights(about=about, network=network, sample=data.seen[:2])
    trials = list(evaluate("turn on", weights, range(50_000, 50_010), kept, target="faucet"))
    assert score("faucet", trials).successes >= 8, score("faucet", trials)
    assert SKILLS["turn on"].name == trials[0].skill
    layers = torch.nn.Sequential(
        *(part for weight, bias, gain, shift in network.layers for part in _layer(torch, weight, bias, gain, shift)),
        _linear(torch, *network.last),
    )
    shown = torch.from_numpy((data.seen[:20] - network.mean) / network.std)
    with torch.no_grad():
        said = layers(shown).numpy().reshape(20, 16, 12) * network.out_std + network.out_mean
    assert np.allclose(said, [network.commands(one) for one in data.seen[:20]], atol=1e-5)


def _linear(torch: object, weight: np.ndarray, bias: np.ndarray) -> object:
    made = torch.nn.Linear(weight.shape[1], weight.shape[0])  # type: ignore[attr-defined]
    made.weight.data, made.bias.data = torch.from_numpy(weight), torch.from_numpy(bias)  # type: ignore[attr-defined]
    return made


def _layer(torch: object, weight: np.ndarray, bias: np.ndarray, gain: np.ndarray, shift: np.ndarray) -> list[object]:
    norm = torch.nn.LayerNorm(len(gain))  # type: ignore[attr-defined]
    norm.weight.data, norm.bias.data = torch.from_numpy(gain), torch.from_numpy(shift)  # type: ignore[attr-defined]
    return [_linear(torch, weight, bias), norm, torch.nn.ReLU()]  # type: ignore[attr-defined]


def test_questions_and_answers_become_conversations_with_what_came_of_them(tmp_path: Path) -> None:
    asked = {"role": "planner", "messages": [("system", "You plan."), ("user", "Heat it.")], "reply": "Plan: []"}
    went = {"robot_0": OutcomeEntry(subtask="navigate to pan", status="success")}
    good = record(
        success=True, rounds=2, outcomes=[went, went],
        exchanges=[
            ExchangeEntry(round=0, **asked), ExchangeEntry(round=1, **asked | {"role": "checker", "reply": "yes"}),
            ExchangeEntry(round=1, **asked | {"reply": ""}), ExchangeEntry(round=1, **asked, error="timeout"),
            ExchangeEntry(round=1, **asked | {"reply": "a\n[... 9 characters left out ...]\nb"}),
        ],
    )  # fmt: skip
    bad = record(success=False, exchanges=[ExchangeEntry(round=0, **asked)])
    first, second, third = chats([good, bad])
    assert first["messages"][-1] == {"role": "assistant", "content": "Plan: []"} and len(first["messages"]) == 3
    assert [len(one["outcomes"]) for one in (first, second, third)] == [2, 1, 0]
    assert first["outcomes"][0] == {"robot_0": {"subtask": "navigate to pan", "status": "success", "reason": None}}
    assert [one["asked"] for one in chats([good, bad], roles=["checker"])] == ["checker"]
    assert [one["success"] for one in chats([good, bad], successful=True)] == [True, True]
    path = tmp_path / "chats.jsonl"
    assert write_chats(path, [first, third]) == 2
    assert [json.loads(line) for line in path.read_text("utf-8").splitlines()] == [first, third]
