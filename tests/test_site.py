"""The site's pages, as docs/make_site.py puts them side by side: all in the order of pages, all links on the site."""

from __future__ import annotations

import ast
import importlib
import importlib.util
import re
import sys
from dataclasses import dataclass, fields, is_dataclass
from inspect import isclass, isfunction
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="module")
def maker() -> ModuleType:
    """docs/make_site.py, which is no module of a package."""
    spec = importlib.util.spec_from_file_location("make_site", ROOT / "docs" / "make_site.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def pages(maker: ModuleType, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The pages side by side."""
    folder = tmp_path_factory.mktemp("site") / "pages"
    maker.stage(folder)
    return folder


def test_every_page_is_in_the_order_of_pages_and_every_entry_is_a_page(pages: Path) -> None:
    nav = re.findall(r"([\w/]+\.md)$", (ROOT / "mkdocs.yml").read_text("utf-8").partition("\nnav:\n")[2], flags=re.M)
    there = {path.relative_to(pages).as_posix() for path in pages.rglob("*.md")}
    led_to = {name for name in there if name.startswith("examples/")}  # by the page of examples
    assert set(nav) == there - led_to, "each page of docs has its line under nav in mkdocs.yml"
    assert len(nav) == len(set(nav)) and len(led_to) > 10


def test_links_and_pictures_of_the_pages_are_there(pages: Path) -> None:
    seen = 0
    for page in pages.rglob("*.md"):
        text = re.sub(r"^```.*?^```", "", page.read_text("utf-8"), flags=re.M | re.S)
        for target in re.findall(r"\]\((?!http|#)([^)#]+)", text):
            assert (page.parent / target).is_file(), f"{page.relative_to(pages)} leads to {target}"
            seen += 1
    assert seen > 100
    assert "](pictures/" in (pages / "index.md").read_text("utf-8")
    assert "](../examples/task.md)" in (pages / "tutorials" / "task.md").read_text("utf-8")


def test_a_link_to_what_is_not_on_the_site_is_refused(maker: ModuleType) -> None:
    with pytest.raises(maker.SiteError, match=r"docs/x\.md leads to \.\./Makefile"):
        maker.moved("[a](../Makefile)", "docs/x.md", maker.places() | {"docs/x.md": "x.md"})
    code = "```sh\n[a](../Makefile)\n```\n"
    assert maker.moved(code, "docs/x.md", maker.places() | {"docs/x.md": "x.md"}) == code


def test_every_command_and_flag_is_on_the_page_of_commands(pages: Path) -> None:
    text = (pages / "reference" / "commands.md").read_text("utf-8")
    assert {"remac demo", "remac bench run", "remac memory prune"} <= set(re.findall(r"^## (.+)$", text, flags=re.M))
    assert "| `--max-rounds` |" in text and "needed" in text
    assert all(line.count("|") - line.count("\\|") == 4 for line in text.splitlines() if line.startswith("|"))


APART = {"remac_env.integrations.sb3"}
"""Modules that want what is not installed here; tests/integrations imports them."""


def test_the_reference_has_every_module_that_users_import(maker: ModuleType) -> None:
    shown = {module for _, modules in maker.REFERENCE.values() for module in modules}
    from test_examples import EXAMPLES, imported

    used = {name for path in EXAMPLES for name in imported(path.read_text("utf-8")) if name.startswith("remac_")}
    assert used <= shown, used - shown
    for module in shown - APART:
        made = importlib.import_module(module)
        assert made.__doc__, module
        for name in getattr(made, "__all__", ()):
            there = getattr(made, name)
            assert not (isclass(there) or isfunction(there)) or there.__doc__, f"{module}.{name} says nothing of itself"


def test_every_field_of_the_reference_says_what_it_is(maker: ModuleType) -> None:
    """In the docstring of its class, or on its row where it is an option."""
    modules = sorted({module for _, modules in maker.REFERENCE.values() for module in modules} - APART)
    shown = {made for module in modules for made in offered(importlib.import_module(module)) if isclass(made)}
    silent = {f"{c.__module__}.{c.__name__}": told for c in shown if (told := unsaid(c))}
    assert len(shown) > 100 and not silent


def offered(module: ModuleType) -> list[object]:
    """What users import from a module: what it lists, else what it defines."""
    there = {name: made for name, made in vars(module).items() if getattr(made, "__module__", "").startswith(OURS)}
    own = [name for name, made in there.items() if made.__module__ == module.__name__ and name[0] != "_"]
    return [there[name] for name in getattr(module, "__all__", own) if name in there]


OURS = ("remac_", __name__)


def unsaid(made: type) -> list[str]:
    """The public fields of a dataclass or of a record that nothing is said of."""
    if is_dataclass(made):
        names = [each.name for each in fields(made) if "row" not in each.metadata]
    else:
        names = list(getattr(made, "model_fields", ()))
    said = "\n".join(base.__doc__ or "" for base in made.__mro__ if base.__module__.startswith(OURS))
    return [name for name in names if name[0] != "_" and not re.search(rf"\b{name}\b", said)]


def test_a_field_of_which_nothing_is_said_is_found() -> None:
    @dataclass
    class Thing:
        """A thing. `size`: m."""

        size: float
        depth: float

    assert unsaid(Thing) == ["depth"]


def _listed_together(code: str) -> list[str]:
    """Arguments of which a docstring says the same in one line: the reference knows none by such a name."""
    found = []
    suspect = re.search(r"^ +\w+(?:, \w+)+: ", code, re.MULTILINE)
    for node in ast.walk(ast.parse(code)) if suspect else ():
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and (text := ast.get_docstring(node)):
            args = re.search(r"^Args:\n((?: {4}.*\n?|\n)*)", text, re.MULTILINE)
            found += re.findall(r"^ {4}\w+(?:, \w+)+: ", args[1], re.MULTILINE) if args else []
    return found


def test_every_argument_has_a_line_of_its_own() -> None:
    files = [file for room in ("remac_env", "remac_agents", "benchmarks") for file in (ROOT / room).rglob("*.py")]
    assert not {str(file): found for file in files if (found := _listed_together(file.read_text("utf-8")))}
    assert _listed_together('def f(a, b):\n    """X.\n\n    Args:\n        a, b: both.\n    """') == ["    a, b: "]


def test_what_a_page_would_fetch_from_elsewhere_is_found(maker: ModuleType, tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    fetching = '<script src="https://b.org/x.js"></script><link rel="x" href="//c.org/y">'
    page.write_text(f'<a href="https://a.org">x</a>{fetching}')
    assert maker.fetched(page) == ["https://b.org/x.js", "//c.org/y"]
