"""Plays every hostile answer under an audit hook and prints what was done that must not be, as JSON.

python hostile_run.py FOLDER OUTSIDE [obey] [one]: records go into FOLDER; OUTSIDE is a file that answers try to make.
With `one` the first method alone plays. With `obey` a planner that executes what it is told is played as well: then
there must be something to print.
"""

from __future__ import annotations

import contextlib
import json
import os
import sys
import threading
from collections.abc import Callable, Mapping, Sequence
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

from hostile_answers import corpus
from remac_bench.playing.agents import Access
from remac_bench.playing.job_lists import make_jobs
from remac_bench.playing.runner import Settings, run_jobs

TASK = "OpenMicrowavePnP"
METHODS = ("CC", "CAPE")
FORBIDDEN = (
    "subprocess.Popen", "os.system", "os.exec", "os.posix_spawn", "os.spawn", "os.fork", "os.forkpty", "os.putenv",
    "os.startfile", "os.kill", "ctypes.dlopen", "webbrowser.open", "pty.spawn", "shutil.rmtree", "socket.bind",
    "ftplib.connect", "smtplib.connect",
)  # fmt: skip
"""Audit events that no answer may bring about."""

WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND


class Watch:
    """Takes down forbidden audit events while `on`."""

    def __init__(self, folder: Path, port: int) -> None:
        self.folder, self.port, self.on = str(folder), port, False
        self.label = ""
        self.seen: list[str] = []

    def hook(self, event: str, arguments: tuple[Any, ...]) -> None:
        """What sys.addaudithook calls."""
        if self.on and self._bad(event, arguments):
            self.on = False
            self.seen.append(f"{self.label}: {event} {str(arguments)[:200]}")
            self.on = True

    def _bad(self, event: str, arguments: tuple[Any, ...]) -> bool:
        if event in ("exec", "compile"):
            # eval() and exec() of a text; what libraries parse, and code of files, has other names.
            return str(getattr(arguments[0], "co_filename", arguments[-1])) == "<string>"
        if event == "open":
            path, _, flags = arguments
            writes = isinstance(flags, int) and bool(flags & WRITING)
            return writes and isinstance(path, str | os.PathLike) and not os.path.abspath(path).startswith(self.folder)
        if event in ("os.rename", "os.remove", "os.mkdir", "os.link", "os.symlink", "os.truncate", "os.chmod"):
            path = arguments[0]  # a number names a file that was opened before
            return not isinstance(path, int) and not os.path.abspath(str(path)).startswith(self.folder)
        if event in ("socket.connect", "socket.getaddrinfo"):
            address = arguments[1] if event == "socket.connect" else arguments
            return not (isinstance(address, tuple) and address[:2] == ("127.0.0.1", self.port))
        return event in FORBIDDEN


class Answers(BaseHTTPRequestHandler):
    """Says the one thing it was told to say: raw to a planner's request, as a chat reply to a chat request."""

    text = ""

    def do_POST(self) -> None:
        """Answer any request."""
        self.rfile.read(int(self.headers["content-length"]))
        body = self.text.encode("utf-8", errors="surrogatepass")
        if self.path.endswith("/chat/completions"):
            choice = {"index": 0, "message": {"role": "assistant", "content": self.text}, "finish_reason": "stop"}
            body = json.dumps({"id": "1", "object": "chat.completion", "model": "m", "choices": [choice]}).encode()
        self.send_response(200)
        self.send_header("content-type", "application/json")
        self.send_header("content-length", str(len(body)))
        self.end_headers()
        with contextlib.suppress(OSError):  # the caller may have read enough
            self.wfile.write(body)

    def log_message(self, *_: object) -> None:
        """Say nothing."""


def main(folder: Path, outside: Path, *, obey: bool, methods: Sequence[str]) -> None:
    """Play everything and print the violations and how the episodes ended."""
    server = ThreadingHTTPServer(("127.0.0.1", 0), Answers)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    port = server.server_address[1]
    watch = Watch(folder, port)
    agents: dict[str, Mapping[str, Any]] = {
        "http": {"planner": f"http://127.0.0.1:{port}/plan"},
        "chat": {"model": "custom:m,images=false", "max_rounds": 6},
    }
    if obey:
        agents = {"obey": {"planner": f"{Path(__file__).with_name('obedient_planner.py')}:plan"}}
    access = Access(base_url=f"http://127.0.0.1:{port}/v1")
    plays = {name: _player(folder / name, agent, access, methods) for name, agent in agents.items()}
    for play in plays.values():
        play("warm up")  # what is imported on demand is in by then
    sys.addaudithook(watch.hook)
    for label, text in corpus(outside).items():
        Answers.text = text
        os.environ["REMAC_TESTS_ANSWER"] = text.replace("\x00", "")[:100_000].encode("utf-8", "replace").decode()
        for name, play in plays.items():
            watch.label, watch.on = f"{name}, {label}", True
            play(label)
            watch.on = False
    server.shutdown()
    sys.stdout.write(json.dumps({"seen": watch.seen, "ends": _ends(folder)}))


def _player(
    folder: Path, agent: Mapping[str, Any], access: Access, methods: Sequence[str]
) -> Callable[[str], None]:
    kitchen = {"backend": "symbolic", "max_rounds": 6}

    def play(label: str) -> None:
        reached = access if "model" in agent else Access(isolated=False)  # in sight of the hook
        jobs = make_jobs(tasks=[TASK], methods=methods, seeds=[0], kitchen=kitchen, agent=agent, access=reached)
        run_jobs(jobs, folder / label.replace(" ", "_"), Settings(workers=0))

    return play


def _ends(folder: Path) -> list[dict[str, Any]]:
    """What the records say of every episode."""
    found = []
    for path in sorted(folder.glob("*/*/records.jsonl")):
        for line in path.read_text("utf-8").splitlines():
            record = json.loads(line)
            kept = {name: record[name] for name in ("method", "success", "scored", "end", "rounds", "error")}
            found.append({"answer": "/".join(path.parts[-3:-1]), **kept})
    return found


if __name__ == "__main__":
    said = sys.argv[3:]
    played = METHODS[:1] if "one" in said else METHODS
    main(Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve(), obey="obey" in said, methods=played)
