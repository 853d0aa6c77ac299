"""Every row of the endpoint-fault table, against a real server on loopback, yields its documented value."""

from __future__ import annotations

from pathlib import Path

import llm_faults_answers  # noqa: F401
import llm_faults_text  # noqa: F401
import llm_faults_wire  # noqa: F401
import pytest
from llm_kit import FAULTS, Fault, open_kit

ROWS = [pytest.param(check, id=f"{row:02d}-{name}") for row in sorted(FAULTS) for name, check in FAULTS[row]]


@pytest.mark.parametrize("check", ROWS)
def test_fault(check: Fault, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with open_kit(tmp_path, monkeypatch) as kit:
        check(kit)


def test_no_row_is_left_out() -> None:
    assert sorted(FAULTS) == list(range(1, 33))
