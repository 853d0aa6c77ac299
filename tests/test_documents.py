"""What README's example shows (in the symbolic backend, but for the long run), and where links lead."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
FOLDERS = (".", "docs", "benchmarks")
LINKED = [str(path.relative_to(ROOT)) for folder in FOLDERS for path in (ROOT / folder).glob("*.md")]


def blocks(name: str) -> list[str]:
    """The Python blocks of a document."""
    return re.findall(r"```python\n(.*?)```", (ROOT / name).read_text("utf-8"), flags=re.DOTALL)


def run(name: str, *, backend: str) -> dict[str, object]:
    """Run a document's blocks one after the other in one namespace."""
    space: dict[str, object] = {}
    for block in blocks(name):
        code = re.sub(r"robots=2\)", f'robots=2, backend="{backend}")', block)
        exec(compile(code, name, "exec"), space)  # noqa: S102
    return space


@pytest.mark.parametrize("backend", ["symbolic", pytest.param("physics", marks=pytest.mark.long)])
def test_the_readme_shows_a_team_that_learned(backend: str) -> None:
    report = run("README.md", backend=backend)["agent"].report()  # type: ignore[attr-defined]
    assert report.success and report.initial_plan_length == 4


def test_links_and_pictures_exist() -> None:
    for name in LINKED:
        text = (ROOT / name).read_text("utf-8")
        for target in re.findall(r"\]\((?!http)([^)#]+)\)", text):
            assert ((ROOT / name).parent / target).exists(), f"{name} points to {target}, which is not there"
