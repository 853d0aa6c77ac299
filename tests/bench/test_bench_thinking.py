"""What thinking costs with a model that is stood in for: five rates, and the same again from the cassette."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
import thinking


@pytest.mark.parametrize(("method", "think", "asked"), [
    ("CC", "tokens:10", 1), pytest.param("REACT", "tokens:30", 10, marks=pytest.mark.long),
])  # fmt: skip
def test_an_episode_is_the_same_from_its_cassette(method: str, think: str, asked: int, tmp_path: Path) -> None:
    done = thinking.episode(method, think, "OpenCabinetPnP", 1, tmp_path / "c.jsonl")
    assert done.success and done.same and done.asked >= asked
    thoughts = [span.ended - span.began for span in done.timeline if span.kind == "thought"]
    least, most = thinking.TOKENS[method == "REACT"]
    rate = float(think.partition(":")[2]) / 1000.0
    assert thoughts and all(thought >= rate * least for thought in thoughts)
    assert max(thoughts) <= rate * most


def test_rows_say_what_is_too_late() -> None:
    free = [thinking.Episode(True, 50.0, (), 3, True), thinking.Episode(True, 60.0, (), 3, True)]
    slow = [replace(free[0], seconds=90.0), replace(free[1], success=False, same=False)]
    assert list(thinking._row(slow, free)) == ["2", "50%", "90.0", "0%", "50%", "6", "1 of 2"]
