"""A page of the documents carried out from top to bottom: files are made, servers serve, commands run, only smaller."""

from __future__ import annotations

import contextlib
import io
import json
import re
import runpy
import socket
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import httpx
from document_pages import ROOT, Block, DocumentError, words
from remac_bench.cli import app
from remac_bench.playing.suites import load, names
from typer.testing import CliRunner

from remac_agents.llm.provider_files import read_catalogue
from remac_agents.memory import Memory, Run
from remac_agents.wiring.catalogue import ROLES
from remac_env.plugins import BODIES, TASKS, group_of

KEYS = "REMAC_TEST_KEY"


@dataclass
class Play:
    """A page in a folder of its own.

    Attributes:
        folder: where everything happens; the working folder.
        model: address of a server that answers as a language model would.
        ran: the commands that were run.
    """

    folder: Path
    model: str
    ran: list[list[str]] = field(default_factory=list)
    served: dict[str, str] = field(default_factory=dict)
    children: list[subprocess.Popen[bytes]] = field(default_factory=list)

    def begin(self) -> None:
        """Put there what pages take for granted: the tests, a memory, records, providers at the model's address."""
        for name in ("tests", "examples"):
            (self.folder / name).symlink_to(ROOT / name)
        (self.folder / "docs").mkdir()
        for name in ("memory.jsonl", "other.jsonl"):
            Memory(self.folder / name).append(Run("HeatOnStove", "heat it", {}, [], [], [], True, [f"of {name}"]))
        catalogue = read_catalogue()
        tables = [
            f'[providers.{name}]\nbase_url = "{self.model}"\nkey = "{KEYS}"\nimages = false'
            for name in catalogue.providers
        ]
        # Without pictures, which take longer to draw than all the rest: who looks at them is tested elsewhere.
        tables += [
            f'[providers.{name}.models."{model}"]\nimages = false'
            for name, provider in catalogue.providers.items()
            for model in provider.models
        ]
        (self.folder / "loopback.toml").write_text("\n".join(tables) + "\n")

    def end(self) -> None:
        """End the servers."""
        for child in self.children:
            child.kill()
            child.wait()

    def block(self, block: Block, skipped: Callable[[str], bool]) -> None:
        """Carry out one block; `skipped` says which commands are only parsed.

        Raises:
            DocumentError: if it does not work.
        """
        if block.language == "python":
            self._python(block)
        elif block.language == "toml":
            self._toml(block)
        elif block.language == "json":
            (self.folder / "answers.json").write_text(json.dumps(json.loads(block.code)))
        for line in block.lines:
            if not skipped(line):
                self._run(line, block.where)

    def _python(self, block: Block) -> None:
        if block.file is None:
            code = re.sub(r"robots=2\)", 'robots=2, backend="symbolic")', block.code)
            with contextlib.redirect_stdout(io.StringIO()) as said:
                (self.folder / "page.py").write_text(code)  # alone, as it is copied
                runpy.run_path(str(self.folder / "page.py"), run_name="page")
            if block.prints is not None and said.getvalue().strip() != block.prints.strip():
                raise DocumentError(f"{block.where} prints\n{said.getvalue()}and not\n{block.prints}")
            return
        path = self.folder / block.file
        code = block.code
        if "HTTPServer((" not in code:
            path.write_text(code)
            return
        port = _free_port()
        address = f"http://127.0.0.1:{port}/plan"
        self.served["http://127.0.0.1:8000/plan"] = address
        self.served["http://127.0.0.1:8000/v1"] = f"http://127.0.0.1:{port}/v1"
        path.write_text(code.replace("8000", str(port)))
        self._serve(path, address, block.where)

    def _serve(self, path: Path, address: str, where: str) -> None:
        """Start a server of the page, and wait until it has answered a request or has ended."""
        child = subprocess.Popen([sys.executable, str(path)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        self.children.append(child)
        while True:
            with suppress(httpx.TransportError):
                httpx.post(address, json={"lead": "robot_0"}, trust_env=False).raise_for_status()
                return
            if child.poll() is not None:
                assert child.stderr is not None
                told = child.stderr.read().decode()[-300:]
                raise DocumentError(f"{where}: {path.name} ends ({child.returncode}) and serves nobody {told}")
            time.sleep(0.05)

    def _toml(self, block: Block) -> None:
        path = self.folder / "block.toml"
        path.write_text(block.code)
        told = tomllib.loads(block.code)
        if "project" in told:  # of a package: only what it says to us can be wrong
            assert set(told["project"]["entry-points"]) <= {TASKS, BODIES, *(group_of(role) for role in ROLES)}
        elif "providers" in told:
            read_catalogue(path)
        else:
            load(str(path))

    def _run(self, line: str, where: str) -> None:
        made = smaller(words(line)[1:] if line.startswith("remac") else ["bench", "run", *words(line)[2:]])
        for given, instead in self.served.items():
            made = [word.replace(given, instead) for word in made]
        made = [re.sub(r"http://127\.0\.0\.1:8000/v1", self.model, word) for word in made]
        if _asks(made) and "--providers" not in made:
            made += ["--providers", str(self.folder / "loopback.toml")]
        result = CliRunner().invoke(app, made, input="\n" * 200)
        self.ran.append(made)
        if result.exit_code not in ((0, 1) if made[0] == "doctor" else (0,)):
            why = result.exception if result.exception and not isinstance(result.exception, SystemExit) else ""
            raise DocumentError(f"{where}: {line}: exit code {result.exit_code}: {result.stderr[-800:]} {why!r}")


def smaller(made: list[str]) -> list[str]:
    """A command that does the same with one seed of one task, five rounds and two iterations.

    It is symbolic where it does not say physics.
    """
    made = list(made)
    if made[0] == "bench" and made[1] == "run":
        if "--suite" in made:
            suite = _take(made, "--suite")
            if suite not in names():
                raise DocumentError(f"there is no suite {suite!r}")
            made += [] if "--out" in made else ["--out", f"results/{suite}"]
            _set(made, "--methods", "BASE")
        _set(made, "--seeds", "0")
        _set(made, "--tasks", (_take(made, "--tasks") or "HeatOnStove").split(",")[0])
        methods = (_take(made, "--methods") or "BASE").split(",")
        _set(made, "--methods", ",".join(dict.fromkeys([methods[0], methods[-1]])))
        _set(made, "--max-rounds", "5")
        _set(made, "--iterations", "1")
        _set(made, "--image-size", "32")
        _set(made, "--jobs", "0")
        _set(made, "--backend", _take(made, "--backend") or "symbolic")
    elif made[0] == "experiment":
        _set(made, "--n", "1")
        _set(made, "--tasks", "HeatOnStove")
    elif made[:2] == ["bench", "verify"] and "--sample" in made:
        _set(made, "--sample", "1")
    return made


def _asks(made: list[str]) -> bool:
    """Whether a command may speak to a language model, so that it must be told of the one on loopback."""
    named = any(word.partition(":")[0] in read_catalogue().providers for word in made)
    return named or "--model" in made or made[0] == "doctor"


def _take(made: list[str], flag: str) -> str | None:
    """The value of a flag, which is removed; None where it is not there."""
    if flag not in made:
        return None
    at = made.index(flag)
    value = made[at + 1]
    del made[at : at + 2]
    return value


def _set(made: list[str], flag: str, value: str) -> None:
    _take(made, flag)
    made += [flag, value]


def _free_port() -> int:
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return int(found.getsockname()[1])
