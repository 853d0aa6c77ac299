"""What makes the package: README as an index shows it, the supported Pythons, and the oldest dependencies."""

from __future__ import annotations

import importlib
import importlib.util
import re
import sys
import tomllib
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[1]
LINKS = "See [start](docs/start.md#play), [there](https://a.org) and [below](#x).\n"
INNER = ("Limiter", "Manners")
"""Public classes of which users see no instance."""
README = f"# X\n\n![a robot](docs/pictures/a.webp)\n\n{LINKS}"


def loaded(path: str) -> ModuleType:
    """A script as a module."""
    spec = importlib.util.spec_from_file_location(Path(path).stem, ROOT / path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def hook(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """docs/package_readme.py, with a stand-in for hatchling, which only builds have."""
    interface = ModuleType("hatchling.metadata.plugin.interface")
    interface.MetadataHookInterface = type("MetadataHookInterface", (), {"root": str(ROOT)})  # type: ignore[attr-defined]
    for name in ("hatchling", "hatchling.metadata", "hatchling.metadata.plugin"):
        monkeypatch.setitem(sys.modules, name, ModuleType(name))
    monkeypatch.setitem(sys.modules, interface.__name__, interface)
    return loaded("docs/package_readme.py")


def test_links_are_absolute_where_the_repository_is_known_and_gone_where_it_is_not(hook: ModuleType) -> None:
    there = hook.absolute(README, "https://h.org/t/r")
    assert "![a robot](https://h.org/t/r/raw/main/docs/pictures/a.webp)" in there
    assert "[start](https://h.org/t/r/blob/main/docs/start.md#play), [there](https://a.org) and [below](#x)" in there
    assert hook.absolute(README, "") == "# X\n\n\nSee start, [there](https://a.org) and [below](#x).\n"


@pytest.mark.parametrize("address", ["", "https://h.org/t/r/"])
def test_nothing_of_the_readme_leads_nowhere(hook: ModuleType, address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(hook.ADDRESS, address)
    metadata: dict[str, Any] = {}
    hook.ReadmeHook().update(metadata)
    assert not re.findall(r"\]\((?!https?:|#)", metadata["readme"]["text"])
    assert metadata["urls"].get("Repository", "") == address.rstrip("/")


def test_the_oldest_dependencies_are_the_lower_bounds(tmp_path: Path) -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    pins = loaded(".ci/versions.py").oldest(project)
    assert len(pins) == len(project["dependencies"]) and all(re.fullmatch(r"[\w-]+==[\d.]+\.\*", pin) for pin in pins)


def test_the_workflow_runs_what_is_supported() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    named = re.findall(r":: (3\.\d+)", " ".join(project["classifiers"]))
    workflow = (ROOT / ".github" / "workflows" / "ci.yml").read_text("utf-8")
    assert re.findall(r'"(3\.\d+)"', workflow.partition("python: [")[2].partition("]")[0]) == named
    assert ".ci/run" in workflow and project["requires-python"] == f">={named[0]}"


def test_a_python_that_is_not_there_is_said_and_is_no_pass(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    script = loaded(".ci/versions.py")
    monkeypatch.setattr(script, "found", lambda version: None if version == "3.12" else f"python{version}")
    monkeypatch.setattr(script, "tried", lambda python, pins, given: (True, "5 passed in 1.00s"))
    monkeypatch.setattr(sys, "argv", ["versions.py"])
    assert script.main() == 1
    told = capsys.readouterr().out
    assert "3.12-newest: not tried: no python3.12 on the path" in told and "3.13-newest: 5 passed" in told


@pytest.mark.parametrize("name", ["remac_env.vocabulary", "remac_agents", "remac_agents.llm", "remac_bench.store"])
def test_public_objects_say_what_they_are(name: str) -> None:
    shown = {word: each for word, each in vars(importlib.import_module(name)).items() if not word.startswith("_")}
    own = [each for each in shown.values() if isinstance(each, type) and each.__module__.startswith("remac_")]
    silent = [each.__name__ for each in own if each.__repr__ is object.__repr__ and not hasattr(each, "_is_protocol")]
    assert own and [each for each in silent if each not in INNER] == []


def test_sizes_are_those_of_the_files_that_packages_installed(tmp_path: Path) -> None:
    script = loaded("docs/installed_sizes.py")
    site = tmp_path / "lib" / "python3.11" / "site-packages"
    for name, size in (("small", 10), ("large", 2_000_000), ("pip", 5)):
        (site / f"{name}-1.dist-info").mkdir(parents=True)
        (site / f"{name}-1.dist-info" / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1\n")
        (site / f"{name}-1.dist-info" / "RECORD").write_text(f"{name}.py,,\n{name}.pyc,,\ngone.py,,\n")
        for end in ("py", "pyc"):
            (site / f"{name}.{end}").write_bytes(b"x" * size)
    assert script.sizes(tmp_path) == {"small": 10, "large": 2_000_000}
    assert script.largest(script.sizes(tmp_path), 1) == [("large", 2_000_000)]
    with pytest.raises(SystemExit, match="is no environment"):
        script.sizes(tmp_path / "lib")


def test_glue_is_counted_without_its_docstrings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    script = loaded("docs/glue_lines.py")
    monkeypatch.setattr(script, "EXAMPLES", tmp_path)
    text = '"""Two\nlines."""\n\nimport x\n\n\nclass A:\n    """One."""\n    # why\n    b = (1,\n         2)\n'
    (tmp_path / "a.py").write_text(text)
    assert script.glue("a.py", ("A",)) == 3 and script.glue("a.py", ("*",)) == 4
    with pytest.raises(SystemExit, match="has no B"):
        script.glue("a.py", ("B",))
