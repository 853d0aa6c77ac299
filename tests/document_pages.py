"""Documents as what they tell a reader to type: commands, Python, files."""

from __future__ import annotations

import contextlib
import importlib.util
import io
import re
import shlex
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import typer
from remac_bench.cli import app
from remac_bench.command import Command

ROOT = Path(__file__).parent.parent
PAGES = sorted(
    str(path.relative_to(ROOT))
    for folder in (".", "docs", "docs/tutorials", "benchmarks")
    for path in (ROOT / folder).glob("*.md")
)
SHELL = ("sh", "bash", "console", "")
PROGRAMS = ("remac", "python", "make", "pip")
STANDS_FOR = {
    "DIR": "records", "FILE": "memory.jsonl", "OTHER": "other.jsonl", "N": "5", "P": "0.1", "T": "HeatOnStove",
    "S": "0", "RUN": "0", "NAME": "openai:o3",
}  # fmt: skip
"""What a reader puts in place of a word in capitals."""


class DocumentError(AssertionError):
    """A document that tells its reader what does not work; the message names the place."""


class NoSubcommandError(DocumentError):
    """The name of a group of commands alone: a mention, where it stands in running text."""


@dataclass(frozen=True)
class Block:
    """Code of a document: its language ("" where none is named), and the page and line where it begins.

    `prints`: what a block of Python prints, where a block of text stands right under it.
    """

    language: str
    code: str
    where: str
    prints: str | None = None

    @property
    def file(self) -> str | None:
        """The name of the file that it is, which its first line says."""
        named = re.match(r"# (\w+\.py)\n", self.code)
        return named[1] if named else None

    @property
    def lines(self) -> list[str]:
        """Its commands, one a line, without remarks; none where it is no shell."""
        if self.language not in SHELL:
            return []
        joined = re.sub(r"\\\n\s*", "", self.code)
        return [line.strip() for line in joined.splitlines() if line.strip().split(" ")[0] in PROGRAMS]


def first(row: tuple[Any, ...]) -> Any:
    """By what rows are sorted."""
    return row[0]


def blocks(page: str, text: str | None = None) -> list[Block]:
    """The fenced blocks of a page, and its indented commands, in order."""
    text = (ROOT / page).read_text("utf-8") if text is None else text
    fenced = re.compile(r"^```(\w*)\n(.*?)^```(?=(?:\n\n```text\n(.*?)^```)?)", re.M | re.S)
    indented = re.compile(rf"(?<=\n\n)((?: {{4}}(?:{'|'.join(PROGRAMS)}) .*\n(?: {{8}}.*\n)*)+)")
    found = [(m.start(), m[1], m[2], m[3] if m[1] == "python" else None) for m in fenced.finditer(text)]
    inside = [range(match.start(), match.end()) for match in fenced.finditer(text)]
    for match in indented.finditer(text):
        if not any(match.start() in part for part in inside):
            found.append((match.start(), "", re.sub(r"^ {4}", "", match[1], flags=re.M), None))
    line = {at: text.count("\n", 0, at) + 1 for at, *_ in found}
    return [Block(name, code, f"{page}:{line[at]}", prints) for at, name, code, prints in sorted(found, key=first)]


def spans(page: str) -> Iterator[tuple[str, str]]:
    """Commands that stand in running text, and where."""
    text = (ROOT / page).read_text("utf-8")
    for match in re.finditer(r"`((?:remac|python) [^`\n]*)`", text):
        yield match[1], f"{page}:{text.count(chr(10), 0, match.start()) + 1}"


def words(line: str) -> list[str]:
    """A command as the shell reads it, with something in place of what a reader fills in."""
    plain = shlex.split(re.sub(r"\[(--)?", r"\1", line).replace("]", ""), comments=True)
    named = rf"\b({'|'.join(STANDS_FOR)})\b"
    return [re.sub(named, lambda match: STANDS_FOR[match[1]], word) for word in plain]


def resolve(line: list[str], where: str) -> tuple[Any, list[str]]:
    """The command that a line calls, as typer's, and its arguments.

    Raises:
        DocumentError: if there is none.
    """
    if line[0] == "remac":
        command, rest = typer.main.get_command(app), line[1:]
    elif line[0] == "python" and line[1].startswith("benchmarks/"):
        return _script(line, where)
    else:
        raise DocumentError(f"{where}: {shlex.join(line)} is neither a command of remac nor a script")
    while hasattr(command, "commands"):
        if not rest and command.invoke_without_command:
            break  # a group that does something by itself: remac tasks
        if not rest:
            raise NoSubcommandError(f"{where}: {shlex.join(line)}: which command?")
        if rest[0].startswith("--"):
            break  # an option of the command itself: remac --version
        if rest[0] not in command.commands:
            raise DocumentError(f"{where}: {shlex.join(line)}: no such command")
        command, rest = command.commands[rest[0]], rest[1:]
    return command, rest


def _script(line: list[str], where: str) -> tuple[Any, list[str]]:
    path = ROOT / line[1]
    if not path.is_file():
        raise DocumentError(f"{where}: there is no {line[1]}")
    if path.stem == "leaderboard":
        return resolve(["remac", "bench", "run", *line[2:]], where)
    made = typer.Typer(add_completion=False)
    made.command(cls=Command)(importlib.import_module(path.stem).main)
    return typer.main.get_command(made), line[2:]


def check_line(text: str, where: str) -> None:
    """Parse a command with the program's own parser, with all that it demands.

    Raises:
        DocumentError: if it would be refused.
    """
    if "[" in text and not text.startswith("pip "):
        raise DocumentError(f"{where}: {text}: brackets cannot be copied into a shell; write both commands")
    line = words(text)
    if line[0] == "make":
        targets = re.findall(r"^([\w-]+):", (ROOT / "Makefile").read_text("utf-8"), re.M)
        if line[1] not in targets:
            raise DocumentError(f"{where}: there is no target {line[1]!r}; there are {', '.join(targets)}")
        return
    if line[0] == "pip":
        extras = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["optional-dependencies"]
        strange = set(re.findall(r"remac-kitchen\[([^]]+)\]", text)) - set(extras)
        if strange:
            raise DocumentError(f"{where}: {text}: no such extra; there are {', '.join(extras)}")
        return
    if line[0] == "python" and not line[1].startswith("benchmarks/"):
        own = [block.file for block in blocks(where.partition(":")[0])] if line[1] == Path(line[1]).name else []
        if line[1] not in own and not (ROOT / line[1]).is_file():
            raise DocumentError(f"{where}: there is no {line[1]}")
        return
    command, rest = resolve(line, where)
    told = io.StringIO()
    try:
        with contextlib.redirect_stderr(told):
            command.make_context(command.name or "script", list(rest))
    except (typer.Exit, SystemExit) as end:
        raise DocumentError(f"{where}: {text}: {told.getvalue().strip()}") from end


def check_span(text: str, where: str) -> None:
    """The same for a command in running text, which may leave out what goes without saying.

    Raises:
        DocumentError: for a command or option that does not exist.
    """
    line = words(text)
    if line[1].startswith("docs/"):
        check_line(text, where)
        return
    if line[1] == "-m":
        if importlib.util.find_spec(f"{line[2]}.__main__") is None:
            raise DocumentError(f"{where}: {text}: {line[2]} cannot be run")
        return
    try:
        command, rest = resolve(line, where)
    except NoSubcommandError:
        return
    known = {flag for param in command.params for flag in (*param.opts, *param.secondary_opts)} | {"--help"}
    strange = [word for word in rest if word.startswith("-") and word.partition("=")[0] not in known]
    if strange:
        raise DocumentError(f"{where}: {text}: no such option: {strange[0]}")
