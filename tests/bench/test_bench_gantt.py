"""Pages of episodes by the event clock: bars begin and end when they did, and checks stand where they were made."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from pages_helpers import EVIL, Element, alien, hostile, parse
from remac_bench.pages.episode_page import page
from remac_bench.pages.gantt import LEFT, RIGHT, WIDTH
from remac_bench.pages.rounds import decision_points, round_spans, shown_rounds
from remac_bench.playing.jobs import Job
from remac_bench.playing.timing import replayed
from remac_bench.playing.worker import Work, play_job
from remac_bench.records import CheckEntry, Record, SpanEntry

import remac_env
from remac_env.options import Options


def play(method: str, task: str, *, planner: str = "literal", **options: Any) -> Record:
    made = {"backend": "symbolic", "robots": 2, "clock": "events", "think": "fixed:1.5"} | options
    job = Job(method=method, task=task, seed=1, options=Options(**made), agent={"planner": planner})  # type: ignore[arg-type]
    (record,) = play_job(Work(job=job, folder="", video="none"))
    assert record.error is None, record.error
    return record


@pytest.fixture(scope="module")
def cooked() -> Record:
    """Two robots as the sentence says, each by itself, while food is melting."""
    return play("REACT", "FrozenInTime", planner="reader", max_seconds=90.0)


def bars(record: Record, folder: Path) -> list[Element]:
    return parse(page(record, folder=folder)).all("a", class_="bar")


def test_decision_points_are_what_the_clock_showed(cooked: Record) -> None:
    env, seen = remac_env.parallel_env(cooked.task, **cooked.options["kitchen"]), [0.0]
    _, infos = env.reset(seed=1)
    for told in cooked.orders:
        tokens, thoughts = replayed(env, told, infos)
        for robot, thought in thoughts.items():
            env.note_thought(robot, thought)
        _, _, _, _, infos = env.step(tokens)
        seen.append(next(iter(infos.values()))["seconds"])
    env.close()
    assert decision_points(cooked) == seen
    assert round_spans(cooked)[-1][1] == cooked.sim_seconds


def test_bars_are_the_timeline(cooked: Record, tmp_path: Path) -> None:
    kinds = {span.kind for span in cooked.timeline}
    assert {"subtask", "thought", "process"} <= kinds
    drawn = [span for span in cooked.timeline if span.kind != "wait"]
    found = bars(cooked, tmp_path)
    assert len(found) == len(drawn)
    scale = (WIDTH - LEFT - RIGHT) / cooked.sim_seconds
    spots = {(bar.attributes["data-begins"], bar.attributes["data-ends"], float(bar.all("rect")[0].attributes["x"]))
             for bar in found}  # fmt: skip
    assert spots == {(str(s.began), str(s.ended), round(LEFT + scale * s.began, 1)) for s in drawn}
    for kind in ("thought", "process"):
        assert sum(kind in bar.attributes["class"].split() for bar in found) == sum(s.kind == kind for s in drawn)
    moved = cooked.timeline[0].model_copy(update={"began": 0.5})
    other = bars(cooked.model_copy(update={"timeline": [moved, *cooked.timeline[1:]]}), tmp_path)
    assert [bar.attributes for bar in other] != [bar.attributes for bar in found]


def test_a_bar_leads_to_where_its_outcome_stands(cooked: Record, tmp_path: Path) -> None:
    root = parse(page(cooked, folder=tmp_path))
    for bar in root.all("a", class_="bar"):
        if "thought" not in bar.attributes["class"] and "process" not in bar.attributes["class"]:
            (part,) = root.all("article", id=bar.attributes["href"][1:])
            command = bar.attributes["aria-label"].split(": ")[1]
            assert command in part.text and "Decision" in part.text
    (gantt,) = root.all("svg", class_="gantt")
    assert gantt.attributes["data-starts"] == " ".join(map(str, decision_points(cooked)))


@pytest.mark.parametrize("method", ["CC", "REACT"])
def test_checks_and_orders_stand_where_they_were_made(method: str, tmp_path: Path) -> None:
    record = play(method, "OpenCabinetPnP", starts="mixed")
    spans = round_spans(record)
    rounds = shown_rounds(record, spans, tmp_path)
    assert [each.orders for each in rounds[:-1]] == record.orders
    shown = [check for each in rounds for check in each.checks]
    assert len(shown) == len(record.pre_checks) + len(record.post_checks)
    for each in rounds:
        before = {(check.entry.robot, check.entry.subtask) for check in each.checks if check.when == "before"}
        told = {(robot, order.command) for robot, order in each.orders.items()}
        assert not before or before & told
        for check in each.checks:
            if check.when == "after":
                assert check.entry.robot in each.outcomes


def test_what_was_cut_off_is_said(tmp_path: Path) -> None:
    record = play("CC", "OpenCabinetPnP", max_seconds=20.0)
    cut = [bar for bar in bars(record, tmp_path) if "cut" in bar.attributes["class"].split()]
    assert len(cut) == sum(span.status == "cut" and span.kind != "wait" for span in record.timeline) > 0
    assert all("cut, " in bar.attributes["aria-label"] for bar in cut)


def test_a_hostile_timeline_is_text_and_no_more(tmp_path: Path) -> None:
    kinds = ("subtask", "wait", "thought", "process", EVIL)
    spans = [SpanEntry(who=EVIL, kind=kind, what=EVIL, began=1.0, ended=2.0, reason=EVIL) for kind in kinds]
    check = CheckEntry(round=7, robot=EVIL, subtask=EVIL, condition=EVIL, verdict=False)
    html = page(hostile(clock="events", timeline=spans, pre_checks=[check]), folder=tmp_path)
    assert alien(html) == [] and len(parse(html).all("a", class_="bar")) == 3
