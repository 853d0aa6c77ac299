"""Trained policies as planners: a file of numbers, what is refused of it, and what a policy does in kitchens."""

from __future__ import annotations

import hashlib
import io
import json
import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from agent_kitchens import play, suite_kitchen

import remac_agents
from remac_agents.planners.policy_file import Policy, read_policy, save_policy
from remac_agents.wiring.catalogue import is_plugin, looks_at_pictures, make_role
from remac_env.errors import OptionError
from remac_env.observation import Facts
from remac_env.oracle import solve
from remac_env.vocabulary import Vocabulary

ROOT = Path(__file__).resolve().parents[3]
TASK, SEEDS = "OpenMicrowavePnP", range(4)


@pytest.fixture(scope="module")
def policy() -> Policy:
    """One layer that scores the oracle's choice highest in each world of these episodes: fitted, as a real one is."""
    env = suite_kitchen(TASK, robots=1)
    facts, seen, wanted = Facts(env.vocabulary), [], []
    for seed in SEEDS:
        env.reset(seed=seed)
        for joint in solve(env.start.scene, env.world, env.goal).rounds:
            token = env.vocabulary.encode(joint["robot_0"].text)
            seen.append(np.append(facts.vector(env.start.scene, env.world, "robot_0"), 1.0))
            wanted.append(np.eye(len(env.vocabulary))[token])
            env.step({"robot_0": token})
    weights = np.linalg.lstsq(np.array(seen), np.array(wanted), rcond=None)[0].T.astype(np.float32)
    layers = ((weights, np.zeros(len(weights), np.float32)),)
    return Policy(tasks=(TASK,), layers=layers, vocabulary=env.vocabulary)


@pytest.fixture
def file(policy: Policy, tmp_path: Path) -> Path:
    save_policy(tmp_path / "policy.npz", policy)
    return tmp_path / "policy.npz"


def test_a_policy_plays_what_it_learnt_and_tables_say_that_it_reads_the_truth(file: Path) -> None:
    for seed in SEEDS:
        env, agent = suite_kitchen(TASK, robots=1), remac_agents.make("BASE", planner=f"policy:{file}")
        report, oracle = (play(env, who, seed=seed) for who in (agent, remac_agents.make("BASE", planner="oracle")))
        assert report.success and report.initial_plan == oracle.initial_plan
        assert "planner" in report.truth_readers and "planner" in report.rule_readers
    assert not is_plugin("planner", f"policy:{file}") and not looks_at_pictures("planner", f"policy:{file}")


def test_a_file_gives_back_what_was_saved(policy: Policy, file: Path) -> None:
    read = read_policy(file)
    assert read.vocabulary.entries == policy.vocabulary.entries and read.tasks == policy.tasks
    facts = np.ones(Facts(policy.vocabulary).size, np.float32)
    assert np.array_equal(read.scores(facts, TASK), policy.scores(facts, TASK))
    assert not np.array_equal(read.scores(facts, TASK), read.scores(facts, "another")), "the task is an input"


def test_layers_and_activations_are_what_a_network_computes(policy: Policy) -> None:
    chance = np.random.default_rng(0)
    sizes = (Facts(policy.vocabulary).size + 1, 5, 3, len(policy.vocabulary))
    layers = tuple(
        (chance.normal(size=(m, n)).astype(np.float32), chance.normal(size=m).astype(np.float32))
        for n, m in zip(sizes, sizes[1:], strict=False)
    )
    facts = chance.integers(0, 2, sizes[0] - 1).astype(np.float32)
    (a, x), (b, y), (c, z) = layers
    for name, act in (("tanh", np.tanh), ("relu", lambda v: v * (v > 0))):
        deep = replace(policy, layers=layers, activation=name)
        assert np.allclose(deep.scores(facts, TASK), c @ act(b @ act(a @ np.append(facts, 1) + x) + y) + z, atol=1e-3)


def test_one_that_learnt_alone_works_alone_and_one_that_learnt_in_a_team_commands_both(
    policy: Policy, tmp_path: Path
) -> None:
    for robots in (1, 2):
        save_policy(tmp_path / "team.npz", replace(policy, robots=robots))
        report = play(suite_kitchen(TASK), remac_agents.make("BASE", planner=f"policy:{tmp_path / 'team.npz'}"), seed=0)
        busy = [robot for robot, row in report.initial_plan.items() if row]
        assert len(busy) == robots
        assert report.success or robots == 2


def test_one_that_has_learnt_nothing_stops_where_it_has_been(policy: Policy, tmp_path: Path) -> None:
    nothing = tuple((np.zeros_like(weights), bias) for weights, bias in policy.layers)
    save_policy(tmp_path / "nothing.npz", replace(policy, layers=nothing, masks="grammar"))
    agent = remac_agents.make("BASE", planner=f"policy:{tmp_path / 'nothing.npz'}")
    report = play(suite_kitchen(TASK, robots=1), agent)
    assert not report.success and report.initial_plan_length == 0


def test_another_task_and_words_that_it_does_not_know_are_no_plan(policy: Policy, file: Path, tmp_path: Path) -> None:
    report = play(suite_kitchen("HeatOnStove"), remac_agents.make("BASE", planner=f"policy:{file}"))
    assert "has not learnt 'HeatOnStove'" in report.errors[0]
    old = Vocabulary([n for n in policy.vocabulary.entries if n.name != "sink"], version=1)
    layer = (np.zeros((len(old), Facts(old).size + 1), np.float32), np.zeros(len(old), np.float32))
    save_policy(tmp_path / "old.npz", replace(policy, vocabulary=old, layers=(layer,)))
    report = play(suite_kitchen(TASK), remac_agents.make("BASE", planner=f"policy:{tmp_path / 'old.npz'}"))
    assert "does not know sink" in report.errors[0]


# -- what is refused ---------------------------------------------------------------------------------


class Payload:
    """What pickle would run."""

    def __reduce__(self) -> Any:
        return Path.touch, (Path("was_run"),)


def parts(file: Path) -> dict[str, Any]:
    with np.load(file) as found:
        return {name: found[name] for name in found.files}


def about(found: dict[str, Any], **changed: Any) -> dict[str, Any]:
    return found | {"about": np.array(json.dumps(json.loads(str(found["about"])) | changed))}


CHANGES: dict[str, tuple[Any, str]] = {
    "code": (lambda found: found | {"weight_0": np.array([Payload()], object)}, "cannot be read"),
    "no text": (lambda found: {k: v for k, v in found.items() if k != "about"}, "cannot be read"),
    "another format": (lambda found: about(found, format="remac-policy-9"), "no policy of this version"),
    "a list": (lambda found: found | {"about": np.array("[]")}, "no policy of this version"),
    "deep": (lambda found: found | {"about": np.array("[" * 100_000)}, "cannot be read"),
    "no task": (lambda found: about(found, tasks=[]), "tasks"),
    "tasks that are none": (lambda found: about(found, tasks=7), "cannot be read"),
    "five robots": (lambda found: about(found, robots=5), "robots 5"),
    "no robot": (lambda found: about(found, robots=True), "robots True"),
    "masks": (lambda found: about(found, masks="none"), "masks 'none'.*feasible"),
    "activation": (lambda found: about(found, activation=["tanh"]), "activation"),
    "nouns": (lambda found: about(found, nouns=[["pan", "spaceship", []]]), "noun|layer|cannot be read"),
    "nouns of no shape": (lambda found: about(found, nouns=[3]), "cannot be read"),
    "fewer inputs": (
        lambda found: found | {"weight_0": found["weight_0"][:, 1:]}, r"layer 0 has .*valid: \(units, \d+\)"
    ),
    "fewer tokens": (
        lambda found: found | {"weight_0": found["weight_0"][1:], "bias_0": found["bias_0"][1:]}, "one for each of"
    ),
    "a bias of another layer": (lambda found: found | {"bias_0": found["bias_0"][1:]}, "layer 0"),
    "no bias": (lambda found: {k: v for k, v in found.items() if k != "bias_0"}, "cannot be read"),
    "not finite": (lambda found: found | {"bias_0": found["bias_0"] * np.nan}, "not finite"),
    "texts": (lambda found: found | {"bias_0": found["bias_0"].astype(str).astype("U9")[:3]}, "layer 0"),
    "no layer": (lambda found: {"about": found["about"]}, "last layer"),
}  # fmt: skip


@pytest.mark.parametrize("case", CHANGES)
def test_what_is_no_policy_is_refused_and_not_run(
    case: str, file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    change, told = CHANGES[case]
    np.savez(tmp_path / "wrong.npz", **change(parts(file)))
    with pytest.raises(OptionError, match=f"wrong.npz.*({told})"):
        make_role("planner", f"policy:{tmp_path / 'wrong.npz'}")
    assert not (tmp_path / "was_run").exists()


def test_the_payload_is_one_that_would_be_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Or else the test above would prove nothing."""
    monkeypatch.chdir(tmp_path)
    np.savez("payload.npz", weight_0=np.array([Payload()], object))
    np.load("payload.npz", allow_pickle=True)["weight_0"]
    assert (tmp_path / "was_run").exists()


def test_files_that_are_no_archives_too_large_or_not_there(file: Path, tmp_path: Path) -> None:
    whole = file.read_bytes()
    bare = io.BytesIO()
    np.save(bare, np.zeros(3))
    for number, data in enumerate((b"", b"PK", whole[: len(whole) // 2], whole[:-30], bare.getvalue())):
        (tmp_path / f"{number}.npz").write_bytes(data)
        with pytest.raises(OptionError, match=f"{number}.npz"):
            read_policy(tmp_path / f"{number}.npz")
    broken = bytearray(whole)
    broken[len(whole) // 2] ^= 255
    (tmp_path / "broken.npz").write_bytes(broken)
    with pytest.raises(OptionError, match="broken.npz"):
        read_policy(tmp_path / "broken.npz")
    bomb = zipfile.ZipFile(tmp_path / "bomb.npz", "w", zipfile.ZIP_DEFLATED, compresslevel=1)
    with bomb, bomb.open("weight_0.npy", "w") as part:
        for _ in range(101):
            part.write(bytes(1_000_000))
    with pytest.raises(OptionError, match="unpacked it has 101000000 bytes"):
        read_policy(tmp_path / "bomb.npz")
    with zipfile.ZipFile(tmp_path / "boast.npz", "w") as boast, boast.open("about.npy", "w") as part:
        np.lib.format.write_array_header_1_0(part, {"shape": (10**14,), "fortran_order": False, "descr": "<f4"})
    with pytest.raises(OptionError, match="boast.npz"):
        read_policy(tmp_path / "boast.npz")
    with pytest.raises(OptionError, match="no_such.npz"):
        read_policy(tmp_path / "no_such.npz")
    with pytest.raises(OptionError, match="ends in .npz"):
        save_policy(tmp_path / "policy.pt", read_policy(file))


def test_records_can_name_the_numbers_and_not_the_file_alone(file: Path, tmp_path: Path) -> None:
    digest = hashlib.sha256(file.read_bytes()).hexdigest()
    line = f"--planner policy:policy.npz,sha256={digest} --methods BASE --tasks {TASK} --seeds 0 --robots 1"
    line += " --backend symbolic --jobs 0 --out out"
    done = subprocess.run(
        [sys.executable, "-m", "remac_bench", "bench", "run", *line.split()],
        cwd=tmp_path, capture_output=True, text=True, timeout=120,
        env={"PYTHONPATH": f"{ROOT}:{ROOT / 'benchmarks'}", "PATH": "/usr/bin:/bin"},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    (record,) = map(json.loads, (tmp_path / "out/records.jsonl").read_text().splitlines())
    assert record["success"] and "planner" in record["truth_readers"]
    assert record["options"]["agent"]["planner"] == f"policy:policy.npz,sha256={digest}"
    with pytest.raises(OptionError, match=digest):
        make_role("planner", f"policy:{file},sha256={'0' * 64}")
