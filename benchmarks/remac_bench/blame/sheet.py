"""The labels of a folder: as a table, and as a file beside its records."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from pydantic import ValidationError

from remac_bench.blame.labels import LABELS, Blame
from remac_bench.board import Column, Sheet
from remac_bench.errors import RecordFileError
from remac_bench.judging.cells import Cells, count, only_known, word
from remac_env.files import read_text

FILE = "blame.jsonl"

COLUMNS = (
    Column(key="agent", title="Method", numeric=False),
    Column(key="task", title="Task", numeric=False),
    Column(key="failed", title="Failed", help="scored episodes that failed"),
    Column(key="planner", title="Planner", help="its plan, or how it was mended, does not lead to the goal"),
    Column(key="checker", title="Checker", help="a wrong verdict led away from the goal, or let a failure pass"),
    Column(key="skill", title="Skill", help="a subtask failed though the skill table says that it succeeds"),
    Column(key="budget", title="Budget", help="the plan was on its way when the rounds ran out"),
    Column(key="crash", title="Crash", help="the agent raised an exception"),
    Column(key="unclear", title="Unclear", help="it goes another way when played again, or its optimum is unknown"),
    Column(key="rescued", title="Rescued", help="the oracle's steps from the bad round on reach the goal"),
    Column(key="first", title="For example", numeric=False, help="seed and round, counted from 1"),
)


def write_blames(folder: str | Path, blames: Iterable[Blame]) -> Path:
    """Write DIR/blame.jsonl anew, a label a line."""
    path = Path(folder) / FILE
    path.write_text("".join(f"{blame.model_dump_json()}\n" for blame in blames), "utf-8")
    return path


def read_blames(folder: str | Path) -> list[Blame]:
    """The labels of DIR/blame.jsonl; none where there is no such file.

    Raises:
        RecordFileError: if it cannot be read.
    """
    path = Path(folder) / FILE
    if not path.exists():
        return []
    try:
        return [Blame.model_validate_json(line) for line in read_text(path).split("\n") if line]
    except (ValidationError, UnicodeDecodeError) as error:
        raise RecordFileError(f"{path} holds no labels; `remac bench blame {folder}` writes it anew") from error


def blame_sheets(blames: Sequence[Blame], *, folder: str) -> list[Sheet]:
    """For each setting: how often each label was given, a row an agent and task."""
    settings = sorted({blame.setting for blame in blames})
    return [
        _sheet(
            where,
            [blame for blame in blames if blame.setting == where],
            key="blame" if len(settings) == 1 else f"blame-{index}",
            folder=folder,
        )
        for index, where in enumerate(settings, start=1)
    ]


def _sheet(where: str, blames: Sequence[Blame], *, key: str, folder: str) -> Sheet:
    groups: dict[tuple[str, str], list[Blame]] = {}
    for blame in blames:
        groups.setdefault((blame.agent, blame.task), []).append(blame)
    order = sorted(groups)
    return Sheet(
        key=key,
        title=f"Why episodes failed: {where}",
        caption="Each failed episode was played again; docs/judging.md defines the labels.",
        command=f"remac bench blame {folder}",
        columns=COLUMNS,
        rows=tuple(_cells(agent, task, groups[agent, task]) for agent, task in order),
        facts=tuple(
            {"agent": agent, "task": task, "method": groups[agent, task][0].method, "setting": where}
            for agent, task in order
        ),
    )


def _cells(agent: str, task: str, group: Sequence[Blame]) -> Cells:
    counts = {label: sum(blame.label == label for blame in group) for label in LABELS}
    commonest = max(LABELS, key=lambda label: counts[label])
    first = min((blame for blame in group if blame.label == commonest), key=lambda blame: (blame.seed, blame.job))
    return only_known(
        {
            "agent": word(agent),
            "task": word(task),
            "failed": count(len(group)),
            **{label: count(number) for label, number in counts.items()},
            "rescued": count(sum(bool(blame.rescued) for blame in group)),
            "first": word(f"seed {first.seed}, round {first.round + 1}", note=f"{first.label}: {first.what}"),
        }
    )
