"""Every exchange with a model as a line of JSON, and the same exchanges played back without a network."""

from __future__ import annotations

import contextlib
import difflib
import hashlib
import json
import os
import threading
from collections.abc import Iterator, Mapping
from dataclasses import asdict, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import IO, Any, Literal

from remac_agents.llm.outcomes import KINDS, Bill, ChatError, ChatReply
from remac_agents.llm.redaction import plain
from remac_agents.llm.request import digest
from remac_agents.text.printable import PATH, quoted, words
from remac_env.errors import OptionError, check_choice
from remac_env.files import ends_torn, unmarked
from remac_env.locks import lock, unlock

VERSION = 1
Mode = Literal["record", "replay", "fill"]
DIFF_LINES = 60
CANDIDATES = 200
MOST = 1e12
"""Tokens, dollars or seconds of one call; more is no number of any of them."""


class Cassette:
    """A file of exchanges; threads and processes may share it.

    Modes: "record" always asks the model and appends; "replay" never does, and a request that is not on the cassette
    is an error that shows the difference to the nearest one; "fill" plays what is there and records the rest, so that
    a run which was interrupted pays for nothing twice.

    Equal requests are played in the order in which they were recorded. Played are replies, and errors that lie with
    the model (such as a refused answer); an outage is written down but never played: it was nobody's answer. A line
    that is torn, or was changed by hand, is not played either.

    Attributes:
        path: the file.
        mode: one of the three.
        damaged: lines of the file that are not played, for what they are.
        misses: requests in "fill" that were not on it.
    """

    def __init__(self, path: Path | str, *, mode: Mode = "record") -> None:
        """Open a cassette.

        Raises:
            UnknownNameError: for an unknown mode.
            OptionError: if the file cannot be read, or written.
        """
        check_choice("cassette mode", mode, ("record", "replay", "fill"))
        self.path = Path(path)
        self.mode = mode
        self.damaged = 0
        self.misses = 0
        self._lock = threading.Lock()
        self._told: dict[str, list[ChatReply | ChatError]] = {}
        self._played: dict[str, int] = {}
        self._requests: dict[str, Mapping[str, Any]] = {}
        try:
            if self.path.exists() and not self.path.is_file():
                raise OSError("it is no file")
            if mode != "record" and (mode == "replay" or self.path.exists()):
                self._load()
            if mode != "replay":
                self.path.parent.mkdir(parents=True, exist_ok=True)
                self.path.open("ab").close()
        except (OSError, ValueError) as error:
            told = f"cassette {quoted(str(self.path), PATH)}: {words(error)[:200]}"
            raise OptionError(f"{told}; valid: a file of recorded exchanges") from error

    def __repr__(self) -> str:
        return f"<Cassette {str(self.path)!r}, mode {self.mode!r}, {len(self)} answers>"

    def __len__(self) -> int:
        return sum(len(outcomes) for outcomes in self._told.values())

    @property
    def models(self) -> frozenset[str]:
        """The models, `provider:model`, that it holds answers of."""
        return frozenset(str(request.get("model")) for request in self._requests.values())

    def play(self, canonical: Mapping[str, Any]) -> ChatReply | ChatError | None:
        """The next recorded outcome of this request; None: ask the model."""
        if self.mode == "record":
            return None
        key = digest(canonical)
        with self._lock:
            outcomes = self._told.get(key, [])
            index = self._played.get(key, 0)
            if index < len(outcomes):
                self._played[key] = index + 1
                return outcomes[index]
            if self.mode == "fill":
                return None
            self.misses += 1
            if outcomes:
                return ChatError("cassette_miss", f"{self.path.name}: asked more often than recorded ({len(outcomes)})")
            return ChatError("cassette_miss", f"{self.path.name}: {self._nearest(canonical)}")

    def record(self, canonical: Mapping[str, Any], outcome: ChatReply | ChatError) -> None:
        """Append an exchange. Both must hold no key any more.

        Raises:
            OSError: if it cannot be written; nothing but a torn line, which readers skip, is then left behind.
        """
        entry: dict[str, Any] = {
            "version": VERSION,
            "key": digest(canonical),
            "at": datetime.now(UTC).isoformat(timespec="seconds"),
            "played": isinstance(outcome, ChatReply) or not KINDS[outcome.kind].infrastructure,
            "request": canonical,
            "outcome": "reply" if isinstance(outcome, ChatReply) else "error",
            "value": {name: value for name, value in asdict(outcome).items() if name != "took"},
        }
        entry["check"] = _check(entry)
        line = json.dumps(entry, ensure_ascii=True).encode() + b"\n"
        with self._lock, self.path.open("ab+") as file, _alone(file):
            # A line that was torn when a process died must not swallow this one.
            file.write((b"\n" if ends_torn(file) else b"") + line)
            file.flush()
            os.fsync(file.fileno())

    def _load(self) -> None:
        with self.path.open("rb") as file:
            for line in file:
                entry = _entry(line)
                outcome = None if entry is None else _outcome(entry)
                if entry is None or outcome is None:
                    self.damaged += bool(line.strip())
                elif entry["played"]:
                    self._told.setdefault(entry["key"], []).append(outcome)
                    self._requests.setdefault(entry["key"], entry["request"])

    def _nearest(self, canonical: Mapping[str, Any]) -> str:
        """How a request differs from the one on the cassette that is most like it."""
        if not self._requests:
            return "the cassette is empty"
        asked = _shown(canonical)
        head = "\n".join(asked)[:20_000]
        scores: list[tuple[float, str]] = []
        for key in list(self._requests)[-CANDIDATES:]:
            other = "\n".join(_shown(self._requests[key]))[:20_000]
            scores.append((difflib.SequenceMatcher(None, head, other, autojunk=True).quick_ratio(), key))
        nearest = _shown(self._requests[max(scores)[1]])
        lines = list(difflib.unified_diff(nearest, asked, "recorded", "asked", n=1, lineterm=""))
        more = [f"... and {len(lines) - DIFF_LINES} lines more"] if len(lines) > DIFF_LINES else []
        return "\n".join(["not recorded; the nearest request differs so:", *lines[:DIFF_LINES], *more])


def _shown(canonical: Mapping[str, Any]) -> list[str]:
    """A request as lines for people."""
    lines = [f"{name}: {json.dumps(value)[:400]}" for name, value in canonical.items() if name != "messages"]
    for role, text in canonical.get("messages", []):
        lines += [f"[{role}]", *(plain(line, limit=300) for line in text.splitlines())]
    return lines


def _check(entry: Mapping[str, Any]) -> str:
    text = json.dumps({name: value for name, value in entry.items() if name != "check"}, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _entry(line: bytes) -> dict[str, Any] | None:
    """A line that is whole and unchanged, or None."""
    try:
        entry = json.loads(unmarked(line.decode()))
        whole = isinstance(entry, dict) and entry.get("version") == VERSION and entry.get("check") == _check(entry)
        return entry if whole and entry["key"] == digest(entry["request"]) else None
    except (ValueError, RecursionError, KeyError):
        return None


def _outcome(entry: Mapping[str, Any]) -> ChatReply | ChatError | None:
    """What came of an exchange; None where no client could have written it."""
    try:
        value = dict(entry["value"])
        value["bill"] = Bill(**value["bill"]) if "bill" in value else _old_bill(value)
        value["adaptations"] = tuple(value.get("adaptations", ()))
        if entry["outcome"] == "error":
            outcome: ChatReply | ChatError = ChatError(**value)
        else:
            outcome = ChatReply(**value | {"flags": tuple(value.get("flags", ()))})
    except (TypeError, ValueError, KeyError):
        return None
    return outcome if _is_sound(outcome) else None


def _is_sound(outcome: ChatReply | ChatError) -> bool:
    """Whether counts, money and seconds are numbers of their kind, and nothing is less than nothing."""
    bill = outcome.bill
    counts = [outcome.attempts, bill.requests, bill.tokens_in, bill.tokens_out, bill.unpriced]
    counts += [each for each in (outcome.tokens_in, outcome.tokens_out) if each is not None]
    amounts = [outcome.seconds, outcome.took, bill.money, outcome.money or 0.0]
    texts = [outcome.kind, outcome.detail] if isinstance(outcome, ChatError) else [outcome.text, outcome.reasoning]
    return (
        all(type(count) is int and 0 <= count <= MOST for count in counts)
        and all(type(each) in (int, float) and 0 <= each <= MOST for each in amounts)
        and all(isinstance(text, str) for text in texts)
        and (not isinstance(outcome, ChatError) or outcome.kind in KINDS)
    )


def _old_bill(value: Mapping[str, Any]) -> Bill:
    """Of an exchange that was recorded before all requests were booked: what is known of the last one."""
    told = Bill(1, value.get("tokens_in") or 0, value.get("tokens_out") or 0, value.get("money") or 0.0)
    return replace(told, requests=max(1, value.get("attempts", 1)), unpriced=int(value.get("money") is None))


@contextlib.contextmanager
def _alone(file: IO[bytes]) -> Iterator[None]:
    """Keep other processes from writing meanwhile, where the system can."""
    locked = lock(file, file.name, wait=True)
    try:
        yield
    finally:
        if locked:
            unlock(file)
