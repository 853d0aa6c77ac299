"""What the prompts' examples show: the form of an answer, and none of the rules that the tasks hide.

Compared is structure: commands and sentences are read by the forms of the skill table with any nouns in them, so that a
kiln cannot stand in for a sink; and prose by families of words, so that a shut drawer cannot stand in for a door.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator

import pytest

from remac_agents.prompting.prompt import load, names
from remac_env.rules.predicates import PREDICATES
from remac_env.rules.skills import SKILLS

TOLD = ("not_at_station", "hands_full", "hands_empty", "already_done", "station_occupied")
"""Reasons of requirements that a command's own words say, or that the kitchen's text tells."""

HIDDEN = {
    (skill.name, requirement.condition.predicate)
    for skill in SKILLS.values()
    for requirement in skill.requires("r", "t")
    if requirement.mark != "refuse" or requirement.reason not in TOLD
}
"""(skill, predicate) of what has to be found out: a shut door, a vessel that is needed, a hand that must be empty."""

PROSE = {
    "accessible": r"\b(?:door|doors|drawer|hatch|shut|closed|latched|locked|opened|ajar)\b",
    "no_vessel_needed": r"\b(?:vessel|container|bowl|pot|pan|tray|jar|tin|bucket|dish|plate|wrapped)\b",
    "hand_empty": r"\b(?:full|free|both) hands?\b|\bput (?:it |that )?down\b|\bhands? (?:is |are )?full",
    "room": r"\b(?:room for|no space|too big|overfull|occupied)\b",
    "may_run": r"\bruns? only\b|\bwill not (?:run|start)\b",
}
"""Predicate -> words with which prose speaks of it."""

WORKED = ("open door", "close door", "turn on", "turn off")


def by_form(text: str, forms: dict[str, str]) -> str | None:
    """The name of the form that a text has, whatever its nouns; the longest form first."""
    for name, form in sorted(forms.items(), key=lambda item: -len(re.sub(r"\{\d*\}", "", item[1]))):
        if re.fullmatch(re.sub(r"\\\{\d*\\\}", "(.+)", re.escape(form)), text.strip()):
            return name
    return None


def step(text: str) -> tuple[str, str] | None:
    """(skill, noun) of a command, or None for words that are none."""
    for name, skill in sorted(SKILLS.items(), key=lambda item: "{}" in item[1].form):
        if match := re.fullmatch(re.escape(skill.form).replace(r"\{\}", "(?P<noun>.+)"), text.strip()):
            return name, match.groupdict().get("noun", "")
    return None


def rows(text: str) -> Iterator[list[tuple[str, str]]]:
    """Every row of commands: lists in brackets, and the commands quoted in one line, in their order."""
    for line in text.replace('\\"', "'").splitlines():
        for found in (
            *(part.split(",") for part in re.findall(r"\[([^\[\]{}]*)\]", line)),
            [text for _, text in re.findall(r"(['\"])([a-z_ ]+)\1", line)],
        ):
            yield [read for part in found if (read := step(part.strip(" '\""))) is not None]


def told_by_plan(row: list[tuple[str, str]]) -> Iterator[tuple[str, str]]:
    """The hidden rules that a row of commands follows."""
    opened = {noun for skill, noun in row if skill == "open door"}
    carried = {noun for skill, noun in row if skill == "pick up"}
    for index, (skill, noun) in enumerate(row):
        before, after = row[:index], row[index + 1 :]
        if skill in ("place to", "season") and noun in opened:
            yield skill, "accessible"
        if skill == "pick up" and any(done == "open door" for done, _ in before):
            yield skill, "accessible"
        if skill == "place to" and noun in carried:
            yield skill, "no_vessel_needed"
        if skill in WORKED and any(done == "pick up" for done, _ in after):
            yield skill, "hand_empty"
        if skill == "turn on" and any(done == ("close door", noun) for done in before):
            yield skill, "may_run"


def examples(text: str) -> Iterator[tuple[str, list[str]]]:
    """(command, sentences) of every example of pre-conditions."""
    for command, answer in re.findall(r'is to run "([^"\n]+)"[^\n]*:\n(\{.*\})', text):
        yield command, json.loads(answer).get("conditions", [])
    for command, untrue in re.findall(r'is to run "([^"\n]+)"[^\n]*not true: (.+)', text):
        yield command, untrue.split("; ")


def told_by_conditions(text: str) -> Iterator[tuple[str, str]]:
    """(skill, predicate) of every example whose command a skill has, nouns aside."""
    forms = {name: row.sentence for name, row in PREDICATES.items()}
    for command, sentences in examples(text):
        if (read := step(command)) is not None:
            yield from ((read[0], str(by_form(sentence, forms))) for sentence in sentences)


def given_away(text: str) -> set[tuple[str, str]]:
    """The hidden rules that a prompt's text gives away; ("", predicate) where prose does."""
    found = {pair for pair in told_by_conditions(text) if pair in HIDDEN}
    found |= {pair for row in rows(text) for pair in told_by_plan(row)}
    return found | {("", name) for name, words in PROSE.items() if re.search(words, text, re.I)}


@pytest.mark.parametrize("name", names())
def test_no_example_gives_a_hidden_rule_away(name: str) -> None:
    assert given_away(load(name).system) == set()


def test_the_hidden_rules_come_from_the_table() -> None:
    assert {("place to", "no_vessel_needed"), ("place to", "accessible"), ("pick up", "accessible")} <= HIDDEN
    assert {("turn on", "may_run"), ("open door", "hand_empty"), ("pick up", "unloaded")} <= HIDDEN
    assert not {("pick up", "at"), ("pick up", "hand_empty"), ("place to", "hand_full")} & HIDDEN


def before(command: str, sentence: str) -> str:
    return f'robot_a is to run "{command}", its gripper holds nothing:\n{json.dumps({"conditions": [sentence]})}'


PLANTED = {
    before("place to kiln", "no shut door is in front of the kiln"): ("place to", "accessible"),
    before("pick up wrench", "no shut door is in front of the wrench"): ("pick up", "accessible"),
    before("place to kiln", "what robot_a holds may touch the kiln without a vessel"): ("place to", "no_vessel_needed"),
    before("place to kiln", "the kiln has room for what robot_a holds"): ("place to", "room"),
    before("open locker door", "the gripper of robot_b is empty"): ("open door", "hand_empty"),
    before("turn on lamp", "the gripper of robot_b is empty"): ("turn on", "hand_empty"),
    before("pick up crate", "nothing lies on or in the crate"): ("pick up", "unloaded"),
    before("turn on lathe", "nothing keeps the lathe from running"): ("turn on", "may_run"),
    'robot_b is to run "turn on lathe"; not true: nothing keeps the lathe from running': ("turn on", "may_run"),
    "Plan: [navigate to locker, open locker door, place to locker]": ("place to", "accessible"),
    '{"plan": ["open chest door", "navigate to cap", "pick up cap"]}': ("pick up", "accessible"),
    "Plan: [pick up clay, place to mould, pick up mould, place to kiln]": ("place to", "no_vessel_needed"),
    "robot_a: [turn on lamp, navigate to wrench, pick up wrench]": ("turn on", "hand_empty"),
    "Plan: [close lathe door, turn on lathe]": ("turn on", "may_run"),
    json.dumps({"avoid": 'do "turn on lamp" before "pick up wrench"'}): ("turn on", "hand_empty"),
    '{"reason": "the drawer was still shut when the wrench was to go in", "step": 4}': ("", "accessible"),
    '{"reason": "a robot with a full hand cannot pull a cord"}': ("", "hand_empty"),
    '{"reason": "clay goes into the kiln in a tray only"}': ("", "no_vessel_needed"),
    '{"reason": "the chest was occupied"}': ("", "room"),
}
"""Text -> a rule that it gives away; the first, second, third and tenth once stood in the prompts."""


@pytest.mark.parametrize("text", PLANTED, ids=range(len(PLANTED)))
def test_an_example_that_gives_one_away_is_found(text: str) -> None:
    assert PLANTED[text] in given_away(text)


def test_examples_of_conditions_do_not_go_through_the_table() -> None:
    shown = {read[0] for command, _ in examples(load("conditions_before").system) if (read := step(command))}
    assert shown == {"pick up", "navigate to"}
