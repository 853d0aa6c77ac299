"""Telling someone's wish to stop the run from an exception that an agent raised to look like one."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from remac_bench.errors import JobTimeoutError

SIGNALS = (signal.SIGINT, signal.SIGTERM)
"""Ctrl-C, and what batch systems send."""


class Stopped(KeyboardInterrupt):
    """The run is to stop: somebody says so from outside."""


@contextmanager
def stoppable(*signals: signal.Signals) -> Iterator[None]:
    """Let these signals raise Stopped, once: from then on more of them are ignored until the block is left, so that
    what is under way can be ended. Nothing outside the main thread, which alone may set handlers."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.signal(number, _stop) for number in signals}
    try:
        yield
    finally:
        for number, handler in before.items():
            stopping = handler is _stop and signal.getsignal(number) is signal.SIG_IGN
            if not stopping:  # a block around this one ends that
                signal.signal(number, handler)


@contextmanager
def alarm(seconds: float) -> Iterator[None]:
    """Raise JobTimeoutError in the main thread when the time is up, once; nothing happens where there are no alarms.

    For jobs that are played in this process: what hangs in native code is not ended by it.
    """
    if threading.current_thread() is not threading.main_thread() or not hasattr(signal, "setitimer"):
        yield
        return

    def ring(number: int, frame: FrameType | None) -> None:
        raise JobTimeoutError(seconds)

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def is_stop(error: BaseException) -> bool:
    """Whether an exception is the wish to stop.

    A bare KeyboardInterrupt is, where Python's own handler may have raised it: in the main thread of a process that
    nobody made `stoppable`. Elsewhere only an agent raises it.
    """
    if isinstance(error, Stopped):
        return True
    if not isinstance(error, KeyboardInterrupt) or threading.current_thread() is not threading.main_thread():
        return False
    return signal.getsignal(signal.SIGINT) not in (signal.SIG_IGN, _stop)


def _stop(number: int, frame: FrameType | None) -> None:
    for each in SIGNALS:
        if signal.getsignal(each) is _stop:
            signal.signal(each, signal.SIG_IGN)
    raise Stopped
