"""The metrics against numbers worked out by hand."""

from __future__ import annotations

import itertools

import pytest
from bench_helpers import record
from remac_bench.judging.statistics import wilson
from remac_bench.metrics import summarise
from remac_bench.records import ErrorEntry

CRASH = ErrorEntry(kind="agent", type="KeyError", message="x")
BROKEN = ErrorEntry(kind="infrastructure", type="OSError", message="x")


@pytest.mark.parametrize(
    ("successes", "low", "high"), [(18, 30.7, 60.2), (13, 20.1, 48.0), (9, 12.3, 37.5), (2, 1.4, 16.5)]
)
def test_wilson_gives_the_published_intervals_of_forty_episodes(
    successes: int, low: float, high: float
) -> None:
    assert [round(100 * bound, 1) for bound in wilson(successes, 40)] == [low, high]


def test_wilson_ends_exactly_at_zero_and_one_and_refuses_nonsense() -> None:
    assert wilson(0, 3)[0] == 0.0
    assert wilson(3, 3)[1] == 1.0
    for successes, n in ((1, 0), (4, 3), (-1, 3)):
        with pytest.raises(ValueError, match="not valid"):
            wilson(successes, n)


def episodes() -> list:
    """Two successes, a failure, a crash, and a job that never got a score."""
    return [
        record(job="a", sim_seconds=40.0, initial_plan_length=4, final_plan_length=11, subtasks_done=11),
        record(job="b", sim_seconds=50.0, initial_plan_length=6, final_plan_length=9, subtasks_done=7),
        record(
            job="c",
            success=False,
            sim_seconds=900.0,
            initial_plan_length=30,
            final_plan_length=20,
            subtasks_done=2,
        ),
        record(job="d", success=False, sim_seconds=900.0, error=CRASH),
        record(job="e", scored=False, success=False, error=BROKEN, subtasks_done=99, final_plan_length=99),
    ]


def test_each_metric_counts_what_it_should() -> None:
    (row,) = summarise(episodes())
    assert (row.n, row.successes, row.crashed, row.infrastructure) == (4, 2, 1, 1)
    assert row.tsr == 0.5
    assert row.scr == pytest.approx((11 + 7 + 2) / (11 + 9 + 20 + 40 / 3))  # the crash did nothing of a plan
    assert (row.seconds, row.ipl, row.fpl) == (45.0, 5.0, 10.0)  # over successes alone


def test_iterations_before_the_last_do_not_count() -> None:
    early = [record(job="a", scored=False, success=False, iteration=i, final_plan_length=50) for i in (0, 1)]
    (row,) = summarise([*early, record(job="a", iteration=2, final_plan_length=9, subtasks_done=9)])
    assert (row.n, row.tsr, row.scr, row.fpl) == (1, 1.0, 1.0, 9.0)


def test_nothing_measured_is_none_and_not_zero() -> None:
    (row,) = summarise([record(scored=False, success=False, error=BROKEN)])
    assert (row.n, row.tsr, row.low, row.scr, row.seconds, row.ipl) == (0, None, None, None, None, None)
    assert row.infrastructure == 1


def test_a_job_that_was_run_again_is_no_infrastructure_error_any_more() -> None:
    (row,) = summarise([record(iteration=1, scored=False, success=False, error=BROKEN), record(iteration=2)])
    assert (row.n, row.infrastructure) == (1, 0)


def test_a_planner_without_an_initial_plan_has_no_ipl() -> None:
    (row,) = summarise([record(initial_plan_length=None, final_plan_length=6)])
    assert (row.ipl, row.fpl) == (None, 6.0)


def test_the_order_of_records_never_changes_a_digit() -> None:
    seconds = (0.1, 0.2, 0.3, 1e9)
    rows = {
        summarise([record(job=str(i), sim_seconds=s) for i, s in enumerate(order)])[0].seconds
        for order in itertools.permutations(seconds)
    }
    assert len(rows) == 1


def test_settings_and_agents_are_kept_apart_and_tasks_in_order() -> None:
    rows = summarise(
        [
            record(job="1", task="Zebra", agent="CC"),
            record(job="2", agent="REMAC", method="REMAC"),
            record(job="3", agent="BASE", method="BASE"),
            record(job="4", task="OpenCabinetPnP"),
            record(job="5", backend="physics"),
            record(job="6", options={"kitchen": {"wording": 1, "style": "modern_1"}}),
            record(job="7", options={"kitchen": {"wording": 3, "style": "coastal"}}, task="Zebra"),
        ]
    )
    assert [(row.setting, row.task, row.agent, row.n) for row in rows] == [
        ("physics, paper starts", "HeatOnStove", "CC", 1),
        ("symbolic, paper starts", "OpenCabinetPnP", "CC", 1),
        ("symbolic, paper starts", "HeatOnStove", "BASE", 1),
        ("symbolic, paper starts", "HeatOnStove", "REMAC", 1),
        ("symbolic, paper starts", "Zebra", "CC", 2),
        ("symbolic, paper starts, wording=1", "HeatOnStove", "CC", 1),
    ]
