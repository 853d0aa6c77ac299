"""How long concurrent calls to a language model take against the ideal: `python benchmarks/calls.py`.

A server on this machine answers every request after a set time. The ideal is that time for each wave of calls; what is
above it is our own doing: the client, its limiter, the threads.
"""

from __future__ import annotations

import json
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import typer
from remac_bench.command import run_script
from remac_bench.flags import takes

from remac_agents.llm import ChatClient, ChatReply, Limiter

ANSWER = {
    "model": "m",
    "choices": [{"index": 0, "message": {"role": "assistant", "content": "yes"}, "finish_reason": "stop"}],
    "usage": {"prompt_tokens": 10, "completion_tokens": 5},
}


class _Server(ThreadingHTTPServer):
    request_queue_size = 1024  # all callers knock at once
    daemon_threads = True


def measure(*, calls: int, waves: int, latency: float) -> float:
    """Seconds that `waves` times `calls` calls take, `calls` of them at the same time.

    Raises:
        RuntimeError: if a call gets no answer.
    """
    server = _Server(("127.0.0.1", 0), _handler(latency))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    limiter = Limiter(start=calls, most=calls)
    address = f"http://127.0.0.1:{server.server_address[1]}/v1"
    with ChatClient("custom:m", base_url=address, limiter=limiter) as client, ThreadPoolExecutor(calls) as pool:
        question = [{"role": "user", "content": "?"}]
        began = time.perf_counter()
        replies = list(pool.map(lambda _: client.complete(question), range(calls * waves)))
        seconds = time.perf_counter() - began
    server.shutdown()
    if not all(isinstance(reply, ChatReply) for reply in replies):
        raise RuntimeError(f"calls without an answer: {[r for r in replies if not isinstance(r, ChatReply)][0]}")
    return seconds


def _handler(seconds: float) -> type[BaseHTTPRequestHandler]:
    class Handler(BaseHTTPRequestHandler):
        """Answers every question late, and the same."""

        def do_POST(self) -> None:
            self.rfile.read(int(self.headers["content-length"]))
            time.sleep(seconds)
            body = json.dumps(ANSWER).encode()
            self.send_response(200)
            self.send_header("content-type", "application/json")
            self.send_header("content-length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_: Any) -> None:
            """Say nothing."""

    return Handler


@takes("calls.calls", "calls.waves", "calls.latency")
def main(*, calls: int, waves: int, latency: float) -> None:
    """Print the wall time against the ideal."""
    seconds, ideal = measure(calls=calls, waves=waves, latency=latency), waves * latency
    typer.echo(
        f"{calls} calls at the same time, {waves} times, {latency:g} s each: {seconds:.3f} s, "
        f"{100 * (seconds / ideal - 1):.1f}% above the ideal of {ideal:g} s"
    )


if __name__ == "__main__":
    run_script(main)
