"""Tables of README and docs stand beside their commands, and a stale one is found."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture()
def maker() -> ModuleType:
    """docs/make_tables.py, which is no module of a package."""
    spec = importlib.util.spec_from_file_location("make_tables", ROOT / "docs" / "make_tables.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    import sys

    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def test_tables_stand_beside_their_commands(maker: ModuleType) -> None:
    found = maker.tables()
    assert {table.page.name for table in found} >= {"README.md", "experiments.md"}
    assert any(not table.slow for table in found), "nothing would be checked"
    assert all(table.body.strip() for table in found), [table.command for table in found if not table.body.strip()]


def test_a_stale_table_is_found_and_made_anew(
    maker: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    page = tmp_path / "page.md"
    page.write_text(
        "before\n<!-- table: python benchmarks/offline_tables.py tasks -->\n\n| old |\n\n<!-- end of table -->\nafter\n"
        "<!-- table slow: python nowhere.py -->\nkept\n<!-- end of table -->\n"
    )
    monkeypatch.setattr(maker, "PAGES", (page,))
    monkeypatch.setattr(maker, "ROOT", tmp_path)
    monkeypatch.setattr(maker, "run", lambda command: "| new |")
    monkeypatch.setattr("sys.argv", ["make_tables.py", "--check"])
    assert maker.main() == 1
    assert "stale table in page.md: python benchmarks/offline_tables.py tasks" in capsys.readouterr().err
    monkeypatch.setattr("sys.argv", ["make_tables.py", "--fast"])
    assert maker.main() == 0
    text = page.read_text()
    assert "| new |" in text and "| old |" not in text and "\nafter\n" in text and "\nkept\n" in text
    monkeypatch.setattr("sys.argv", ["make_tables.py", "--check"])
    assert maker.main() == 0
