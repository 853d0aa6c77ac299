"""What several tests of the benchmark use."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from browser_helpers import chromium
from pages_helpers import mixed
from remac_bench.pages import write_pages
from remac_bench.proof import complete, verify
from remac_bench.records import Record
from remac_bench.store import Store

Check = Callable[..., Iterator[str]]

_FOUND: dict[tuple[str, ...], list[str]] = {}
_LISTED: dict[Any, list[Any]] = {}


@pytest.fixture
def replays(monkeypatch: pytest.MonkeyPatch) -> None:
    """Records that nobody changed are played again once, not by each test; and a suite's jobs are listed once."""

    def once(check: Check) -> Check:
        def found(rows: list[Record], **more: Any) -> Iterator[str]:
            key = (check.__name__, *(row.model_dump_json() for row in rows))
            if key not in _FOUND:
                _FOUND[key] = list(check(rows, **more))
            return iter(_FOUND[key])

        return found

    for name in ("check_job", "check_rounds"):
        monkeypatch.setattr(verify, name, once(getattr(verify, name)))
    listed = complete._listed

    def listed_once(suite: Any, jobs: Any, providers: str | None) -> list[Any]:
        key = suite.digest, tuple(sorted(job.key for job in jobs)), providers
        if key not in _LISTED:
            _LISTED[key] = listed(suite, jobs, providers)
        return _LISTED[key]

    monkeypatch.setattr(complete, "_listed", listed_once)


@pytest.fixture(scope="module")
def driver() -> Iterator[Any]:
    """A real Chromium."""
    with chromium() as made:
        yield made


@pytest.fixture(scope="module")
def many(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the pages of many records."""
    folder = tmp_path_factory.mktemp("many")
    Store(folder).append(mixed())
    write_pages(folder)
    return folder
