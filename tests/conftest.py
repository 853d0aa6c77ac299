"""Settings that all tests share."""

from __future__ import annotations

import gc
import signal
import sys
from collections import Counter
from collections.abc import Iterator
from functools import lru_cache

import hypothesis
import pytest
import typer.main
import typer.testing

import remac_env  # noqa: F401 - loads the table of tasks

hypothesis.settings.register_profile(
    "kitchen", deadline=None, derandomize=True, database=None, suppress_health_check=list(hypothesis.HealthCheck)
)
hypothesis.settings.load_profile("kitchen")

# Commands with all their options are put together once, and not for each of some thousand calls.
typer.main.get_command = typer.testing._get_command = lru_cache(maxsize=16)(typer.main.get_command)

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # so do shells start what runs in the background
    signal.signal(signal.SIGINT, signal.default_int_handler)


gc.disable()  # while tests are collected: trees of their code are no garbage, and it would look at them again and again


def pytest_collection_finish() -> None:
    """From here on the garbage collector works, and leaves out some thousand tests and all that they have imported.

    Searches and kitchens allocate much; otherwise each of its rounds would look at all of that again.
    """
    gc.collect()
    gc.freeze()
    gc.set_threshold(5000, 20, 10)
    gc.enable()


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Of a test marked ``few(n)`` the first ``n`` cases are fast tests, and the others long ones."""
    seen: Counter[str] = Counter()
    for item in items:
        mark = item.get_closest_marker("few")
        if mark is not None:
            name = item.nodeid.partition("[")[0]
            seen[name] += 1
            if seen[name] > mark.args[0]:
                item.add_marker(pytest.mark.long)


@pytest.fixture(autouse=True)
def the_path_stays_as_it_was() -> Iterator[None]:
    """Folders that a test imports from are forgotten after it, with what lies there: many call a file ``mine.py``."""
    path, before = list(sys.path), set(sys.modules)
    yield
    sys.path[:] = path
    known = tuple(folder for folder in (*path, sys.prefix, sys.base_prefix) if folder)
    for name in set(sys.modules) - before:
        file = getattr(sys.modules[name], "__file__", None)
        folders = [file] if file else list(getattr(sys.modules[name], "__path__", []))
        if folders and not name.startswith("remac_file_") and not folders[0].startswith(known):
            del sys.modules[name]


@pytest.fixture(autouse=True)
def the_table_of_tasks_stays_as_it_was() -> Iterator[None]:
    """Tasks that a test registers are forgotten after it, whatever order the tests run in."""
    table = sys.modules["remac_env.tasks"]._SPECS
    before = dict(table)
    yield
    table.clear()
    table.update(before)
