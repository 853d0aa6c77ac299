"""Reasoning that comes with an answer, in each known form; endings of answers; marks before them."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from chaos_server import DONE, chunk, completion, says, sends, streams
from llm_kit import Kit, open_kit

from remac_agents.llm.judging import FILTERED, LENGTHS, STOPS, TOOLS
from remac_agents.plan import Commands, Plan, read_plan
from remac_agents.text.thoughts import split_reasoning

COMMANDS = Commands(["wait", "done", "navigate to red box", "pick up cup", "open red box door"])
WRONG = "Plan: [open red box door, pick up cup]"
RIGHT = "Plan: [navigate to red box, pick up cup]"
MUSED = f"Maybe {WRONG}? No, the box is open."

FORMS = {
    "think": f"<think>{MUSED}</think>{RIGHT}",
    "think, unopened": f"{MUSED}\n</think>\n\n{RIGHT}",
    "thinking": f"<thinking>\n{MUSED}\n</thinking>\n{RIGHT}",
    "thought": f"<thought>{MUSED}</thought>{RIGHT}",
    "reasoning": f"<reasoning>{MUSED}</reasoning>{RIGHT}",
    "analysis": f"<analysis>{MUSED}</analysis>{RIGHT}",
    "chain": f"<chain_of_thought>{MUSED}</chain_of_thought>{RIGHT}",
    "content": f"<reasoning_content>{MUSED}</reasoning_content>{RIGHT}",
    "monologue": f"<inner_monologue>{MUSED}</inner_monologue>{RIGHT}",
    "all words left": f"assistantanalysis{MUSED}assistantfinal{RIGHT}",
    "prefix": f"<seed:think>{MUSED}</seed:think>{RIGHT}",
    "attributes": f'<think effort="high">{MUSED}</think >{RIGHT}',
    "answer tags": f"<think>{MUSED}</think>\n<answer>{RIGHT}</answer>",
    "brackets": f"[THINK]{MUSED}[/THINK]{RIGHT}",
    "brackets, unopened": f"{MUSED}[/THINK]{RIGHT}",
    "triangles": f"◁think▷{MUSED}◁/think▷{RIGHT}",
    "begin and end": f"<|begin_of_thought|>{MUSED}<|end_of_thought|>\n<|begin_of_solution|>{RIGHT}<|end_of_solution|>",
    "start and end": f"<|START_THINKING|>{MUSED}<|END_THINKING|><|START_RESPONSE|>{RIGHT}<|END_RESPONSE|>",
    "pipes": f"<|think|>{MUSED}<|/think|>{RIGHT}",
    "channels": (
        f"<|channel|>analysis<|message|>{MUSED}<|end|><|start|>assistant<|channel|>final<|message|>{RIGHT}<|return|>"
    ),
    "channels, commentary": (
        f"<|start|>assistant<|channel|>analysis<|message|>{MUSED}<|end|><|start|>assistant<|channel|>commentary"
        f"<|message|>I plan.<|end|><|start|>assistant<|channel|>final <|constrain|>json<|message|>{RIGHT}"
    ),
    "channels, first marker lost": f"{MUSED}<|end|><|start|>assistant<|channel|>final<|message|>{RIGHT}",
    "channels without markers": f"analysis{MUSED}assistantfinal{RIGHT}",
    "channels as words": f"analysis\n{MUSED}\nassistant\nfinal\n{RIGHT}",
    "channels, more of them": f"analysis{MUSED}assistantcommentaryI plan.assistantfinal{RIGHT}",
    "final alone": f"assistantfinal{RIGHT}",
    "gemma": f"<|channel>thought\n{MUSED}\n<channel|>{RIGHT}",
    "ollama": f"Thinking...\n{MUSED}\n...done thinking.\n\n{RIGHT}",
    "granite": f"Here is my thought process:\n{MUSED}\nHere is my response:\n{RIGHT}",
    "apriel": f"Here are my reasoning steps:\n{MUSED}\n[BEGIN FINAL RESPONSE]\n{RIGHT}\n[END FINAL RESPONSE]",
    "unused": f"<unused94>thought\n{MUSED}<unused95>{RIGHT}",
    "details": f'<details type="reasoning" done="true"><summary>3 s</summary>{MUSED}</details>\n{RIGHT}',
    "fence": f"```thinking\n{MUSED}\n```\n{RIGHT}",
    "scratch pad": f"<scratch_pad>{MUSED}</scratch_pad>{RIGHT}",
    "escaped": f"&lt;think&gt;{MUSED}&lt;/think&gt;\n{RIGHT}",
    "opened twice": f"<think>\n<think>{MUSED}</think>{RIGHT}",
    "speaks of a tag": f"<think>{MUSED} I must close <think> soon. And <think>?</think>{RIGHT}",
    "twice": f"<think>{MUSED}</think>Well.<think>{MUSED}</think>\n{RIGHT}",
    "nested": f"<think>{MUSED}<think>{MUSED}</think></think>{RIGHT}",
    "mark before": f"\ufeff<think>{MUSED}</think>{RIGHT}",
}
UNFINISHED = [
    f"<think>{MUSED} {RIGHT}",
    f"[THINK]{MUSED} {RIGHT}",
    f"<think>{MUSED}</think><think>{MUSED} {RIGHT}",
    f"&lt;think&gt;{MUSED} {RIGHT}",
    f"◁think▷{MUSED} {RIGHT}",
    f"<|channel|>analysis<|message|>{MUSED} {RIGHT}",
    f"analysis{MUSED} {RIGHT}",
    f"<|START_THINKING|>{MUSED} {RIGHT}",
]
"""Thoughts that never end: whatever stands in them is no answer."""


@pytest.fixture
def kit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Kit]:
    with open_kit(tmp_path, monkeypatch) as kit:
        yield kit


def plan_of(text: str) -> Any:
    return read_plan(text, COMMANDS, ("robot_0",), "robot_0")


def test_the_right_plan_is_another_one() -> None:
    assert isinstance(plan_of(RIGHT), Plan) and plan_of(RIGHT) != plan_of(WRONG)
    assert not isinstance(plan_of(f"{MUSED}\n{RIGHT}"), Plan), "without a form, the text holds two plans"


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("stream", [True, False])
def test_reasoning_is_cut_off_and_kept(form: str, stream: bool, kit: Kit) -> None:
    text = FORMS[form]
    pieces = [chunk(text[i : i + 7]) for i in range(0, len(text), 7)]
    act = streams(*pieces, chunk("", finish="stop"), DONE) if stream else says(text)
    reply = kit.reply(act, stream=stream)
    assert plan_of(reply.text) == plan_of(RIGHT), reply.text
    assert ("Maybe" in reply.reasoning) == ("Maybe" in text) and "Maybe" not in reply.text
    assert plan_of(text) == plan_of(RIGHT), "planners of one's own may pass such texts on"


@pytest.mark.parametrize("text", UNFINISHED)
def test_thoughts_that_never_end_are_no_answer(text: str, kit: Kit) -> None:
    error = kit.error(says(text))
    assert (error.kind, error.attempts) == ("empty", 3)
    assert not isinstance(plan_of(text), Plan)


@pytest.mark.parametrize(
    "text",
    [
        "Analysis: the door is shut.\nPlan: [wait]",
        "analysis of the plan: [wait]",
        "final answer: [wait]",
        "I think: [wait]",
        "a <thinker> and [thinking cap]",
    ],
)
def test_words_that_are_no_marks_stay(text: str) -> None:
    assert split_reasoning(text) == (text, "")


def parts(*given: dict[str, Any]) -> bytes:
    return json.dumps(completion(list(given))).encode()  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "message",
    [
        {"content": "yes", "reasoning": "because"},
        {"content": "yes", "reasoning_content": "because"},
        {"content": "yes", "thinking": "because"},
        {"content": "yes", "reasoning_details": [{"type": "reasoning.text", "text": "be"}, {"text": "cause"}]},
        {"content": "yes", "reasoning_details": [{"type": "reasoning.summary", "summary": "because"}, {"data": "x"}]},
        {"content": "yes", "reasoning": "because", "reasoning_details": [{"text": "because"}]},
        {"content": "yes", "reasoning": {"content": "because"}},
        {"content": [{"type": "thinking", "thinking": [{"type": "text", "text": "because"}]}, {"text": "yes"}]},
        {"content": [{"type": "reasoning", "summary": [{"text": "because"}]}, {"type": "text", "text": "yes"}]},
        {"content": "\ufeffyes", "reasoning": "because"},
    ],
)
def test_reasoning_in_fields_and_parts(message: dict[str, Any], kit: Kit) -> None:
    body = completion()
    body["choices"][0]["message"] = {"role": "assistant", **message}
    reply = kit.reply(sends(json.dumps(body).encode()))
    assert (reply.text, reply.reasoning) == ("yes", "because")
    streamed = kit.reply(streams(chunk(**message), chunk("", finish="stop"), DONE))
    assert (streamed.text, streamed.reasoning) == ("yes", "because")


@pytest.mark.parametrize("odd", [3, {"a": 1}, [3, None], True, [[[[[["deep"]]]]]]])
def test_odd_reasoning_spoils_no_answer(odd: Any, kit: Kit) -> None:
    assert kit.reply(says("yes", reasoning=odd)).text == "yes"
    assert kit.reply(says("yes", reasoning_details=odd)).text == "yes"


ENDINGS = [*((word, "") for word in sorted(STOPS)), *((word, "cut_short") for word in sorted(LENGTHS))]
ENDINGS += [*((word, "filtered") for word in sorted(FILTERED)), *((word, "tool_call") for word in sorted(TOOLS))]
ENDINGS += [(word, "") for word in ("STOP", "FINISH_REASON_STOP", "<|im_end|>", "End-Turn", " eos ")]
ENDINGS += [("MAX_TOKENS", "cut_short"), ("SAFETY", "filtered"), ("abort", "unfinished"), ("error", "unfinished")]
ENDINGS += [("insufficient_system_resource", "unfinished"), ("vanished", "unfinished")]


@pytest.mark.parametrize(("word", "kind"), ENDINGS)
def test_words_for_endings(word: str, kind: str, kit: Kit) -> None:
    for act in (says("yes", finish=word), streams(chunk("yes"), chunk("", finish=word), DONE)):
        outcome = kit.outcome(act)
        assert getattr(outcome, "kind", "") == kind, outcome


def test_an_ending_that_is_not_told(kit: Kit) -> None:
    for finish in (None, ""):
        whole = kit.reply(streams(chunk("yes"), chunk("", finish=finish), DONE))
        assert whole.text == "yes" and "ending_unknown" in whole.flags
        assert kit.error(streams(chunk("yes"), chunk("", finish=finish))).kind == "truncated"
        assert kit.error(streams(chunk(""), chunk("", finish=finish), DONE)).kind == "unfinished"
        assert kit.error(says("yes", finish=finish)).kind == "unfinished", "nothing says that it is whole"


def test_marks_before_bodies_answers_and_streams(kit: Kit) -> None:
    mark = b"\xef\xbb\xbf"
    assert kit.reply(sends(mark + json.dumps(completion("yes")).encode())).text == "yes"
    whole = [mark + chunk("ye"), chunk("s"), chunk("", finish="stop"), DONE]
    assert kit.reply(streams(*whole)).text == "yes"
    joined = b"".join(whole)
    assert kit.reply(streams(*[joined[i : i + 1] for i in range(len(joined))])).text == "yes"
    assert kit.reply(says('\ufeff{"a": 1}')).text == '{"a": 1}'
    error = kit.error(sends(mark + b'{"error": {"message": "what now", "type": "x"}}', status=400))
    assert error.detail.startswith("what now")
