"""What language models were asked and answered, as lines of JSON for fine-tuning, with what came of it."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from remac_bench.records import ExchangeEntry, Record
from remac_env.files import prepare_file

_CUT = "characters left out ...]"  # what records put in the middle of a text that is too long for them


def chats(
    records: Iterable[Record], *, roles: Iterable[str] = (), successful: bool = False
) -> Iterator[dict[str, Any]]:
    """A conversation for each question that was answered and is whole, in order.

    Each has `messages` ({"role", "content"}, the reply last, by the assistant), and beside them `asked` (the role that
    asked), `task`, `seed`, `iteration`, `round`, `success` (of the episode), `progress`, and `outcomes`: how the
    subtasks of the rounds that were played from then on ended.

    Args:
        roles: which roles' questions; empty: all.
        successful: only those of episodes that reached their goal.
    """
    wanted = set(roles)
    for record in records:
        if record.infrastructure_error or (successful and not record.success):
            continue
        for exchange in record.exchanges:
            if exchange.error is None and (not wanted or exchange.role in wanted) and _whole(exchange):
                yield _chat(record, exchange)


def _chat(record: Record, exchange: ExchangeEntry) -> dict[str, Any]:
    said = [{"role": role, "content": text} for role, text in exchange.messages]
    told = {"subtask", "status", "reason"}
    played = [
        {robot: entry.model_dump(include=told) for robot, entry in joint.items()}
        for joint in record.outcomes[exchange.round :]
    ]
    return {
        "messages": [*said, {"role": "assistant", "content": exchange.reply}],
        "asked": exchange.role, "task": record.task, "seed": record.seed, "iteration": record.iteration,
        "round": exchange.round, "success": record.success, "progress": record.progress, "outcomes": played,
    }  # fmt: skip


def _whole(exchange: ExchangeEntry) -> bool:
    """Whether nothing was cut out of its texts, and there is a reply."""
    texts = [text for _, text in exchange.messages] + [exchange.reply]
    return bool(exchange.reply) and not any(_CUT in text for text in texts)


def write_chats(path: Path, found: Iterable[dict[str, Any]]) -> int:
    """Write conversations as lines of JSON; how many there were."""
    count = 0
    with prepare_file(path, "chats").open("w", encoding="utf-8") as file:
        for chat in found:
            file.write(json.dumps(chat, ensure_ascii=False) + "\n")
            count += 1
    return count
