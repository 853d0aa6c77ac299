"""`remac learn record --format lerobot`: what is written comes back, grows, and says the truth of itself."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from made_demos import made
from remac_bench.cli import app
from remac_bench.errors import UsageError
from remac_bench.learning import lerobot
from remac_bench.learning.lerobot import Dataset, is_dataset, read_dataset
from remac_bench.learning.lerobot_meta import persistent
from typer.testing import CliRunner

ARRAYS = ("actions", "commands", "measured", "rewards")


def test_what_is_said_of_a_demonstration_changes_where_it_has_succeeded() -> None:
    rows = persistent(made(30))
    assert [(row["style"], row["timestamp"]) for row in rows] == [
        ("subtask", 0.0), ("plan", 0.0), ("memory", 0.0), ("memory", 0.75),
    ]  # fmt: skip
    assert rows[1]["content"] == "1. navigate to faucet\n2. turn on faucet"
    assert rows[2]["content"] == "Done: navigate to faucet."
    assert rows[3]["content"] == "Done: navigate to faucet, turn on faucet."


@pytest.mark.parametrize("line", [
    ("record", "--format", "rlds", "--out", "x"), ("record", "--pictures", "films", "--out", "x"),
    ("record", "--pictures", "videos", "--out", "x"),
])  # fmt: skip
def test_wrong_lines_are_refused_in_one_line(line: tuple[str, ...]) -> None:
    done = CliRunner().invoke(app, ["learn", *line])
    assert done.exit_code == 2 and done.output.startswith("error: "), done.output


def test_without_pyarrow_it_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pyarrow", None)
    done = CliRunner().invoke(app, ["learn", "record", "--format", "lerobot", "--out", str(tmp_path / "x")])
    assert done.exit_code == 2 and "remac-kitchen[lerobot]" in done.output, done.output
    assert not list(tmp_path.iterdir())


@pytest.fixture
def parquet() -> Any:
    return pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed: docs/learning.md says how")


def test_parts_come_back_as_they_were_written(parquet: Any, tmp_path: Path) -> None:
    first, other, last = made(seed=1), made(20, seed=2, skill="turn off", target="stove"), made(10, seed=3)
    Dataset(tmp_path).add("one", [first, other])
    again = Dataset(tmp_path)
    assert again.has("one") and not again.has("two") and is_dataset(tmp_path)
    again.add("two", [last])
    found = list(read_dataset(tmp_path, "turn on"))
    assert [demo.seed for demo in found] == [1, 3]
    assert [demo.target for demo in read_dataset(tmp_path, "turn off")] == ["stove"]
    for there, back in zip((first, last), found, strict=True):
        assert all(np.array_equal(getattr(back, name), getattr(there, name)) for name in ARRAYS)
        assert np.array_equal(back.observations, there.observations[:-1])
        assert (back.before, back.style, back.task) == (there.before, there.style, there.task)


def test_a_dataset_says_the_truth_of_itself(parquet: Any, tmp_path: Path) -> None:
    demos = [made(30, seed=1), made(20, seed=2, skill="turn off", target="stove"), made(10, seed=3)]
    dataset = Dataset(tmp_path)
    dataset.add("one", demos[:2])
    dataset.add("two", demos[2:])
    info = json.loads((tmp_path / "meta/info.json").read_text("utf-8"))
    assert (info["codebase_version"], info["fps"]) == ("v3.0", 20)
    assert (info["total_episodes"], info["total_frames"], info["total_tasks"]) == (3, 60, 2)
    table = parquet.read_table(sorted((tmp_path / "data").glob("*/*.parquet")))
    assert set(table.column_names) == set(info["features"])
    assert table["index"].to_pylist() == list(range(60))
    tasks = parquet.read_table(tmp_path / "meta/tasks.parquet")
    assert tasks.to_pylist() == [
        {"task_index": 0, "task": "turn on faucet"}, {"task_index": 1, "task": "turn off stove"}
    ]
    assert table["task_index"].to_pylist() == [0] * 30 + [1] * 20 + [0] * 10
    rows = [
        row for path in sorted((tmp_path / "meta/episodes").glob("*/*.parquet"))
        for row in parquet.read_table(path).to_pylist()
    ]
    assert [(row["dataset_from_index"], row["dataset_to_index"]) for row in rows] == [(0, 30), (30, 50), (50, 60)]
    assert [row["data/file_index"] for row in rows] == [0, 0, 1]
    stats = json.loads((tmp_path / "meta/stats.json").read_text("utf-8"))["action"]
    actions = np.concatenate([demo.actions for demo in demos]).astype(float)
    for name, wanted in (("mean", actions.mean(0)), ("std", actions.std(0)), ("max", actions.max(0))):
        assert np.allclose(stats[name], wanted), name
    assert stats["count"] == [60]
    said = table["language_persistent"].to_pylist()
    assert said[0] == persistent(demos[0]) and said[29] == said[0] and said[30] != said[0]


def test_lerobot_before_language_columns_gets_none(parquet: Any, tmp_path: Path) -> None:
    Dataset(tmp_path, language=False).add("one", [made()])
    info = json.loads((tmp_path / "meta/info.json").read_text("utf-8"))
    assert not any(name.startswith("language") for name in info["features"])


def test_pictures_are_kept_in_tables_as_they_were(parquet: Any, tmp_path: Path) -> None:
    import cv2

    demo = made(size=32)
    Dataset(tmp_path, videos=False).add("one", [demo])
    column = parquet.read_table(tmp_path / "data/chunk-000/file-000.parquet")["observation.images.front"].to_pylist()
    shown = [cv2.imdecode(np.frombuffer(each["bytes"], np.uint8), cv2.IMREAD_COLOR)[..., ::-1] for each in column]
    assert np.array_equal(shown, demo.pictures["front"][:-1])


def test_videos_have_a_frame_for_each_row(parquet: Any, tmp_path: Path) -> None:
    import cv2

    demos = [made(30, size=32), made(20, size=32)]
    Dataset(tmp_path).add("one", demos)
    file = cv2.VideoCapture(str(tmp_path / "videos/observation.images.front/chunk-000/file-000.mp4"))
    shown = []
    while (read := file.read())[0]:
        shown.append(read[1][..., ::-1])
    wanted = np.concatenate([demo.pictures["front"][:-1] for demo in demos]).astype(int)
    assert len(shown) == 50 and file.get(cv2.CAP_PROP_FPS) == 20.0
    assert np.abs(np.array(shown, int)[:, :12, :12] - wanted[:, :12, :12]).mean() < 8, "colours lose a little"
    rows = parquet.read_table(tmp_path / "meta/episodes/chunk-000/file-000.parquet").to_pylist()
    times = [row["videos/observation.images.front/from_timestamp"] for row in rows]
    assert times == [0.0, 1.5]


def test_a_part_that_was_cut_short_is_written_anew(
    parquet: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    Dataset(tmp_path).add("one", [made(seed=1)])

    def broken(episodes: Any) -> Any:
        raise OSError("no space")

    with monkeypatch.context() as patch, pytest.raises(OSError, match="no space"):
        patch.setattr(lerobot, "merged", broken)
        Dataset(tmp_path).add("two", [made(seed=2), made(seed=3)])
    assert [demo.seed for demo in read_dataset(tmp_path, "turn on")] == [1]
    again = Dataset(tmp_path)
    assert not again.has("two")
    again.add("two", [made(seed=4)])
    assert [demo.seed for demo in read_dataset(tmp_path, "turn on")] == [1, 4]


def other_version(folder: Path) -> None:
    path = folder / "meta/remac.json"
    path.write_text(path.read_text("utf-8").replace('"version": 1', '"version": 0'), "utf-8")


def damaged(folder: Path) -> None:
    path = folder / "data/chunk-000/file-000.parquet"
    path.write_bytes(path.read_bytes()[:-200])


@pytest.mark.parametrize(("spoil", "told"), [(other_version, "version 0"), (damaged, "cannot be read")])
def test_what_cannot_be_read_is_refused(parquet: Any, spoil: Any, told: str, tmp_path: Path) -> None:
    Dataset(tmp_path).add("one", [made()])
    spoil(tmp_path)
    with pytest.raises(UsageError, match=told):
        list(read_dataset(tmp_path, "turn on"))


def test_what_does_not_go_together_is_refused(parquet: Any, tmp_path: Path) -> None:
    Dataset(tmp_path / "ours").add("one", [made()])
    with pytest.raises(UsageError, match="language"):
        Dataset(tmp_path / "ours", language=False)
    with pytest.raises(UsageError, match="other columns"):
        Dataset(tmp_path / "ours").add("two", [made(size=32)])
    (tmp_path / "theirs").mkdir()
    (tmp_path / "theirs" / "letter.txt").write_text("dear", "utf-8")
    with pytest.raises(UsageError, match="something else"):
        Dataset(tmp_path / "theirs")
    assert [demo.seed for demo in read_dataset(tmp_path / "ours", "turn on")] == [0]
    with pytest.raises(UsageError, match="no demonstrations"):
        list(lerobot_training(tmp_path / "ours"))


def lerobot_training(folder: Path) -> Any:
    pytest.importorskip("torch", reason="torch is not installed: docs/learning.md says how")
    from remac_bench.learning.sessions import train_skill
    from remac_bench.learning.train import Recipe

    return train_skill("open door", folder, folder / "weights", replace(Recipe(), epochs=1))
