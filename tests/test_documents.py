"""What README's example shows (in the symbolic backend, but for the long run), and where links of documents lead."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from document_pages import PAGES
from document_pages import blocks as all_blocks

ROOT = Path(__file__).parent.parent
FOLDERS = (".", "docs", "docs/tutorials", "benchmarks")
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


def headless(text: str) -> list[str]:
    """First lines of tables that have no heads, as the second half of a table that is split by an empty line."""
    lines = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S).splitlines()
    return [
        line
        for before, line, after in zip(["", *lines], lines, [*lines[1:], ""], strict=False)
        if line.startswith("|") and not before.startswith("|") and not re.fullmatch(r"\|[-: |]+\|", after)
    ]


@pytest.mark.parametrize("name", LINKED)
def test_every_table_has_a_head(name: str) -> None:
    assert not headless((ROOT / name).read_text("utf-8"))


def test_a_table_that_is_split_is_found() -> None:
    assert headless("| a |\n|---|\n| b |\n\n| c |\n") == ["| c |"]


def test_what_documents_have_a_reader_write_is_ignored_by_git() -> None:
    lines = [line for page in PAGES for block in all_blocks(page) for line in block.lines]
    written = {name for line in lines for name in re.findall(r"--(?:out|json|cassette|csv) ([\w/.]+)", line)}
    paths = sorted(name if "." in name else f"{name}/records.jsonl" for name in written if not name.isupper())
    assert len(paths) > 10
    asked = subprocess.run(["git", "check-ignore", *paths, "no/such"], cwd=ROOT, capture_output=True, text=True)
    if asked.returncode == 128:
        pytest.skip("not a checkout")
    assert set(paths) - set(asked.stdout.split()) == set()


@pytest.mark.parametrize("path", sorted((ROOT / "docs").glob("make_*.py")), ids=lambda path: path.stem)
def test_asking_for_help_writes_nothing(
    path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None and spec.loader is not None
    script = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, path.stem, script)
    monkeypatch.syspath_prepend(str(path.parent))  # as Python does for a script
    spec.loader.exec_module(script)
    monkeypatch.setattr(sys, "argv", [path.name, "--help"])
    with pytest.raises(SystemExit, match="^0$"):
        script.main()
    assert f"usage: {path.name}" in capsys.readouterr().out


def test_every_dependency_and_every_extra_is_weighed() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    extras = project["optional-dependencies"]
    page = (ROOT / "docs" / "dependencies.md").read_text("utf-8").lower()
    named = [*project["dependencies"], *(package for extra in extras.values() for package in extra)]
    missing = [name for name in named if re.split(r"[><=\[]", name)[0].removesuffix("-python") not in page]
    assert not missing and not [extra for extra in extras if extra != "dev" and f"extra `{extra}`" not in page]
