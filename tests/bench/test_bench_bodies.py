"""Robots of a user's own body on the command line: the file that the recipe of docs/extending.md begins with."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from remac_bench.blame.labels import blame
from remac_bench.errors import UsageError
from remac_bench.judging.episodes import setting
from remac_bench.judging.ranking import compare
from remac_bench.playing import suites
from remac_bench.proof.again import read_job
from remac_bench.proof.replay import replay
from remac_bench.proof.verify import verify
from remac_bench.records import Record
from remac_bench.store import Store
from test_bench_cli import remac

from remac_env.robots import bodies

SIX = Path(__file__).parents[1] / "robots" / "six_joints.py"
BODY = "six_joints.py:SixJoints"
RUN = ("bench", "run", "--backend", "symbolic", "--tasks", "HeatOnStove", "--seeds", "0:2", "-j", "0")


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A user's folder with the body in it; what is imported from there is forgotten afterwards."""
    for path in (SIX, SIX.with_suffix(".xml")):
        shutil.copy(path, tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(bodies, "_BODIES", dict(bodies._BODIES))
    yield tmp_path


def played(*more: str) -> list[Record]:
    result = remac(*RUN, "--out", "out", *more)
    assert result.exit_code == 0, result.output
    return Store("out").read()


def forget() -> None:
    """As in another process, to which nobody has named the body yet."""
    bodies._BODIES.pop(BODY)


def test_records_say_which_body_and_are_proven_with_it_alone(here: Path) -> None:
    records = played("--methods", "CC", "--body", BODY)
    told = bodies.described(BODY)
    assert {(row.body, row.body_digest) for row in records} == {(told["body"], told["body_digest"])}
    assert told["body"] == "six joints" and records[0].options["kitchen"]["body"] == BODY
    assert verify("out").findings == ()
    file = here / "six_joints.py"
    file.write_text(file.read_text("utf-8").replace("acceleration = 2.5", "acceleration = 2.50001"), "utf-8")
    forget()
    assert remac("bench", "verify", "out").exit_code == 1  # without --body nothing is imported
    assert BODY not in bodies.names()
    result = remac("bench", "verify", "out", "--body", BODY)
    assert result.exit_code == 1 and "body_digest: recorded" in " ".join(result.stdout.split())


def test_bodies_are_not_ranked_together(here: Path) -> None:
    ours = played("--methods", "BASE,CC", "--body", BODY)
    both = [*ours, *played("--methods", "BASE,CC")]
    assert len({setting(row) for row in both}) == 2 and len({row.job for row in both}) == 8
    assert {pair.setting for pair in compare(ours)} == {setting(ours[0])}
    assert len(compare(both)) == 2 * len(compare(ours)) == 2
    changed = ours[0].model_copy(update={"body_digest": "0" * 12})
    assert setting(changed) != setting(ours[0])
    moved = ours[0].model_copy(deep=True)
    moved.options["kitchen"]["body"] = f"elsewhere/{BODY}"
    assert setting(moved) == setting(ours[0])


def test_no_record_has_code_imported(here: Path) -> None:
    """A record that names the file of an attacker: nothing of it is run, whoever looks at it."""
    (record, *_) = played("--methods", "BASE")
    (here / "trap.py").write_text("from pathlib import Path\nPath('sprung').touch()\n", "utf-8")
    told = record.model_dump(by_alias=True)
    told["options"]["kitchen"]["body"] = "trap.py:Trap"
    told |= {"success": False, "body": "trap", "body_digest": "0" * 12}
    forged = Record(**told)
    (here / "forged").mkdir()
    Store("forged").append([forged])
    assert any("body 'trap.py:Trap' is not known here; valid: panda" in each.told for each in verify("forged").findings)
    for look in (read_job, blame, replay):
        with pytest.raises(UsageError, match=r"not known here.*--body"):
            look(forged)
    assert remac("bench", "report", "forged").exit_code == 0
    assert not (here / "sprung").exists()
    assert remac("bench", "verify", "forged", "--body", "trap.py:Trap").exit_code == 2  # its own file has no such name
    assert (here / "sprung").exists(), "the trap is one"


def test_a_suite_can_name_a_body(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert "body" in suites.KITCHEN
    monkeypatch.setattr(suites, "_ADDED", {})
    (here / "mine.toml").write_text(
        'name = "mine"\nversion = 1\nabout = "with a body"\nmethods = ["CC"]\n[[jobs]]\ntasks = ["HeatOnStove"]\n'
        f'seeds = "0:1"\nkitchen = {{ backend = "symbolic", body = "{BODY}" }}\n', "utf-8",
    )
    assert remac("bench", "run", "--suite", "mine.toml", "-j", "0", "--out", "mine").exit_code == 0
    assert {row.body for row in Store("mine").read()} == {"six joints"}
    forget()
    assert remac("bench", "verify", "mine").exit_code == 1 and BODY not in bodies.names()
    result = remac("bench", "verify", "mine", "--suite", "mine.toml")
    assert result.exit_code == 0, result.output


def test_a_suite_says_itself_which_body_it_is_for(here: Path) -> None:
    result = remac(*RUN[:2], "--suite", "paper", "--body", BODY, "--out", "out")
    assert result.exit_code == 2 and "--body does not go with suite 'paper'" in " ".join(result.output.split())
    assert not (here / "out").exists()


def test_a_body_that_is_none_is_refused_before_anything_is_played(here: Path) -> None:
    (here / "odd.py").write_text("class Odd:\n    name = 'odd'\n", "utf-8")
    for address, words in (
        ("octopus", "unknown body 'octopus'; valid: panda"),
        ("none.py:Name", "body 'none.py:Name' cannot be imported"),
        ("odd.py:Even", "odd.py has no 'Even'; it has: Odd"),
        ("odd.py:Odd", "this is no body: Odd lacks fingerprint, tuck"),
    ):
        result = remac(*RUN, "--methods", "BASE", "--out", "out", "--body", address)
        assert result.exit_code == 2 and words in " ".join(result.output.split()), result.output
        assert not (here / "out" / "records.jsonl").exists()
    assert not {"octopus", "none.py:Name", "odd.py:Even", "odd.py:Odd"} & set(bodies.names())
