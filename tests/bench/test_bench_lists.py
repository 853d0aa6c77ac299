"""A suite's list is found again from the jobs of an entry, whoever checks."""

from __future__ import annotations

from typing import Any

import pytest
from remac_bench.playing.suites import load
from remac_bench.proof.complete import _listed


@pytest.mark.parametrize(
    "entry",
    [
        {"model": "openrouter:openai/o3"},
        {"model": "openrouter:deepseek/deepseek-r1"},  # no pictures: in methods that check, the checker is the truth
        {"model": "openrouter:deepseek/deepseek-r1", "checker": "truth"},
        {"model": "openrouter:openai/o3", "checker": "truth", "max_money": 3.0},
        {},
    ],
)
def test_the_jobs_of_an_entry_are_the_suites(entry: dict[str, Any]) -> None:
    suite = load("smoke")
    jobs = suite.jobs([entry] if entry else [{}])
    assert {job.key for job in _listed(suite, jobs, None)} == {job.key for job in jobs}
