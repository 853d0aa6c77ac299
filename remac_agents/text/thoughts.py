"""Reasoning apart from the answer, where a model writes both into one text. The forms that are known:

    <think>...</think>           also thinking, thought, reasoning, analysis; <seed:think>, <chain_of_thought>
    [THINK]...[/THINK]           Magistral
    ◁think▷...◁/think▷           Kimi
    <|begin_of_thought|>...<|end_of_thought|>, <|START_THINKING|>...<|END_THINKING|>
    <|channel|>analysis<|message|>...<|end|><|start|>assistant<|channel|>final<|message|>...       gpt-oss
    analysis...assistantfinal... the same where the markers were left out on the way
    <|channel>thought...<channel|>      Gemma
    Thinking... ...done thinking.       Ollama
    Here is my thought process: ... Here is my response:                     Granite
    Here are my reasoning steps: ... [BEGIN FINAL RESPONSE]                  Apriel
    <unused94>thought ... <unused95>    MedGemma
    <details type="reasoning">...</details>, ```thinking ... ```             chat front ends
    &lt;think&gt;...&lt;/think&gt;      any tag, where a gateway made HTML of it
What surrounds an answer alone, such as <answer>...</answer>, is taken off.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

_WORDS = r"(?:think(?:ing)?|thoughts?|reason(?:ing)?|analysis|scratch_?pad|monologue|cot)"
_TAG = re.compile(
    rf"(?:<|&lt;)\s{{0,4}}(?P<a>/?)\s{{0,4}}(?:\w{{1,20}}[:_-])?{_WORDS}(?:_\w{{1,20}})?(?:\s[^<>&]{{0,80}})?:?(?:>|&gt;)"
    rf"|\[(?P<b>/?)(?:THINK(?:ING)?|REASONING)\]"
    rf"|[\u25c1\u25c0](?P<c>/?){_WORDS}[\u25b7\u25b6]"
    rf"|<\|(?P<d>/?){_WORDS}\|>"
    rf"|<\|(?:begin|start)_(?:of_)?{_WORDS}\|>"
    rf"|(?P<e><\|end_(?:of_)?{_WORDS}\|>)",
    re.IGNORECASE,
)
_AROUND = re.compile(
    r"</?(?:answer|response|final_answer|solution)>|\[(?:BEGIN|END) FINAL RESPONSE\]"
    r"|<\|(?:begin|start|end)_(?:of_)?(?:solution|answer|response|box)\|>",
    re.IGNORECASE,
)
_SEGMENT = re.compile(
    r"<\|channel\|>\s*(?P<channel>\w+)[^<]*(?:<\|constrain\|>[^<]*)?<\|message\|>"
    r"(?P<body>.*?)(?=<\|(?:end|return|call|start|channel)\|>|$)",
    re.DOTALL,
)
_MARK = re.compile(r"<\|(?:end|return|call|start|message|channel|constrain)\|>")
_BARE = re.compile(
    r"(?:assistant\s*)?(?:analysis|commentary)(?P<thoughts>.*)assistant\s*final(?P<answer>.*)", re.DOTALL
)
_BARE_ALONE = re.compile(r"(?:assistant)?(?:analysis|commentary)(?=[A-Z])")
_BARE_FINAL = re.compile(r"(?:assistant\s*final|final(?=[A-Z\[{]))")
_GEMMA = re.compile(
    r"<\|channel>\s*(?:thought|thinking|analysis)?(?P<thoughts>.*?)(?:<channel\|>|(?P<open>\Z))", re.DOTALL
)
_LEADS = re.compile(
    r"Thinking\.\.\.[ \t\r]*\n(?P<a>.*?)\.\.\.done thinking\."
    r"|Here(?:'s| is) my thought process:(?P<b>.*?)Here(?:'s| is) my response:"
    r"|Here are my reasoning steps:(?P<c>.*?)\[BEGIN FINAL RESPONSE\]"
    r"|<unused94>(?P<d>.*?)<unused95>"
    r"|<details\s[^<>]{0,80}reasoning[^<>]{0,80}>(?P<e>.*?)</details>"
    r"|```(?:think|thinking|thoughts?|reasoning)[ \t\r]*\n(?P<f>.*?)\n[ \t]*```",
    re.DOTALL,
)

FINAL = "final"


@dataclass(frozen=True)
class Split:
    """A text in parts. `unfinished`: it ends in the middle of its thoughts."""

    answer: tuple[str, ...]
    thoughts: tuple[str, ...]
    unfinished: bool = False


def split_reasoning(text: str) -> tuple[str, str]:
    """Answer and reasoning of a text."""
    found = split_thoughts(text)
    return "".join(found.answer).strip(), "\n".join(part.strip() for part in found.thoughts if part.strip())


def split_thoughts(text: str) -> Split:
    """The parts of a text that are answer, and those that are thoughts.

    Thoughts that are never closed run to the end: what stands in them is no answer. A closing tag without an opening
    one ends thoughts that began with the text, for some servers put the opening tag into the prompt.
    """
    text = text.lstrip("\ufeff").lstrip()
    found = _channels(text)
    if found is None:
        found = _tags(text)
    return Split(tuple(_AROUND.sub("", part) for part in found.answer), found.thoughts, found.unfinished)


def _tags(text: str) -> Split:
    answer: list[str] = []
    thoughts: list[str] = []
    depth = start = 0
    tags = list(_TAG.finditer(text))
    if tags and tags[0].start() == 0 and _closes(tags[-1]) and len(tags) > 2:
        opened = sum(not _closes(tag) for tag in tags)
        if opened > len(tags) - opened:  # one was put before it by the server, or the thoughts speak of one
            return Split((text[tags[-1].end() :],), (text[tags[0].end() : tags[-1].start()],))
    for tag in tags:
        (thoughts if depth else answer).append(text[start : tag.start()])
        start = tag.end()
        if not _closes(tag):
            depth += 1
        elif depth:
            depth -= 1
        else:
            thoughts.extend(answer)
            answer = []
    (thoughts if depth else answer).append(text[start:])
    return Split(tuple(answer), tuple(thoughts), depth > 0)


def _closes(tag: re.Match[str]) -> bool:
    return any(tag.group(name) for name in "abcde")


def _channels(text: str) -> Split | None:
    """A text in channels; None where it is in none."""
    if _MARK.search(text):
        return _marked(text)
    bare = _BARE.match(text)
    if bare is not None:
        return Split((bare["answer"],), (bare["thoughts"],))
    alone = _BARE_ALONE.match(text)
    if alone is not None:
        return Split((), (text[alone.end() :],), True)
    final = _BARE_FINAL.match(text)
    if final is not None:
        return Split((text[final.end() :],), ())
    gemma = _GEMMA.search(text)
    if gemma is not None:
        return Split((text[: gemma.start()], text[gemma.end() :]), (gemma["thoughts"],), gemma["open"] is not None)
    lead = _LEADS.match(text)
    return None if lead is None else Split((text[lead.end() :],), tuple(filter(None, lead.groups())))


def _marked(text: str) -> Split:
    """Channels with their markers. What stands before the first one belongs to a channel whose marker was cut off."""
    segments = list(_SEGMENT.finditer(text))
    first = segments[0].start() if segments else len(text)
    before = _MARK.sub("\n", re.sub(r"<\|start\|>\w*", "", text[:first])).strip()
    answer = [segment["body"] for segment in segments if segment["channel"] == FINAL]
    thoughts = [segment["body"] for segment in segments if segment["channel"] != FINAL]
    if not segments:
        return _tags(before)
    if answer:
        return Split(tuple(answer), (before, *thoughts))
    return Split((), (before, *thoughts), True)
