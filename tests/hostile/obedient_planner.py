"""A planner as it must not be: it runs what it is told. It shows that the audit sees such things."""

from __future__ import annotations

import contextlib
import os
from typing import Any


def plan(request: Any) -> list[str]:
    """Execute the answer."""
    text = os.environ.get("REMAC_TESTS_ANSWER", "")
    with contextlib.suppress(BaseException):  # most answers are no Python
        eval(text)  # noqa: S307 - the planted fault
    return []
