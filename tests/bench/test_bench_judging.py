"""The board against numbers worked out by hand."""

from __future__ import annotations

import random
from typing import Any

import pytest
from bench_helpers import record
from remac_bench import judging, report
from remac_bench.board import Board, Sheet
from remac_bench.judging.alarms import derailments, detour_tokens, detours, tally
from remac_bench.judging.endings import ending
from remac_bench.judging.episodes import cap_seconds, idle_share, setting
from remac_bench.judging.published import published
from remac_bench.judging.ranking import compare, ranks
from remac_bench.judging.statistics import wilson
from remac_bench.metrics import overall, summarise
from remac_bench.playing.sight import checked_by
from remac_bench.records import CheckEntry, ErrorEntry, ExchangeEntry, OutcomeEntry, Record, UsageEntry

CRASH = ErrorEntry(kind="agent", type="KeyError", message="x")
BROKEN = ErrorEntry(kind="infrastructure", type="OSError", message="x")


def sheet(board: Board, key: str) -> Sheet:
    return next(sheet for sheet in board.sheets if sheet.key == key)


def texts(sheet: Sheet, *keys: str) -> list[tuple[str, ...]]:
    return [tuple(row[key].text if key in row else "-" for key in keys) for row in sheet.rows]


def entry(method: str, won: str, **changes: Any) -> list[Record]:
    """Scored records of one method on seeds 0, 1, ...: "+" is a success; each is a problem of its own."""
    return [
        record(
            job=f"{method}{seed}",
            agent=method,
            method=method,
            seed=seed,
            success=mark == "+",
            style=("coastal", "modern_1")[seed % 2],
            layout="one_wall_large",
            **{"problem": f"p{seed}", **changes},
        )
        for seed, mark in enumerate(won)
    ]


# -- matrix, endings -------------------------------------


def test_the_matrix_holds_every_agent_on_every_task() -> None:
    records = [*entry("CC", "+++-", task="HeatOnStove"), *entry("BASE", "----", task="HeatOnStove")]
    records += [each.model_copy(update={"job": f"{each.job}x", "task": "PickPlace"}) for each in entry("CC", "+-")]
    matrix = sheet(judging.board(records), "matrix")
    assert [column.title for column in matrix.columns] == ["Method", "all tasks", "HeatOnStove", "PickPlace"]
    assert texts(matrix, "agent", "task-0", "task-1", "task-2") == [
        ("BASE", "0%", "0%", "-"),
        ("CC", "67%", "75%", "50%"),
    ]
    cell = matrix.rows[1]["task-1"]
    assert (cell.note, cell.low, cell.high) == ("3 of 4", *wilson(3, 4))


def test_nobody_is_first_who_solved_nothing() -> None:
    board = judging.board([*entry("CC", "--"), *entry("BASE", "--")])
    assert texts(sheet(board, "ranking"), "agent", "rank") == [("BASE", "-"), ("CC", "-")]
    mixed = judging.board([*entry("CC", "-+"), *entry("BASE", "--")])
    assert texts(sheet(mixed, "ranking"), "agent", "rank") == [("CC", "1"), ("BASE", "-")]


def test_scr_says_why_it_is_not_tsr() -> None:
    plans = {"subtasks_done": 3, "final_plan_length": 4}
    (row,) = sheet(judging.board(entry("CC", "--", **plans)), "results").rows
    assert (row["tsr"].text, row["scr"].text) == ("0%", "75%") and "part, or all, of their plans" in row["scr"].note
    (row,) = sheet(judging.board(entry("CC", "++", **plans)), "results").rows
    assert (row["tsr"].text, row["scr"].text) == ("100%", "75%") and row["scr"].note.startswith("below TSR")
    (row,) = sheet(judging.board(entry("CC", "++", **{**plans, "subtasks_done": 4})), "results").rows
    assert row["scr"].note == ""


@pytest.mark.parametrize(
    ("facts", "told"),
    [
        ({}, "success"),
        ({"success": False, "end": "lost"}, "failed: goal out of reach"),
        ({"success": False, "end": "done"}, "failed: stopped too early"),
        ({"success": False, "end": "truncated"}, "failed: out of rounds"),
        ({"success": False, "end": "elsewhere"}, "failed: elsewhere"),
        ({"success": False, "error": CRASH}, "crashed"),
        ({"success": False, "error": BROKEN, "scored": False}, "not scored"),
    ],
)
def test_endings_are_told_in_words(facts: dict[str, Any], told: str) -> None:
    assert ending(record(**facts)) == told


# -- survivor bias ----------------------------------------


def test_failures_count_at_the_cap_where_survivors_are_not_to_be_preferred() -> None:
    facts = {"options": {"kitchen": {"max_rounds": 20}}}
    rows = summarise(
        [
            record(
                job="a",
                rounds=8,
                sim_seconds=60.0,
                initial_plan_length=4,
                final_plan_length=10,
                subtasks_done=10,
                **facts,
            ),
            record(
                job="b",
                rounds=3,
                sim_seconds=9.0,
                success=False,
                initial_plan_length=4,
                final_plan_length=4,
                subtasks_done=1,
                **facts,
            ),
            record(job="c", success=False, error=CRASH, **facts),
        ]
    )
    (row,) = rows
    assert (row.rounds, row.seconds, row.ipl, row.fpl) == (8.0, 60.0, 4.0, 10.0)
    assert row.rounds_all == pytest.approx((8 + 20 + 20) / 3)
    assert row.ipl_all == pytest.approx((4 + 20 + 20) / 3)
    assert row.fpl_all == pytest.approx((10 + 20 + 20) / 3)
    assert row.seconds_all == pytest.approx((60 + 2 * 20 * 9) / 3)  # the table's longest skill takes 9 s
    assert row.scr == pytest.approx(11 / (14 + 7)), "the crash has done nothing of a plan as long as the others'"
    assert row.scr_all == pytest.approx((1 + 0.25 + 0) / 3)


@pytest.mark.parametrize(
    ("task", "most", "cap"), [("SupperInTime", 300.0, 110.0), ("SupperInTime", 60.0, 60.0), ("HeatBoth", 300.0, 300.0),
                              ("TaskOfAnotherPackage", 200.0, 200.0)]
)  # fmt: skip
def test_by_the_event_clock_the_cap_is_the_tasks_deadline_where_that_is_sooner(
    task: str, most: float, cap: float
) -> None:
    options = {"kitchen": {"clock": "events", "max_seconds": most}}
    late = record(job="a", task=task, clock="events", success=False, sim_seconds=cap, options=options)
    assert cap_seconds(late) == cap
    (row,) = summarise([late])
    assert row.seconds_all == cap


def test_a_planner_without_a_first_plan_has_no_ipl_at_the_cap_either() -> None:
    (row,) = summarise([record(job="a", final_plan_length=5), record(job="b", success=False)])
    assert (row.ipl, row.ipl_all) == (None, None)


# -- crashes, infrastructure, order ----------------------------------------


def test_a_crash_is_a_failure_and_infrastructure_is_neither() -> None:
    records = [
        *entry("CC", "++"),
        record(job="x", seed=7, success=False, error=CRASH),
        record(job="y", seed=8, scored=False, success=False, error=BROKEN),
    ]
    (row,) = summarise(records)
    assert (row.n, row.successes, row.crashed, row.infrastructure) == (3, 2, 1, 1)
    cells = sheet(judging.board(records), "results").rows[0]
    assert (cells["tsr"].text, cells["crashed"].text, cells["infrastructure"].text) == ("67%", "1", "1")
    assert all(pair.n == 2 for pair in compare([*records, *entry("BASE", "--")]))


def test_neither_order_nor_duplicates_change_the_board() -> None:
    records = [
        *entry("CC", "+-++-+"),
        *entry("BASE", "--+---"),
        *entry("RE", "++++++", sim_seconds=0.1, usage=UsageEntry(money=0.1)),
    ]
    records.append(record(job="CC0", iteration=0, scored=False, success=False, error=BROKEN))  # run again since
    board = judging.board(records)
    shuffled = list(records) * 2
    random.Random(3).shuffle(shuffled)
    assert judging.board(shuffled) == board
    changed = [*records[:-1], *entry("BASE", "+++---")]
    assert judging.board(changed[6:]) != board


# -- the other columns ----------------------------------------


def turn(**robots: tuple[str, float]) -> dict[str, OutcomeEntry]:
    return {robot: OutcomeEntry(subtask=what, status="success", seconds=s) for robot, (what, s) in robots.items()}


def test_idle_share_is_of_the_robots_time() -> None:
    outcomes = [
        turn(robot_0=("pick up vegetable", 8.0), robot_1=("wait", 8.0)),
        turn(robot_0=("navigate to cabinet", 6.0), robot_1=("open cabinet door", 12.0)),
    ]
    assert idle_share(record(outcomes=outcomes)) == pytest.approx(1 - (8 + 6 + 12) / (2 * (8 + 12)))
    assert idle_share(record()) is None


def test_optimum_and_speed_up() -> None:
    same = {"style": "coastal", "layout": "one_wall_large"}
    records = [
        record(job="one", agent="RE", method="RE", rounds=9, optimum_rounds=9, **same),
        record(job="two", agent="REMAC", method="REMAC", robots=2, rounds=7, optimum_rounds=6, **same),
        record(job="three", agent="REMAC", method="REMAC", robots=2, seed=1, success=False, optimum_rounds=6, **same),
    ]
    alone, team = summarise(records)
    assert (alone.optimum, alone.speedup) == (1.0, None)
    assert team.optimum == pytest.approx(7 / 6)
    assert team.optimum_all == pytest.approx((7 / 6 + 30 / 6) / 2)
    assert (team.speedup, team.best_speedup) == (pytest.approx(9 / 7), pytest.approx(9 / 6))


def test_costs_are_of_jobs_with_all_their_iterations() -> None:
    cost = UsageEntry(calls=2, prompt_tokens=100, completion_tokens=20, money=0.25, unpriced=1)
    records = [
        record(job=job, iteration=i, scored=i == 1, usage=cost, wall_seconds=3.0) for job in "ab" for i in (0, 1)
    ]
    (row,) = summarise(records)
    assert (row.n, row.tries, row.calls, row.tokens, row.money, row.wall, row.unpriced) == (2, 2, 4, 240, 0.5, 6, 4)
    cells = sheet(judging.board(records), "results").rows[0]
    assert "4 calls" in cells["money"].note


def test_all_tasks_are_pooled_and_controls_stand_beside_learners() -> None:
    names = ("REFLECT", "CC-BEST", "RE", "BASE", "REMAC", "BASE-BEST", "CC")
    records = [
        record(job=f"{name}{task}{seed}", agent=name, method=name, task=task, seed=seed, success=seed > 0)
        for name in names
        for task in ("OpenCabinetPnP", "HeatOnStove")
        for seed in range(3)
    ]
    rows = overall(records)
    assert [row.agent for row in rows] == ["BASE", "CC", "RE", "REMAC", "BASE-BEST", "CC-BEST", "REFLECT"]
    assert {(row.task, row.n, row.successes, row.tasks) for row in rows} == {("all tasks", 6, 4, 2)}
    assert overall(records[:3]) == []


def test_a_learner_without_a_control_of_its_budget_is_named() -> None:
    alone = [record(job="r", agent="RE", method="RE", iteration=2)]
    assert "No control" in sheet(judging.board(alone), "results").caption
    with_control = [*alone, record(job="c", agent="CC-BEST", method="CC-BEST", iteration=2)]
    assert "No control" not in sheet(judging.board(with_control), "results").caption
    (pair,) = compare(with_control)
    assert pair.equal_budget
    (other,) = compare([*alone, record(job="c", agent="CC-BEST", method="CC-BEST", iteration=1)])
    assert not other.equal_budget


def test_suites_are_settings_of_their_own() -> None:
    class OfASuite(Record):
        suite: str | None = None
        suite_version: int | None = None

    plain = record()
    assert setting(plain) == "symbolic, paper starts"
    named = OfASuite(**plain.model_dump(by_alias=True) | {"suite": "paper", "suite_version": 2})
    assert setting(named) == "suite paper 2, symbolic, paper starts"


def test_phases_stand_beside_the_papers() -> None:
    class OfPhases(Record):
        phases: dict[str, bool] = {}

    def played(job: str, *reached: bool) -> Record:
        facts = record(job=job, task="SeasonedMicrowave", success=all(reached)).model_dump(by_alias=True)
        return OfPhases(**facts | {"phases": dict(zip(("open", "put", "season", "close"), reached, strict=True))})

    records = [played("a", True, True, True, True), played("b", True, True, False, False)]
    table = sheet(judging.board(records), "table-3")
    assert [column.title for column in table.columns] == ["Method", "n", "open", "put", "season", "close", "Time s"]
    assert texts(table, "agent", "n", "phase-1", "phase-2", "phase-3", "phase-4", "seconds") == [
        ("CC", "2", "100%", "100%", "50%", "50%", "0.0"),
        ("CC, the paper's", "20", "35%", "25%", "15%", "10%", "128.5"),
    ]
    assert {cell.note for key, cell in table.rows[1].items() if key != "agent"} == {"the paper's number"}
    assert not [s.key for s in judging.board([record()]).sheets if s.key == "table-3"]


# -- ranking ----------------------------------------


def test_ranks_follow_from_paired_comparisons() -> None:
    records = [*entry("RE", "+" * 20), *entry("CC", "+" * 18 + "--"), *entry("BASE", "-" * 20)]
    pairs = {(pair.first, pair.second): pair for pair in compare(records)}
    close, wide = pairs["RE", "CC"], pairs["RE", "BASE"]
    assert (close.n, close.problems, close.both, close.first_alone, close.second_alone) == (20, 20, 18, 2, 0)
    assert (close.p, close.adjusted, close.separated) == (0.5, 0.5, False)
    assert close.more is not None and close.more > 50
    assert wide.p == pytest.approx(2 / 2**20)
    assert wide.adjusted == pytest.approx(3 * 2 / 2**20)
    assert (wide.separated, wide.more) == (True, 0)
    assert ranks(list(pairs.values()), ["RE", "CC", "BASE"]) == {"RE": 1, "CC": 1, "BASE": 3}
    board = judging.board(records)
    assert texts(sheet(board, "ranking"), "rank", "agent", "better") == [
        ("1", "RE", "0"),
        ("1", "CC", "0"),
        ("3", "BASE", "2"),
    ]
    assert sheet(board, "ranking").rows[2]["better"].note == "CC, RE"
    assert "separated" in {row["verdict"].text for row in sheet(board, "pairs").rows}


def test_only_shared_episodes_are_compared() -> None:
    ours = entry("RE", "+" * 6)
    theirs = entry("CC", "-" * 12)  # seeds 6 to 11 are its own
    other_start = [r.model_copy(update={"digest": "b"}) for r in theirs]
    (pair,) = compare([*ours, *theirs])
    assert (pair.n, pair.first_alone) == (6, 6)
    assert compare([*(r.model_copy(update={"digest": "a"}) for r in ours), *other_start]) == []
    team = [r.model_copy(update={"digest": "a", "robots": 2}) for r in ours]
    assert compare([*team, *other_start])[0].n == 6  # digests name the robots: they cannot agree
    assert compare([*ours, *entry("CC", "-" * 6, backend="physics")]) == []


def test_one_problem_many_times_over_does_not_make_a_rank() -> None:
    """Forty wins in four problems: by episodes the difference is beyond doubt; four problems cannot show it."""
    ours = [record(job=f"o{at}", agent="RE", method="RE", seed=at, problem=f"p{at % 4}") for at in range(40)]
    theirs = [record(job=f"t{at}", success=False, seed=at, problem=f"p{at % 4}") for at in range(40)]
    (pair,) = compare([*ours, *theirs])
    assert (pair.n, pair.problems, pair.better, pair.worse) == (40, 4, 4, 0)
    assert pair.p == pytest.approx(2 / 16) and not pair.separated
    assert pair.more == 2, "with six problems an exact test could reach the level"
    board = judging.board([*ours, *theirs])
    assert texts(sheet(board, "ranking"), "agent", "n", "problems") == [("RE", "40", "4"), ("CC", "40", "4")]
    assert texts(sheet(board, "results"), "problems") == [("4",), ("4",)]


def test_records_without_a_problem_count_as_one_a_task_on_paper_starts() -> None:
    ours = [record(job=f"o{at}", agent="RE", method="RE", seed=at) for at in range(8)]
    theirs = [record(job=f"t{at}", success=False, seed=at) for at in range(8)]
    assert compare([*ours, *theirs])[0].problems == 1
    mixed = [entry.model_copy(update={"starts": "mixed"}) for entry in (*ours, *theirs)]
    assert compare(mixed)[0].problems == 8


# -- who checks ----------------------------------------


def checked(method: str, won: str, checker: str = "", **agent: Any) -> list[Record]:
    """Records of an entry with this checker; "" for the default."""
    options = {**agent, **({"checker": checker} if checker else {})}
    label = f"{method} ({checker})" if checker else method
    change = {"agent": label, "options": {"agent": options}}
    return [r.model_copy(update={**change, "job": label + r.job}) for r in entry(method, won)]


def test_entries_with_different_checkers_are_never_ranked_together() -> None:
    records = [
        *checked("BASE", "----"),
        *checked("CC", "++++"),
        *checked("CC", "+++-", "noisy"),
        *checked("RE", "++--", "noisy"),
    ]
    compared = {(pair.checker, frozenset((pair.first, pair.second))) for pair in compare(records)}
    assert compared == {
        ("truth", frozenset(("CC", "BASE"))),
        ("noisy", frozenset(("CC (noisy)", "BASE"))),
        ("noisy", frozenset(("RE (noisy)", "BASE"))),
        ("noisy", frozenset(("CC (noisy)", "RE (noisy)"))),
    }
    board = judging.board(records)
    ranked = {each.title: set(texts(each, "agent")) for each in board.sheets if each.key.startswith("ranking")}
    where = "symbolic, paper starts"
    assert ranked == {
        f"Ranking: {where}, checked by noisy": {("BASE",), ("CC (noisy)",), ("RE (noisy)",)},
        f"Ranking: {where}, checked by truth": {("BASE",), ("CC",)},
    }


def test_every_table_says_who_checks_where_that_is_not_the_truth_for_all() -> None:
    mixed = [*checked("BASE", "----"), *checked("CC", "++++"), *checked("CC", "+++-", "noisy")]
    board = judging.board(mixed)
    for each in board.sheets:
        if "agent" in [column.key for column in each.columns]:
            said = {row["agent"].text: row["checker"].text for row in each.rows if "checker" in row}
            assert said.get("CC", "truth") == "truth" and said.get("CC (noisy)", "noisy").startswith("noisy")
            assert any("checker" in row for row in each.rows), each.key
    text = report.board_markdown(board)
    assert "| Method | Checked by |" in text and "| CC (noisy) | noisy |" in text and "| BASE | - |" in text
    assert report.csv_text([sheet(board, "results")]).startswith("setting,task,agent,checker,n,")
    (first, *_) = report.tables(summarise(mixed), across=118)
    told = "\n".join(str(column.header) for column in first.columns)
    assert "Checked by" in told
    plain = judging.board([*checked("BASE", "----"), *checked("CC", "++++")])
    assert "Checked by" not in report.board_markdown(plain, everything=True)


@pytest.mark.parametrize(
    ("method", "agent", "truth_readers", "named"),
    [
        ("CC", {}, ["checker"], "truth"),
        ("CC", {"checker": "noisy,miss=0.2"}, ["checker"], "noisy,miss=0.2"),
        ("CC", {"model": "openai:o3"}, [], "openai:o3"),
        ("CC", {"model": "openai:o3", "checker": "truth"}, ["checker"], "truth"),
        ("CC", {"model": "deepseek:deepseek-reasoner"}, ["checker"], "truth"),  # an older record, which does not say
        ("BASE", {"model": "openai:o3"}, [], ""),
    ],
)
def test_records_say_who_checked(method: str, agent: dict[str, Any], truth_readers: list[str], named: str) -> None:
    made = record(method=method, agent=method, options={"agent": agent}, truth_readers=truth_readers)
    assert checked_by(made) == named


# -- evolution, audit ----------------------------------------


def test_evolution_shows_every_iteration_of_jobs_with_a_score() -> None:
    records = [
        record(
            job=job, agent="RE", method="RE", iteration=i, scored=i == 2, success=i > 0, final_plan_length=12 - 3 * i
        )
        for job in "ab"
        for i in range(3)
    ]
    records.append(record(job="c", agent="RE", method="RE", iteration=0, scored=False))  # broken off
    found = texts(sheet(judging.board(records), "evolution"), "iteration", "n", "tsr", "fpl")
    assert found == [("0", "2", "0%", "-"), ("1", "2", "100%", "9.0"), ("2", "2", "100%", "6.0")]


def check(round_: int, verdict: bool, truth: bool | None, subtask: str = "place to cabinet", **more: Any) -> CheckEntry:
    return CheckEntry(
        round=round_, robot="robot_0", subtask=subtask, condition="c", verdict=verdict, truth=truth, **more
    )


def test_the_audit_counts_verdicts_beside_the_truth() -> None:
    checks = [check(0, False, False), check(0, True, False), check(0, True, False)]
    checks += [check(0, False, True), check(0, True, True), check(0, True, None)]
    counted = tally(checks)
    assert (counted.found, counted.missed, counted.false_alarms, counted.passed, counted.unknown) == (1, 2, 1, 1, 1)
    audit = sheet(judging.board([record(pre_checks=checks)]), "audit")
    assert texts(audit, "kind", "verdicts", "precision", "recall", "false_alarms", "unknown")[0] == (
        "all",
        "5",
        "50%",
        "33%",
        "50%",
        "1",
    )


def test_what_a_checker_cannot_tell_is_counted_apart_and_by_kind() -> None:
    said = {
        "the microwave door is open": [(True, True), (False, False), (None, True), (None, False)],
        "the gripper of robot_0 holds the bowl": [(True, True)],
        "what robot_0 holds may touch the sink without a vessel": [(True, False)],
        "it is not so that robot_0 stands at the sink": [(False, False)],
    }
    checks = [
        CheckEntry(round=0, robot="robot_0", subtask="wait", condition=sentence, verdict=verdict, truth=truth)
        for sentence, pairs in said.items()
        for verdict, truth in pairs
    ]
    own = {"round": 0, "robot": "robot_0", "subtask": "wait", "unmatched": True}
    checks += [
        CheckEntry(**own, condition="all is well", verdict=None),
        CheckEntry(**own, condition="the oven may be hot", verdict=True),
    ]
    counted = tally(checks)
    assert (counted.known, counted.cannot_tell, counted.unknown, counted.unmatched) == (5, 3, 1, 2)
    assert (counted.found, counted.missed, counted.false_alarms, counted.passed) == (2, 1, 0, 2)
    board = judging.board([record(pre_checks=checks)])
    audit = texts(sheet(board, "audit"), "kind", "verdicts", "recall", "cannot_tell", "unknown", "unmatched")
    assert audit[0] == ("all", "5", "67%", "3", "1", "2")
    rows = texts(sheet(board, "conditions"), "kind", "predicate", "verdicts", "recall", "cannot_tell", "unmatched")
    assert rows == [
        ("seen", "all", "3", "100%", "3", "1"),
        ("seen", "door_open", "2", "100%", "2", "0"),
        ("seen", "not at", "1", "100%", "0", "0"),
        ("seen", "own words", "0", "-", "1", "1"),
        ("felt", "all", "1", "-", "0", "0"),
        ("felt", "holding", "1", "-", "0", "0"),
        ("known", "all", "1", "0%", "0", "1"),
        ("known", "no_vessel_needed", "1", "0%", "0", "0"),
        ("known", "own words", "0", "-", "0", "1"),
    ]


def test_verdicts_of_older_records_are_read_as_they_were() -> None:
    old = '{"round": 1, "robot": "r", "subtask": "wait", "condition": "c", "verdict": true, "truth": false}'
    entry = CheckEntry.model_validate_json(old)
    assert (entry.verdict, entry.reason, entry.unmatched) == (True, "", False)


def test_rounds_and_tokens_of_false_alarms() -> None:
    """An alarm before round 1 sends the robot to the counter and back; one after round 3 has it place again."""
    names = (
        "navigate to cabinet",
        "navigate to counter",
        "navigate to cabinet",
        "place to cabinet",
        "place to cabinet",
    )
    played = [turn(robot_0=(name, 6.0)) for name in names]
    asked = [ExchangeEntry(round=index, role="adjuster", tokens=10**index) for index in range(5)]
    detour = record(
        outcomes=played,
        pre_checks=[check(1, False, True)],
        post_checks=[check(4, False, True)],
        exchanges=asked,
    )
    assert detours(detour) == {1: 1, 2: 1, 4: 4}
    assert detour_tokens(detour) == 10 + 100 + 10_000
    assert [alarm.round for alarm in derailments(detour)] == [1]
    provoked = detour.model_copy(
        update={"pre_checks": [check(1, False, True), check(1, False, False)], "post_checks": []}
    )
    assert detours(provoked) == {}
    heeded = detour.model_copy(update={"pre_checks": [check(3, False, True)], "post_checks": []})
    assert (detours(heeded), derailments(heeded)) == ({}, [])


def test_doses_stand_beside_responses() -> None:
    def of(checker: str, wrong: int, won: str) -> list[Record]:
        checks = [check(0, index >= wrong, True) for index in range(10)]
        return [
            r.model_copy(
                update={
                    "job": checker + r.job,
                    "agent": checker,
                    "pre_checks": checks,
                    "options": {"agent": {"checker": checker}},
                }
            )
            for r in entry("CC", won)
        ]

    erring = [r.model_copy(update={"rounds": 9}) for r in of("noisy,false_alarm=0.3,miss=0", 3, "+---")]
    board = judging.board([*erring, *of("truth", 0, "++++")])
    assert texts(sheet(board, "dose"), "more_rounds") == [("0.00",), ("9.00",)]
    assert texts(sheet(board, "dose"), "agent", "checker", "false_alarms", "misses", "n", "tsr") == [
        ("CC", "truth", "0%", "-", "4", "100%"),
        ("CC", "noisy,false_alarm=0.3,miss=0", "30%", "-", "4", "25%"),
    ]


# -- the paper's numbers ----------------------------------------


def test_the_papers_numbers_stand_beside_ours_and_are_marked() -> None:
    records = [
        record(job=f"{task}{method}", task=task, agent=method, method=method)
        for task in ("OpenCabinetPnP", "HeatOnStove")
        for method in ("CC", "REMAC", "CAPE")
    ]
    board = judging.board(records)
    table = sheet(board, "table-1")
    assert texts(table, "task", "agent", "tsr", "paper_tsr", "paper_scr", "paper_length") == [
        ("OpenCabinetPnP", "CC", "100%", "20%", "64%", "11.0"),
        ("OpenCabinetPnP", "REMAC", "100%", "30%", "68%", "4.0"),
        ("HeatOnStove", "CC", "100%", "50%", "74%", "13.0"),
        ("HeatOnStove", "REMAC", "100%", "60%", "91%", "7.0"),
    ]
    assert {row["paper_tsr"].note for row in table.rows} == {"the paper's number"}
    assert "language models" in table.caption and "own skills" in table.caption
    figure = sheet(board, "figure-6")
    found = {row["agent"].text: row["paper_tsr"].text for row in figure.rows if "paper_tsr" in row}
    assert found["REMAC"] == "45.0%"
    assert found["o3 (planner alone)"] == "10.0%"
    assert "CAPE" not in found
    mixed = judging.board([r.model_copy(update={"starts": "mixed"}) for r in records])
    assert not [s.key for s in mixed.sheets if s.key in ("table-1", "figure-6")]


def test_the_published_numbers_agree_with_the_papers_own_averages() -> None:
    paper = published()
    tasks = [name for name, value in paper["table_1"].items() if isinstance(value, dict)]
    assert len(tasks) == 4
    means = {m: sum(paper["table_1"][t][m]["tsr"] for t in tasks) / 4 for m in ("BASE", "CC", "RE", "REMAC")}
    assert means == pytest.approx({"BASE": 0.05, "CC": 0.325, "RE": 0.45, "REMAC": 0.45})
    average = {"gpt-4o": 0.125, "QwQ": 0.2625, "DeepSeek-R1": 0.375, "o3": 0.625, "Qwen3": 0.6625, "Grok3": 0.825}
    assert {m: sum(paper["table_2"][t][m] for t in tasks) / 4 for m in average} == pytest.approx(average)
