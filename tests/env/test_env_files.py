"""Files of users: byte order marks, and locks that file systems may not have."""

from __future__ import annotations

import codecs
import errno
import fcntl
import logging
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from remac_bench.blame.sheet import read_blames
from remac_bench.errors import LockedError, StorageError
from remac_bench.playing.lock import locked
from remac_bench.playing.suites import load
from remac_bench.records import Record
from remac_bench.store import Store

from remac_agents.llm import Cassette, ChatReply
from remac_agents.llm.provider_files import read_catalogue
from remac_agents.memory import Memory, Run, prune_file
from remac_agents.planners.answers import AnswersPlanner
from remac_env import locks
from remac_env.files import decode, read_text
from remac_env.kitchen import layout as layouts
from remac_env.kitchen import style as styles

MARKS = {
    "utf-8": codecs.BOM_UTF8, "utf-16-le": codecs.BOM_UTF16_LE, "utf-16-be": codecs.BOM_UTF16_BE,
    "utf-32-le": codecs.BOM_UTF32_LE,
}  # fmt: skip

SUITE = """name = "mine"
version = 1
about = "caf\u00e9"
methods = ["BASE"]
[[jobs]]
tasks = ["HeatOnStove"]
seeds = "0:2"
"""

RUN = Run("HeatOnStove", "heat it", {"robot_0": ["wait"]}, [], [], [], True, ["be quick"])

# -- byte order marks -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("encoding", MARKS)
def test_texts_are_read_with_any_mark(encoding: str, tmp_path: Path) -> None:
    path = tmp_path / "x.toml"
    for text in (SUITE, SUITE.replace("\n", "\r\n"), "", "\n"):
        path.write_bytes(MARKS[encoding] + text.encode(encoding))
        assert read_text(path) == text.replace("\r\n", "\n")
    with pytest.raises(UnicodeDecodeError):
        decode(b"\xff\x00")


def marked(path: Path, encoding: str = "utf-8") -> Path:
    """The file with a byte order mark, as an editor saves it."""
    path.write_bytes(MARKS[encoding] + path.read_text("utf-8").encode(encoding))
    return path


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16-le"])
def test_suites_answers_kitchens_and_providers(encoding: str, tmp_path: Path) -> None:
    suite = tmp_path / "mine.toml"
    suite.write_text(SUITE, "utf-8")
    plain = load(str(suite)).digest
    assert load(str(marked(suite, encoding))).digest == plain
    answers = tmp_path / "answers.json"
    answers.write_text('{"HeatOnStove": ["wait"]}')
    assert AnswersPlanner(str(marked(answers, encoding)))._answers == {"HeatOnStove": ["wait"]}
    layout = marked(Path(shutil.copy(layouts.FOLDER / "galley.toml", tmp_path)), encoding)
    models = styles.load("rustic").models
    assert layouts.read(layout, models).slots == layouts.load("galley", models).slots
    style = marked(Path(shutil.copy(layouts.FOLDER.parent / "styles" / "rustic.toml", tmp_path)), encoding)
    assert styles.read(style).models == styles.load("rustic").models
    providers = tmp_path / "providers.toml"
    providers.write_text('[providers.mine]\ntitle = "Mine"\nbase_url = "http://127.0.0.1:1/v1"\nkey = ""\n')
    assert "mine" in read_catalogue(marked(providers, encoding)).providers


def test_a_layout_given_as_text_may_have_a_mark() -> None:
    text = (layouts.FOLDER / "galley.toml").read_text("utf-8")
    assert layouts.parse("\ufeff" + text, name="galley", file="galley.toml").name == "galley"


def test_records_memories_labels_and_cassettes(tmp_path: Path) -> None:
    store = Store(tmp_path)
    facts = {"agent": "CC", "method": "CC", "task": "HeatOnStove", "starts": "paper", "robots": 1, "scored": True}
    records = [Record(job=job, seed=0, backend="symbolic", iteration=0, success=True, **facts) for job in ("a", "b")]
    store.append(records)
    marked(store.path)
    assert store.read() == records and store.repair() == 0
    with store.path.open("ab") as file:
        file.write(b'{"torn')
    assert store.repair() == 6 and store.read() == records
    store.append(records[:1])
    assert {record.job for record in store.read()} == {"a", "b"}

    path = tmp_path / "memory.jsonl"
    Memory(path).append(RUN)
    Memory(marked(path)).append(RUN)
    assert len(Memory(path)) == 2 and prune_file(path, keep=2) == 0 and len(Memory(path)) == 2
    (tmp_path / "blame.jsonl").write_bytes(codecs.BOM_UTF8)
    assert read_blames(tmp_path) == []

    cassette = Cassette(tmp_path / "c.jsonl")
    cassette.record({"model": "m"}, ChatReply(text="yes"))
    again = Cassette(marked(cassette.path), mode="replay")
    assert again.damaged == 0 and again.play({"model": "m"}) == ChatReply(text="yes")


# -- locks ----------------------------------------------------------------------------------------------------------


def append_to_memory(folder: Path) -> None:
    """One of the three that lock."""
    Memory(folder / "memory.jsonl").append(RUN)
    assert len(Memory(folder / "memory.jsonl")) == 1


def append_to_cassette(folder: Path) -> None:
    """Another."""
    Cassette(folder / "c.jsonl").record({"model": "m"}, ChatReply(text="yes"))
    assert len(Cassette(folder / "c.jsonl", mode="replay")) == 1


def hold_a_folder(folder: Path) -> None:
    """The third."""
    with locked(folder):
        assert (folder / "runner.lock").exists()


USERS = [append_to_memory, append_to_cassette, hold_a_folder]
users = pytest.mark.parametrize("use", USERS, ids=[use.__name__ for use in USERS])


@pytest.fixture
def answering(monkeypatch: pytest.MonkeyPatch) -> Callable[[int], None]:
    """Lets `flock` fail with an error from here on."""

    def fail(number: int) -> None:
        def flock(file: object, operation: int) -> None:
            raise OSError(number, f"planted: {errno.errorcode[number]}")

        locks._told.clear()
        monkeypatch.setattr(fcntl, "flock", flock)

    return fail


@users
@pytest.mark.parametrize("name", ["ENOSYS", "ENOTSUP", "EOPNOTSUPP", "ENOLCK"])
def test_a_file_system_without_locks_is_used_with_a_warning(
    use: Callable[[Path], None],
    name: str,
    answering: Callable[[int], None],
    tmp_path: Path,
    caplog: pytest.LogCaptureFixture,
) -> None:
    answering(getattr(errno, name))
    with caplog.at_level(logging.WARNING):
        use(tmp_path)
    (told,) = caplog.messages
    assert "has no locks" in told and str(tmp_path) in told and "planted" in told
    caplog.clear()
    hold_a_folder(tmp_path)
    assert not caplog.messages, "it is said once"


@pytest.mark.parametrize("name", ["EWOULDBLOCK", "EAGAIN"])
def test_a_lock_that_is_held_is_another_runners(name: str, answering: Callable[[int], None], tmp_path: Path) -> None:
    answering(getattr(errno, name))
    with pytest.raises(LockedError, match="in use by another runner"):
        hold_a_folder(tmp_path)


@users
@pytest.mark.parametrize("name", ["EIO", "EBADF", "EACCES", "ESTALE", "EINVAL"])
def test_anything_else_names_the_cause(
    use: Callable[[Path], None], name: str, answering: Callable[[int], None], tmp_path: Path
) -> None:
    answering(getattr(errno, name))
    with pytest.raises((OSError, StorageError), match=f"planted: {name}") as caught:
        use(tmp_path)
    assert not isinstance(caught.value, LockedError) and str(tmp_path) in str(caught.value)


def test_two_holders_of_a_real_lock(tmp_path: Path) -> None:
    """Or else the tests above would prove nothing."""
    with locked(tmp_path), pytest.raises(LockedError, match="in use"), locked(tmp_path):
        pytest.fail("both hold it")
