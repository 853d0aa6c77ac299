"""The fields of a record that come from the agent's own report, cut to size and without secrets."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from remac_agents.text.printable import printable
from remac_bench.records import CheckEntry, ExchangeEntry, UsageEntry
from remac_bench.redaction import redact
from remac_bench.store import PICTURES

MESSAGE_MAX = 500
"""Characters of an error's message in a record."""

TEXT_MAX = 20_000
"""Characters of one prompt or reply in a record; the middle of a longer one is left out, and the text says so."""

EXCHANGES_MAX = 500
"""Exchanges of one episode in a record; the last ones are left out. `usage` counts them all."""


class EndpointError(RuntimeError):
    """An episode that says nothing about the agent, because a language model could not be reached."""


def report_fields(report: Any) -> dict[str, Any]:
    """The fields that an EpisodeReport fills."""
    return {
        "initial_plan": {robot: list(row) for robot, row in report.initial_plan.items()},
        "final_plan": {robot: list(row) for robot, row in report.final_plan.items()},
        "initial_plan_length": report.initial_plan_length,
        "final_plan_length": report.final_plan_length,
        "subtasks_done": report.subtasks_done,
        "pre_checks": [_copy(CheckEntry, entry) for entry in report.pre_checks],
        "post_checks": [_copy(CheckEntry, entry) for entry in report.post_checks],
        "adjusted": report.adjusted,
        "retries": report.retries,
        "reflections": list(report.reflections),
        "truth_readers": list(report.truth_readers),
        "rule_readers": list(report.rule_readers),
        "isolated": report.isolated,
        "weights": dict(report.weights),
        "planner_errors": [redact(text)[:MESSAGE_MAX] for text in report.errors],
        "usage": _copy(UsageEntry, report.usage),
        "adaptations": list(report.adaptations),
        "exchanges": [_exchange(entry) for entry in report.exchanges[:EXCHANGES_MAX]],
    }


def save_pictures(folder: str | Path, pictures: Mapping[str, bytes]) -> None:
    """Write each picture to folder/pictures/<digest>.png, unless it is there; a half-written one is never seen."""
    for digest, png in pictures.items():
        path = Path(folder) / PICTURES / f"{digest}.png"
        if path.exists():
            continue
        path.parent.mkdir(parents=True, exist_ok=True)
        part = path.with_suffix(f".{id(png)}.part")
        part.write_bytes(png)
        part.replace(path)


def cut(text: str, longest: int = TEXT_MAX) -> str:
    """A printable text of at most about `longest` characters: the beginning, how much is missing, and the end."""
    text = printable(text)
    if len(text) <= longest:
        return text
    half = longest // 2
    return f"{text[:half]}\n[... {len(text) - 2 * half} characters left out ...]\n{text[-half:]}"


def _exchange(entry: Any) -> ExchangeEntry:
    told = {name: getattr(entry, name) for name in ExchangeEntry.model_fields}
    told["messages"] = [(role, cut(text)) for role, text in entry.messages]
    told["reply"], told["reasoning"] = cut(entry.reply), cut(entry.reasoning)
    told["pictures"], told["adaptations"] = list(entry.pictures), list(entry.adaptations)
    return ExchangeEntry(**told)


def _copy(kind: Any, entry: Any) -> Any:
    return kind(**{name: getattr(entry, name) for name in kind.model_fields})
