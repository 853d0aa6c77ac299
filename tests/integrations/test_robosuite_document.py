"""What docs/robosuite.md shows runs where robosuite is installed."""

from __future__ import annotations

import pytest
from document_pages import ROOT, blocks

pytest.importorskip("robosuite", reason="robosuite is not installed: docs/robosuite.md says how")


def test_its_python_runs(capsys: pytest.CaptureFixture[str]) -> None:
    shown = [block for block in blocks("docs/robosuite.md") if block.language == "python"]
    for block in shown:
        exec(compile(block.code, block.where, "exec"), {})  # noqa: S102
    assert "False" in capsys.readouterr().out, "info['success'] of the first step"


def test_its_lines_are_those_of_the_makefile() -> None:
    page, makefile = ((ROOT / name).read_text("utf-8") for name in ("docs/robosuite.md", "Makefile"))
    for part in ("[for-robosuite]", "--no-deps robosuite==1.5.2"):
        assert part in page
        assert part in makefile
