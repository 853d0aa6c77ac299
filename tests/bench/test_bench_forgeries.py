"""Forged runs: a suite is played honestly, falsified in every way we could think of, and each is found out."""

from __future__ import annotations

import json
import shutil
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from bench_helpers import read
from remac_bench.errors import UsageError
from remac_bench.playing import suites
from remac_bench.playing.agents import Access
from remac_bench.playing.code import code_digest
from remac_bench.playing.runner import Settings, run_jobs
from remac_bench.proof.acceptance import ACCEPTED, accept
from remac_bench.proof.standings import gather
from remac_bench.proof.submission import ENTRY, looks, pack, read_entry, submission_digest
from remac_bench.proof.verify import verify
from test_bench_cli import remac

from remac_env.errors import OptionError

sys.path.append(str(Path(__file__).parents[1] / "llm"))
from chaos_server import ChaosServer, says  # noqa: E402

SUITE = """
name = "small"
version = 1
about = "Two tasks, one start each."
methods = ["BASE", "RE"]
floors = ["reader"]
[[jobs]]
tasks = ["OpenCabinetPnP", "DefrostInBowl"]
seeds = "3"
kitchen = { backend = "symbolic" }
"""
NAIVE = "navigate to vegetable, pick up vegetable, navigate to cabinet, place to cabinet"

Lines = list[dict[str, Any]]
Forgery = Callable[[Lines], None]


@pytest.fixture(scope="module")
def honest(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A folder with every record of the suite: of the offline roles, and of a planner that is a model."""
    files, folder = tmp_path_factory.mktemp("suites"), tmp_path_factory.mktemp("honest")
    (files / "small.toml").write_text(SUITE)
    patch = pytest.MonkeyPatch()
    patch.setattr(suites, "_folder", lambda: files)
    patch.setenv("XDG_STATE_HOME", str(tmp_path_factory.mktemp("state")))  # of the key that seals acceptances
    with ChaosServer() as server:
        server.script = [says(f"Plan: [{NAIVE}]", usage={"prompt_tokens": 900, "completion_tokens": 40})]
        access = Access(base_url=server.url, cassette=str(folder / "cassette.jsonl"))
        listed = suites.load("small").jobs([{}, {"planner": "custom:m"}], access=access)
        run_jobs(listed, folder, Settings(workers=0, preflight=False))
        yield folder
    patch.undo()


def forged(honest: Path, copy: Path, change: Forgery) -> Path:
    """A copy of the folder whose records were changed."""
    if copy != honest:
        shutil.copytree(honest, copy)
    path = copy / "records.jsonl"
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    change(lines)
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    return copy


def stands(folder: Path) -> list[str]:
    """What stands in a folder's records, whoever reads it."""
    return [json.dumps(json.loads(line)) for line in (folder / "records.jsonl").read_text().splitlines()]


def asked(lines: Lines) -> dict[str, Any]:
    """The scored record of BASE with the model as planner."""
    return next(r for r in lines if r["options"]["agent"].get("planner") == "custom:m" and r["method"] == "BASE")


def learner(lines: Lines) -> dict[str, Any]:
    """The scored record of RE with the offline roles."""
    return next(r for r in lines if r["method"] == "RE" and r["scored"] and "planner" not in r["options"]["agent"])


def failure(lines: Lines) -> dict[str, Any]:
    """A scored failure that was played."""
    return next(r for r in lines if r["scored"] and not r["success"] and r["rounds"] > 2)


def set_field(pick: Callable[[Lines], dict[str, Any]], name: str, value: Any) -> Forgery:
    """One field of one record set otherwise."""

    def change(lines: Lines) -> None:
        record = pick(lines)
        record[name] = value(record[name]) if callable(value) else value

    return change


def _relabel_model(lines: Lines) -> None:
    for record in lines:
        if record["options"]["agent"].get("planner") == "custom:m":
            record["options"]["agent"]["planner"] = "custom:famous"
            record["agent"] = record["agent"].replace("custom:m", "custom:famous")
    _rekey(lines)


def _rekey(lines: Lines) -> None:
    """Whoever forges options works out the job's key anew, too, and does not mind what is not known here."""
    from remac_bench.proof import again
    from remac_bench.records import Record

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(again, "check_body", lambda kitchen: None)
        for record in lines:
            record["job"] = again.read_job(Record(**record)).key


def _other_backend(lines: Lines) -> None:
    for record in lines:
        record["backend"] = record["options"]["kitchen"]["backend"] = "physics"
    _rekey(lines)


def _other_starts(lines: Lines) -> None:
    record = failure(lines)
    record["starts"] = record["options"]["kitchen"]["starts"] = "mixed"
    record["job"] = "0" * 12
    _rekey(lines)


def _delete_failures(lines: Lines) -> None:
    lost = {record["job"] for record in lines if record["scored"] and not record["success"]}
    lines[:] = [record for record in lines if record["job"] not in lost]


def _delete_one_task(lines: Lines) -> None:
    lines[:] = [record for record in lines if record["task"] != "DefrostInBowl"]


def _delete_the_floors(lines: Lines) -> None:
    lines[:] = [record for record in lines if record["options"]["agent"].get("planner") != "reader"]


def _win_again(lines: Lines) -> None:
    """The same success once more under another key."""
    won = next(record for record in lines if record["scored"] and record["success"])
    lines.append({**won, "job": "f" * 12})


def _second_try(lines: Lines) -> None:
    """A failed job played again until it went well; the later line counts."""
    record = json.loads(json.dumps(failure(lines)))
    record["success"], record["end"] = True, "success"
    lines.append(record)


def _blame_the_network(lines: Lines) -> None:
    record = failure(lines)
    record["error"] = {"kind": "infrastructure", "type": "OSError", "message": "down", "where": []}
    record["scored"] = False


def _outcome(lines: Lines) -> None:
    turn = next(t for t in failure(lines)["outcomes"] for o in t.values() if o["status"] == "failure")
    for outcome in turn.values():
        outcome["status"], outcome["reason"] = "success", None


def _all_worlds(lines: Lines) -> None:
    record = failure(lines)
    record["worlds"] = [record["worlds"][0]] * len(record["worlds"])


def _usage(field: str, value: Any) -> Forgery:
    def change(lines: Lines) -> None:
        asked(lines)["usage"][field] = value

    return change


def _exchange(field: str, value: Any) -> Forgery:
    def change(lines: Lines) -> None:
        asked(lines)["exchanges"][0][field] = value

    return change


def _drop_exchanges(lines: Lines) -> None:
    asked(lines)["exchanges"] = []


def _other_suite_version(lines: Lines) -> None:
    for record in lines:
        record["suite_version"] = 2


def _no_suite(lines: Lines) -> None:
    record = failure(lines)
    record["suite"] = record["suite_version"] = record["suite_digest"] = None


def _more_rounds(lines: Lines) -> None:
    record = failure(lines)
    record["options"]["kitchen"]["max_rounds"] = 99
    _rekey(lines)


def _fewer_iterations(lines: Lines) -> None:
    """RE's iteration 0 passed off as all that was played."""
    for record in lines:
        if record["method"] == "RE" and record["iteration"] == 0:
            record["options"]["iterations"], record["scored"] = 0, True
    lines[:] = [record for record in lines if record["iteration"] == 0]
    _rekey(lines)


def _truth_reader(lines: Lines) -> None:
    learner(lines)["truth_readers"] = []


def _checks(lines: Lines) -> None:
    checks = learner(lines)["pre_checks"]
    checks[0]["verdict"] = not checks[0]["verdict"]


def _seed(lines: Lines) -> None:
    record = failure(lines)
    record["seed"] = 4
    _rekey(lines)


def _kitchen(name: str, value: Any) -> Forgery:
    """A failure passed off as one of a kitchen with another option."""

    def change(lines: Lines) -> None:
        record = failure(lines)
        record["options"]["kitchen"][name] = value
        _rekey(lines)

    return change


def _swap_agents(lines: Lines) -> None:
    """The successes of one entry go to another."""
    good, bad = learner(lines), next(r for r in lines if r["method"] == "BASE" and r["scored"] and not r["success"])
    for name in ("outcomes", "worlds", "success", "end", "rounds", "progress", "final_plan", "initial_plan"):
        bad[name] = good[name]


def _time_was_up(lines: Lines) -> None:
    """A failure that never began, so that nothing could be played again, and counts as a success."""
    error = {"kind": "agent", "type": "JobTimeoutError", "message": "timeout", "where": []}
    failure(lines).update(success=True, end="success", progress=1.0, digest=None, error=error)


def _no_times(lines: Lines) -> None:
    for outcome in learner(lines)["outcomes"][0].values():
        del outcome["began"], outcome["ended"]


def _endless(lines: Lines) -> None:
    """Whoever verifies is to play until the end of days."""
    learner(lines)["options"]["iterations"] = 10**9


FORGERIES: dict[str, Forgery] = {
    "success": set_field(failure, "success", True),
    "success and end": lambda lines: failure(lines).update(success=True, end="success", progress=1.0),
    "end": set_field(failure, "end", "truncated"),
    "progress": set_field(failure, "progress", 1.0),
    "hidden job": set_field(failure, "scored", False),
    "blamed on the network": _blame_the_network,
    "failures deleted": _delete_failures,
    "a task deleted": _delete_one_task,
    "floors deleted": _delete_the_floors,
    "a success doubled": _win_again,
    "played again until it went well": _second_try,
    "another model's name": _relabel_model,
    "label": set_field(asked, "agent", "BASE (planner=openai:o3)"),
    "method": set_field(failure, "method", "CC"),
    "backend": _other_backend,
    "starts": _other_starts,
    "seed": _seed,
    "robots": set_field(learner, "robots", 2),
    "style": set_field(failure, "style", "rustic"),
    "layout": set_field(failure, "layout", "galley"),
    "digest": set_field(failure, "digest", "0" * 12),
    "problem": set_field(learner, "problem", "0" * 12),
    "template": set_field(learner, "template", "clear the trolley"),
    "known rounds": set_field(learner, "known_rounds", 99),
    "more rounds allowed": _more_rounds,
    "fewer iterations": _fewer_iterations,
    "rounds": set_field(learner, "rounds", 4),
    "an outcome": _outcome,
    "worlds": _all_worlds,
    "simulated seconds": set_field(learner, "sim_seconds", 1.0),
    "first plan's length": set_field(learner, "initial_plan_length", 1),
    "first plan's length, of a model": set_field(asked, "initial_plan_length", 1),
    "final plan's length": set_field(learner, "final_plan_length", 1),
    "final plan": set_field(asked, "final_plan", {"robot_0": ["wait"]}),
    "subtasks done": set_field(failure, "subtasks_done", lambda old: old + 1),
    "retries": set_field(learner, "retries", 7),
    "adjusted": set_field(learner, "adjusted", lambda old: not old),
    "reflections": set_field(learner, "reflections", ["be careful"]),
    "truth readers": _truth_reader,
    "verdicts": _checks,
    "littered": set_field(learner, "littered", 3),
    "optimum": set_field(learner, "optimum_rounds", 30),
    "contacts": set_field(learner, "robot_contacts", 5),
    "tokens": _usage("prompt_tokens", 1),
    "tokens of answers": _usage("completion_tokens", 1),
    "calls": _usage("calls", 0),
    "money": _usage("money", 0.001),
    "unpriced calls": _usage("unpriced", 3),
    "a prompt": _exchange("messages", [["user", "please"]]),
    "a reply": _exchange("reply", "Plan: [wait]"),
    "exchanges dropped": _drop_exchanges,
    "body": _kitchen("body", "panda_tall"),
    "knowledge": _kitchen("knowledge", "seen"),
    "quirks": _kitchen("quirks", 2),
    "noise": _kitchen("perception_noise", 0.02),
    "clock": set_field(learner, "clock", "events"),
    "skills and weights": set_field(learner, "skills", {"pick up": "0" * 64}),
    "timeline": set_field(learner, "timeline", [{"who": "a", "kind": "wait", "what": "", "began": 0, "ended": 9}]),
    "orders": set_field(learner, "orders", [{"robot_0": {"command": "wait"}}]),
    "shortest makespan": set_field(learner, "optimum_seconds", 1.0),
    "rule readers": set_field(learner, "rule_readers", ["planner", "handover", "reflector"]),
    "isolated": set_field(learner, "isolated", True),
    "an option that none knows": lambda lines: learner(lines)["options"]["kitchen"].update(gravity="moon"),
    "errors of the planner": set_field(asked, "planner_errors", ["none of mine"]),
    "suite's version": _other_suite_version,
    "out of the suite": _no_suite,
    "one entry's results for another's": _swap_agents,
    "success of a job whose time was up": _time_was_up,
    "iterations without end": _endless,
    "seconds before it began": set_field(learner, "wall_seconds", -100.0),
    "requests": _usage("requests", 0.5e9),
    "pictures for nobody": lambda lines: learner(lines)["options"].update(viewers=["checker"]),
    "a video from elsewhere": set_field(learner, "video", {"path": "../../elsewhere.webm"}),
    "a text for a truth value": set_field(failure, "success", "off"),
    "a text for a number": set_field(learner, "rounds", str),
    "a truth value for a number": set_field(learner, "iteration", bool),
    "a field inside that no record has": _usage("cost", 0.0),
    "times of outcomes left out": _no_times,
    "template left out": lambda lines: learner(lines).pop("template"),
    "requests that were not sent": _usage("requests", 0),
    "seconds of requests": _usage("seconds", 1e6),
    "not over yet": set_field(learner, "wall_seconds", 9e8),
    "no time at all": set_field(learner, "started", None),
    "no machine": set_field(learner, "machine", None),
    "a video that runs backwards": set_field(learner, "video", {"path": "videos/a.webm", "rounds": [3.0, 1.0]}),
    "a role of someone else": lambda lines: asked(lines)["options"]["agent"].update(checker="noisy"),
}


def test_an_honest_run_is_proven_whole(honest: Path) -> None:
    verdict = verify(honest)
    assert not verdict.findings, "\n".join(f.told for f in verdict.findings)
    assert verdict.replayed == 0 and verdict.strange == ()
    assert verdict.jobs == 2 * (2 * 2 + 1)
    assert verdict.records == len(read(honest))


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.long) if n == "backend" else n for n in FORGERIES]  # played in physics
)
def test_a_forgery_is_found(honest: Path, tmp_path: Path, name: str, replays: None) -> None:
    copy = forged(honest, tmp_path / "copy", FORGERIES[name])
    assert stands(copy) != stands(honest), "this forgery changes nothing"
    assert verify(copy).findings, name


def test_jobs_that_no_suite_has_are_not_played(honest: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """They could be made to take for ever; that they are on no list is enough."""
    def endless(lines: Lines) -> None:
        for record in lines:
            record["options"]["kitchen"]["max_rounds"] = 1_000
        _rekey(lines)

    monkeypatch.setattr("remac_bench.proof.again.play_job", lambda *given: pytest.fail("played"))
    verdict = verify(forged(honest, tmp_path / "copy", endless))
    assert verdict.jobs == 0 and {f.told for f in verdict.findings} >= {"not on the list of suite small"}
    assert remac("bench", "verify", str(tmp_path / "copy")).exit_code == 1


def test_at_least_twenty_five_ways() -> None:
    assert len(FORGERIES) >= 25


# -- submissions ----------------------------------------


@pytest.fixture(scope="module")
def submission(honest: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The honest run, packed."""
    out = tmp_path_factory.mktemp("packed") / "submission"
    pack(honest, out, name="Kitchen Crew", contact="crew@example.org", kind="custom")
    return out


def copied(submission: Path, folder: Path) -> Path:
    """A copy to be tampered with."""
    return Path(shutil.copytree(submission, folder / "copy"))


def test_an_honest_submission_is_accepted_and_stands_on_the_board(submission: Path, tmp_path: Path) -> None:
    folder = copied(submission, tmp_path)
    result = remac("bench", "accept", str(folder))
    assert result.exit_code == 0, result.output
    assert "accepted: Kitchen Crew, replayed" in result.output
    shown = remac("bench", "board", str(folder), "--out", str(tmp_path / "board"))
    assert shown.exit_code == 0, shown.output
    page = (tmp_path / "board" / "leaderboard.html").read_text()
    assert "Kitchen Crew: BASE (planner=custom:m) (replayed, custom)" in page
    assert "Kitchen Crew: BASE (planner=reader)" not in page and "BASE (planner=reader)" in page


def test_nothing_stands_on_the_board_that_was_not_accepted_as_it_is(submission: Path, tmp_path: Path) -> None:
    folder = copied(submission, tmp_path)
    result = remac("bench", "board", str(folder), "--out", str(tmp_path / "board"))
    assert result.exit_code == 2 and "is not accepted" in result.output
    assert not accept(folder).reasons
    forged(folder, folder, FORGERIES["success and end"])
    result = remac("bench", "board", str(folder), "--out", str(tmp_path / "board"))
    assert result.exit_code == 2 and "changed after it was accepted" in result.output


def test_what_an_entry_says_of_itself_stays_as_it_was_accepted(submission: Path, tmp_path: Path, replays: None) -> None:
    """Else an entry could move to the board of another suite."""
    folder = copied(submission, tmp_path)
    assert not accept(folder).reasons
    entry, honest = folder / ENTRY, (folder / ENTRY).read_text()
    for number, line in enumerate(('suite = "', 'contact = "', 'models = ["', 'code = "')):
        entry.write_text(honest.replace(f"\n{line}", f"\n{line}other "))
        with pytest.raises(UsageError, match="changed after it was accepted"):
            gather([folder], tmp_path / str(number))


def _repacked(folder: Path, change: Forgery) -> None:
    """Records changed, and entry.toml made to fit: whoever forges one forges the other."""
    import hashlib

    old = hashlib.sha256((folder / "records.jsonl").read_bytes()).hexdigest()
    forged(folder, folder, change)
    new = hashlib.sha256((folder / "records.jsonl").read_bytes()).hexdigest()
    entry = folder / ENTRY
    entry.write_text(entry.read_text().replace(old, new))


def test_forged_submissions_get_reasons(submission: Path, tmp_path: Path) -> None:
    folder = copied(submission, tmp_path)
    forged(folder, folder, FORGERIES["success"])
    assert accept(folder).reasons == ("records.jsonl: not as entry.toml lists it",)
    for number, name in enumerate(("success", "failures deleted", "another model's name", "money")):
        copy = Path(shutil.copytree(submission, tmp_path / str(number)))
        _repacked(copy, FORGERIES[name])
        found = accept(copy)
        assert found.reasons and not (copy / ACCEPTED).exists(), name


def test_an_acceptance_that_came_along_is_worth_nothing(submission: Path, tmp_path: Path) -> None:
    folder = copied(submission, tmp_path)
    accept(folder)
    _repacked(folder, FORGERIES["success and end"])
    result = remac("bench", "accept", str(folder))
    assert result.exit_code == 1 and "not accepted" in result.output
    assert not (folder / ACCEPTED).exists()


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ('kind = "custom"', 'kind = "best"', "kind 'best' is not valid"),
        ("format = 1", "format = 2", "format 2 is not valid"),
        ('name = "Kitchen Crew"', 'name = "\\u001b[31mred"', "is not valid"),
        ("[files]", '[files]\n"../../etc/passwd" = "0"', "are not valid"),
    ],
)
def test_an_entry_that_is_none_is_refused_in_one_line(
    submission: Path, tmp_path: Path, old: str, new: str, reason: str
) -> None:
    folder = copied(submission, tmp_path)
    entry = folder / ENTRY
    entry.write_text(entry.read_text().replace(old, new))
    result = remac("bench", "accept", str(folder))
    assert result.exit_code == 2 and reason in result.output and result.output.count("\n") == 1


def test_a_run_of_another_code_is_not_accepted(submission: Path, tmp_path: Path) -> None:
    folder = copied(submission, tmp_path)

    def change(lines: Lines) -> None:
        for record in lines:
            record["versions"]["code"] = "0" * 12

    _repacked(folder, change)
    assert any("made with code 000000000000" in reason for reason in accept(folder).reasons)


def test_models_can_be_asked_again(honest: Path, submission: Path, tmp_path: Path) -> None:
    lines = [json.loads(line) for line in (honest / "records.jsonl").read_text().splitlines()]
    access = Access(base_url=asked(lines)["options"]["access"]["base_url"])
    found = accept(copied(submission, tmp_path), reask=2, access=access)
    assert found.tier == "re-asked" and found.reasked is not None
    assert (found.reasked.jobs, found.reasked.before, found.reasked.now) == (2, 0, 0)


def test_no_key_goes_where_a_submission_says(submission: Path, tmp_path: Path) -> None:
    """It names the server of the one who entered; keys go where whoever accepts says, or nowhere."""
    with pytest.raises(OptionError, match="needs base_url"):
        accept(copied(submission, tmp_path), reask=1)


def test_an_acceptance_that_was_written_elsewhere_is_none(submission: Path, tmp_path: Path) -> None:
    folder = copied(submission, tmp_path)
    _repacked(folder, FORGERIES["success and end"])
    facts = {"submission": submission_digest(read_entry(folder)), "tier": "re-asked", "code": code_digest()}
    facts["seal"] = "0" * 64
    for left_out in ("", "seal"):
        told = [f"{name} = {json.dumps(value)}" for name, value in facts.items() if name != left_out]
        (folder / ACCEPTED).write_text("\n".join(told))
        result = remac("bench", "board", str(folder), "--out", str(tmp_path / "board"))
        assert result.exit_code == 2 and "was not accepted here" in result.output, result.output


def test_a_tier_that_was_raised_is_found(submission: Path, tmp_path: Path) -> None:
    folder = copied(submission, tmp_path)
    assert accept(folder).tier == "replayed"
    (folder / ACCEPTED).write_text((folder / ACCEPTED).read_text().replace("replayed", "re-asked"))
    with pytest.raises(UsageError, match="was not accepted here"):
        gather([folder], tmp_path / "board")


def test_files_that_are_links_or_not_listed_are_no_part_of_a_submission(submission: Path, tmp_path: Path) -> None:
    folder = copied(submission, tmp_path)
    (folder / "cassette.jsonl").rename(tmp_path / "elsewhere")
    (folder / "cassette.jsonl").symlink_to(tmp_path / "elsewhere")
    (folder / "providers.toml").write_text("version = 1\n")
    assert accept(folder).reasons == (
        "cassette.jsonl: not as entry.toml lists it", "providers.toml: not as entry.toml lists it"
    )
    (folder / ENTRY).rename(tmp_path / "entry")
    (folder / ENTRY).symlink_to("/dev/zero")
    with pytest.raises(UsageError, match="is no file of this folder"):
        accept(folder)


@pytest.mark.parametrize("name", ["Kitchen Crew", "kitchen  CREW", "\uff2bitchen Crew"])
def test_no_entry_stands_in_for_another(submission: Path, tmp_path: Path, name: str, replays: None) -> None:
    first, second = copied(submission, tmp_path), Path(shutil.copytree(submission, tmp_path / "second"))
    entry = second / ENTRY
    entry.write_text(entry.read_text().replace('name = "Kitchen Crew"', f'name = "{name}"'))
    assert not accept(first).reasons and not accept(second).reasons
    with pytest.raises(UsageError, match="stands there already"):
        gather([first, second], tmp_path / "board")


def test_a_folder_where_the_acceptance_goes_is_said_in_one_line(tmp_path: Path) -> None:
    (tmp_path / ACCEPTED).mkdir()
    result = remac("bench", "accept", str(tmp_path))
    assert result.exit_code == 2 and "cannot be taken away" in result.output and result.output.count("\n") == 1


LOOK_ALIKE = (
    "kitchen crevv", "Kltchen Crew", "K\u0131tchen Crew", "Kitchen Crew\ufe0f", "Kitchen Cr\u00eaw",
    "Kitchen Crew\u02b9",
)  # fmt: skip


@pytest.mark.parametrize("name", LOOK_ALIKE)
def test_names_that_look_alike_are_one_name(name: str) -> None:
    assert looks(name) == looks("Kitchen Crew") != looks("Kitchen Craw")


def test_a_name_of_another_alphabet_may_look_the_same() -> None:
    assert looks("COCA 7") == looks("\u0421\u041e\u0421\u0410 7") and looks("AB") == looks("\u0391\u0392")


@pytest.mark.parametrize("name", ["\ufe0f", "Crew\u3164", "\u2800", "Kitchen \u13dfrew"])
def test_a_name_of_which_something_is_not_seen_is_none(honest: Path, tmp_path: Path, name: str) -> None:
    with pytest.raises(UsageError, match="is not valid"):
        pack(honest, tmp_path / "out", name=name, kind="custom")


def test_a_name_has_letters_of_one_alphabet(honest: Path, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="letters of one alphabet"):
        pack(honest, tmp_path / "out", name="Kitchen Cr\u0435w", kind="custom")
    pack(honest, tmp_path / "out", name="\u041a\u0443\u0445\u043d\u044f 7", kind="custom")


def test_a_model_without_a_cassette_cannot_be_submitted(honest: Path, tmp_path: Path) -> None:
    folder = Path(shutil.copytree(honest, tmp_path / "run"))
    (folder / "cassette.jsonl").unlink()
    result = remac("bench", "submit", str(folder), "--out", str(tmp_path / "out"), "--name", "Crew")
    assert result.exit_code == 2 and "answers are missing" in result.output
    assert not (tmp_path / "out").exists()
