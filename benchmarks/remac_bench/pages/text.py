"""Text of records made harmless and visible: nothing in it can steer a page, a terminal or the order of reading."""

from __future__ import annotations

import hashlib
import re
import unicodedata
from typing import Any

from markupsafe import Markup

from remac_bench.entries import cut

_INVISIBLE = frozenset({"Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp"})
"""Unicode categories that are not to be seen: controls, bidi and format characters, surrogates, unassigned ones."""

_PICTURES = 0x2400
"""Where Unicode's pictures of the control characters begin."""


def visible(text: str) -> str:
    """The text with every character that cannot be seen replaced by its picture or number; line ends and tabs stay."""
    if text.isprintable():
        return text
    return "".join(map(_shown, text))


def _shown(character: str) -> str:
    if character in "\n\t" or unicodedata.category(character) not in _INVISIBLE:
        return character
    code = ord(character)
    if code < 0x20:
        return chr(_PICTURES + code)
    return "\u2421" if code == 0x7F else f"\u27e8U+{code:04X}\u27e9"


def shown(value: Any, limit: int) -> Any:
    """What a template puts on the page: markup of its own as it is, text visible and at most about `limit` long."""
    if value is None:
        return ""
    if isinstance(value, Markup) or not isinstance(value, str):
        return value
    return visible(cut(value, limit))


def slug(name: str) -> str:
    """A name for files and fragments: the name itself where that is safe, else a digest of it."""
    if re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}", name):
        return name
    return hashlib.sha256(name.encode("utf-8", "surrogatepass")).hexdigest()[:16]
