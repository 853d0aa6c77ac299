"""Keys and text from outside, made fit for logs, terminals, records and file names."""

from __future__ import annotations

import base64
import hashlib
import json
import re
import unicodedata
from collections.abc import Iterable
from typing import Any
from urllib.parse import quote

BLOT = "[key]"
SHORTEST_KEY = 8
"""Shorter keys are placeholders such as "none"; blotting them out would mangle ordinary text."""

_LOOKS_LIKE_KEY = re.compile(r"\b(?:sk|xai|gsk|hf|pk)[-_][A-Za-z0-9_\-]{16,}|(?<=Bearer )[A-Za-z0-9._~+/=\-]{8,}")
_ESCAPE = re.compile(r"\x1b(?:\[[0-?]*[ -/]*[@-~]|[\]PX^_].*?(?:\x07|\x1b\\|$)|[@-Z\\-_])", re.DOTALL)
_RESERVED = re.compile(r"^(con|prn|aux|nul|com\d|lpt\d)$", re.I)


class Redactor:
    """Blots keys out of text, in the forms in which they travel."""

    def __init__(self, keys: Iterable[str] = ()) -> None:
        """Args: keys: the secrets; empty and very short ones are ignored."""
        self._forms = sorted({form for key in keys if len(key) >= SHORTEST_KEY for form in _forms(key)}, key=len)[::-1]

    def __repr__(self) -> str:
        return "Redactor(...)"

    def text(self, text: str) -> str:
        """The text without the keys, and without anything else that looks like one."""
        return _LOOKS_LIKE_KEY.sub(BLOT, self.exact(text))

    def exact(self, text: str) -> str:
        """The text without the keys; all else as it was."""
        for form in self._forms:
            text = text.replace(form, BLOT)
        return text

    def sound(self, text: str) -> str:
        """The text without the keys, fit to be encoded: halves of a surrogate pair, which JSON can carry, are put
        together where both came, one in each piece of a stream perhaps; one alone is no text."""
        whole = text.encode("utf-16-le", "surrogatepass").decode("utf-16-le", "surrogatepass")
        return self.exact(whole.encode("utf-8", "replace").decode("utf-8"))

    def value(self, value: Any) -> Any:
        """The same for every text in lists and mappings, names of fields included."""
        if isinstance(value, str):
            return self.exact(value)
        if isinstance(value, dict):
            return {self.exact(str(name)): self.value(item) for name, item in value.items()}
        if isinstance(value, (list, tuple)):
            return [self.value(item) for item in value]
        return value


def _forms(key: str) -> set[str]:
    encoded = base64.b64encode(key.encode()).decode()
    return {key, quote(key, safe=""), json.dumps(key)[1:-1], encoded, encoded.rstrip("=")}


def plain(text: str, *, limit: int = 500) -> str:
    """Text from outside as one line for people: no terminal sequences, control or direction marks; cut at `limit`."""
    # Cut generously first: what is thrown away need not be searched.
    text = _ESCAPE.sub("", text[: 8 * limit])
    shown = "".join(" " if char in "\r\n\t" else char for char in text)
    shown = "".join(char for char in shown if unicodedata.category(char) not in ("Cc", "Cf", "Cs", "Co", "Zl", "Zp"))
    shown = re.sub(r" {2,}", " ", shown).strip()
    return shown if len(shown) <= limit else shown[: limit - 1] + "…"


def file_name(name: str, *, longest: int = 60) -> str:
    """A harmless file name for any text: letters, digits, `-` and `_`, and a digest, so that names stay apart."""
    slug = re.sub(r"[^A-Za-z0-9_-]+", "-", name).strip("-")[:longest] or "unnamed"
    if _RESERVED.match(slug):
        slug += "-"
    return f"{slug}-{hashlib.sha256(name.encode('utf-8', 'surrogatepass')).hexdigest()[:10]}"
