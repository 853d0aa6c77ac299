"""Reasoning apart from the answer, where a model writes both into one text."""

from __future__ import annotations

import re

_TAG = re.compile(r"<(/?)think(?:ing)?>", re.IGNORECASE)


def split_reasoning(text: str) -> tuple[str, str]:
    """Answer and reasoning of a text with `<think>` blocks.

    A block that is never closed runs to the end: what stands in it is no answer. A closing tag without an opening
    one ends a block that began with the text, for some servers put the opening tag into the prompt.
    """
    answer: list[str] = []
    thoughts: list[str] = []
    depth = 0
    start = 0
    for tag in _TAG.finditer(text):
        (thoughts if depth else answer).append(text[start : tag.start()])
        start = tag.end()
        if not tag.group(1):
            depth += 1
        elif depth:
            depth -= 1
        else:
            thoughts.extend(answer)
            answer = []
    (thoughts if depth else answer).append(text[start:])
    return "".join(answer).strip(), "\n".join(part.strip() for part in thoughts if part.strip())
