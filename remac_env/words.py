"""The plain form of what is said: how two ways of writing one command or sentence are found equal."""

from __future__ import annotations

import re


def normalise(text: str) -> str:
    """Lower case, single spaces, underscores as spaces, without quotes or a stop at the ends."""
    return re.sub(r"[\s_]+", " ", text).strip(" \t\r\n\"'`.,;").lower()
