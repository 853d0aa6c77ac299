"""Text of errors made fit for records, which people pass on: no key, and no folder of this machine."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

SECRET_NAMES = re.compile(r"(^|_)(KEY|TOKEN|SECRET|PASSWORD|PASSWD|CREDENTIALS?)(_|$)", re.IGNORECASE)
"""Names of environment variables whose values are secrets."""

SHORTEST_SECRET = 8
"""Characters. Shorter values are placeholders such as "none"; blotting them out would mangle ordinary text."""

BLOT = "<key>"

_LONG_WORD = re.compile(r"(?<![\w/.-])[A-Za-z0-9_\-]{32,}(?![\w/-])")
_PATH = re.compile(r"(?<![\w:/.<>~])/(?:[^\s/'\"`:;,<>()\[\]{}|]+/)+(?=[^\s/'\"`:;,<>()\[\]{}|])")


def redact(text: str) -> str:
    """The text with secrets of the environment as <NAME>, what looks like a key as <key>, and paths cut to names.

    What no file takes (halves of surrogate pairs) is shown as escapes. A path with at least one folder keeps its
    last part; addresses (http://host/...) stay as they are.
    """
    from remac_agents.llm.redaction import Redactor  # only here: episodes without errors need no client
    from remac_agents.text.printable import printable

    secrets = {
        value: name for name, value in os.environ.items() if len(value) >= SHORTEST_SECRET and SECRET_NAMES.search(name)
    }
    for value in sorted(secrets, key=len, reverse=True):
        text = text.replace(value, f"<{secrets[value]}>")
    text = Redactor().text(text).replace("[key]", BLOT)
    text = _LONG_WORD.sub(lambda found: BLOT if _is_random(found[0]) else found[0], text)
    home = _home()
    if len(home) > 1:
        text = text.replace(home + os.sep, "~/").replace(home, "~")
    text = printable(text)
    return _PATH.sub("", re.sub(r"~/(?:[^\s/'\"`]+/)*(?=[^\s/'\"`])", "", text))


def printable_values(value: Any) -> Any:
    """Plain values with every text in them made printable."""
    from remac_agents.text.printable import printable

    if isinstance(value, str):
        return printable(value)
    if isinstance(value, dict):
        return {printable_values(key): printable_values(part) for key, part in value.items()}
    return [printable_values(part) for part in value] if isinstance(value, list | tuple) else value


def _home() -> str:
    """This user's folder; "" for a user without one, as in a container that knows its number alone."""
    try:
        return str(Path.home())
    except RuntimeError:
        return ""


def _is_random(word: str) -> bool:
    """Whether a long word mixes digits and letters as keys do and names do not."""
    digits = sum(char.isdigit() for char in word)
    return 4 <= digits < len(word) or (word.lower() != word and word.upper() != word and digits > 1)
