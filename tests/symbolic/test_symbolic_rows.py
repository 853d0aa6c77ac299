"""Rows of the rules: each is whole and says all that is known of it, and one row is all that a new one takes."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from table_kitchen import A, B, TableKitchen

from remac_agents.adjusters.rule import REPAIRS, RuleAdjuster
from remac_agents.checkers.truth import TruthChecker
from remac_agents.conditions.rule import RuleConditions
from remac_agents.plan import Plan
from remac_agents.roles import AdjustRequest, View
from remac_env.errors import RemacError
from remac_env.oracle import solve
from remac_env.rules import paraphrases
from remac_env.rules.claims import settle_claims
from remac_env.rules.conditions import Condition, condition
from remac_env.rules.outcomes import failure
from remac_env.rules.predicates import PREDICATES, Predicate
from remac_env.rules.rounds import transition
from remac_env.rules.scene import public_scene
from remac_env.rules.sentences import predicate_of, read_condition, sentence_forms
from remac_env.rules.skill_row import Requirement, Skill
from remac_env.rules.skills import SKILLS, marks
from remac_env.rules.subtasks import Subtask
from remac_env.rules.tables import by_name
from remac_env.tasks.goals import Marked
from remac_env.vocabulary import Noun, Vocabulary, built_in

ROOT = Path(__file__).resolve().parents[2]

# -- a row for each of what is new ----------------------------------------------------------------------------------

PEELED = Predicate(
    name="peeled", about=("object",), sentence="the skin of the {0} is off", kind="ran", repair="achieve",
    test=lambda scene, world, name: "peeled" in world.objects[name].marks,
)  # fmt: skip


def _mark(mark: str) -> Callable[..., Any]:
    return lambda scene, world, robot, target: world.with_object(
        target, marks=world.objects[target].marks | {mark}
    )


def peel() -> Skill:
    return Skill(
        name="peel", form="peel {}", target="food", seconds=5.0, effect=_mark("peeled"),
        requires=lambda robot, target: (
            Requirement("refuse", condition("at", robot, target), "not_at_station"),
            Requirement("attempt", condition("hand_empty", robot), "dropped", drops=True),
        ),
        achieves=lambda robot, target, held: (condition("peeled", target),),
    )  # fmt: skip


def cut() -> Skill:
    return Skill(
        name="slice", form="slice {}", target="food", seconds=7.0, effect=_mark("sliced"), leaves="sliced",
        requires=lambda robot, target: (
            Requirement("refuse", condition("at", robot, target), "not_at_station"),
            Requirement("attempt", condition("peeled", target), "blocked"),
        ),
        achieves=lambda robot, target, held: (condition("marked", target, "sliced"),),
    )  # fmt: skip


COMMANDS = ("peel vegetable", "slice vegetable", "navigate to vegetable", "place to counter", "navigate to counter")


@pytest.fixture
def peeling(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setitem(PREDICATES, "peeled", PEELED)
    for skill in (peel(), cut()):
        monkeypatch.setitem(SKILLS, skill.name, skill)
    yield


@pytest.mark.usefixtures("peeling")
def test_a_new_row_has_a_sentence_that_is_read_back_and_tokens_at_the_end() -> None:
    kitchen = TableKitchen()
    stated = Condition("peeled", ("vegetable",))
    assert "the skin of the OBJECT is off" in sentence_forms()
    assert "the OBJECT has been sliced" in sentence_forms() and "sliced" in marks()
    assert read_condition("Skin of vegetable is off.", public_scene(kitchen.scene)) == stated
    assert predicate_of(stated.sentence) == "peeled" and stated.kind == "ran"
    further = Noun("vegetable", "object", ("peel", "slice"))
    words = Vocabulary((*built_in().entries, further), version=2)
    assert words.subtask(len(built_in())) == Subtask("peel", "vegetable") == words.parse("Peel vegetable")
    assert [words.decode(n) for n in range(len(built_in()))] == [built_in().decode(n) for n in range(len(built_in()))]
    longer = words.extended([Noun("gherkin", "object", ("pick up", "peel"))])
    assert [longer.decode(n) for n in range(len(words))] == [words.decode(n) for n in range(len(words))]
    assert "slice vegetable" in words.commands(kitchen.scene) and "peel gherkin" not in longer.legal(kitchen.scene)


@pytest.mark.usefixtures("peeling")
def test_a_new_row_is_checked_mended_and_run() -> None:
    kitchen = TableKitchen().stand(A, "counter_mid").hold(A, "bowl")
    subtask = Subtask("slice", "vegetable")

    def view() -> View:
        return View("slice it", public_scene(kitchen.scene), {A: "bowl", B: None},
                    rules=kitchen.scene, world=kitchen.world)  # fmt: skip

    before = RuleConditions().before(subtask, A, view())
    assert [c.predicate for c in before] == ["at", "peeled"]
    verdicts = TruthChecker().check(before, view())
    assert [verdict.value for verdict in verdicts] == [True, False]
    advice = RuleAdjuster().adjust(
        AdjustRequest(
            failed=(before[1],), subtask=subtask, robot=A, plan=Plan.of({A: [subtask]}), executed=(),
            commands=COMMANDS, view=view(), ask=lambda c: c.holds(kitchen.scene, kitchen.world),
        )
    )  # fmt: skip
    told = [step.text for step in advice.row or ()]
    # The hand is emptied, since peeling needs it empty; slicing does not need the bowl, but may.
    assert told[:3] == ["navigate to counter", "place to counter", "peel vegetable"] and told[-1] == "slice vegetable"
    assert advice.remedy == (Subtask("peel", "vegetable"),) and "the skin of the vegetable is off" in advice.reason
    for step in ("slice vegetable", "peel vegetable"):
        kitchen.world, outcomes = transition(
            kitchen.scene, kitchen.world, {A: Subtask(*step.split()), B: Subtask("wait")}
        )
        assert not outcomes[A].refused
    assert outcomes[A].reason == "dropped"


@pytest.mark.usefixtures("peeling")
def test_the_search_finds_the_way_through_new_rows() -> None:
    kitchen = TableKitchen()
    plan = solve(replace(kitchen.scene, robots=(A,)), kitchen.world, Marked("vegetable", "sliced"))
    assert plan is not None
    assert plan.as_text()[A] == ["navigate to vegetable", "peel vegetable", "slice vegetable"]


def test_without_its_rows_none_of_it_is_known() -> None:
    kitchen = TableKitchen()
    assert read_condition("the skin of the vegetable is off", public_scene(kitchen.scene)) is None
    assert solve(kitchen.scene, kitchen.world, Marked("vegetable", "sliced"), max_rounds=4) is None
    assert "sliced" not in marks() and "peel" not in SKILLS


# -- rows that are not whole ----------------------------------------------------------------------------------------

PREDICATE_FAULTS: dict[str, dict[str, Any]] = {
    "a sentence that leaves an argument out": {"sentence": "the skin is off"},
    "a sentence about more": {"sentence": "the skin of the {0} is off the {1}"},
    "an argument of no kind": {"about": ("spoon",)},
    "no argument": {"about": (), "sentence": "it is so"},
    "a kind of answer that there is not": {"kind": "heard"},
    "felt by nobody": {"kind": "felt"},
    "a feel of what is seen": {"kind": "seen", "feel": lambda shakers, held: True},
    "a name of two words": {"name": "is peeled"},
}
SKILL_FAULTS: dict[str, dict[str, Any]] = {
    "no place for its target": {"form": "peel"},
    "another first word": {"form": "skin {}"},
    "a target of no kind": {"target": "spoon"},
    "nothing that it changes": {"effect": None},
    "still, and with an effect": {"still": True},
    "less than no time": {"seconds": -1.0},
    "a relevance that there is not": {"relevant": "sometimes"},
    "an unknown predicate": {"achieves": lambda robot, target, held: (condition("skinned", target),)},
    "a predicate of other arguments": {"achieves": lambda robot, target, held: (condition("at", target),)},
}


@pytest.mark.parametrize("fault", [*PREDICATE_FAULTS, *SKILL_FAULTS])
@pytest.mark.usefixtures("peeling")
def test_a_row_that_is_not_whole_is_refused_when_it_is_loaded(fault: str) -> None:
    row: Predicate | Skill = PEELED if fault in PREDICATE_FAULTS else peel()
    with pytest.raises(RemacError, match=r"(?s)(predicate|skill) '.*valid:"):
        replace(row, **{**PREDICATE_FAULTS, **SKILL_FAULTS}[fault])


def test_two_rows_cannot_have_one_name_or_one_sentence() -> None:
    for kind, words, rows, other in (
        ("predicate", "sentence", (PEELED, PEELED), "two rows"),
        ("predicate", "sentence", (PEELED, replace(PEELED, name="skinned")), "one sentence"),
        ("skill", "form", (SKILLS["wait"], SKILLS["wait"]), "two rows"),
        ("skill", "form", (SKILLS["pick up"], replace(SKILLS["pick up"], name="pick")), "one form"),
    ):
        with pytest.raises(RemacError, match=other):
            by_name(kind, words, rows)  # type: ignore[arg-type]


# -- what rows say of one another -----------------------------------------------------------------------------------


def test_every_repair_that_a_row_names_is_one_that_the_adjuster_has() -> None:
    named = {row.repair for row in PREDICATES.values() if row.repair}
    assert named <= set(REPAIRS) and set(REPAIRS) - named <= {"achieve"}


def test_other_words_are_listed_for_predicates_that_there_are_and_with_their_arguments() -> None:
    for name, sentences in paraphrases.table().also.items():
        assert all(sentence.format(*PREDICATES[name].about) for sentence in sentences)


def test_what_denies_another_is_true_where_that_is_false_and_nowhere_else() -> None:
    kitchen = TableKitchen()
    scene, pairs = kitchen.scene, [(row, PREDICATES[row.denies]) for row in PREDICATES.values() if row.denies]
    assert len(pairs) == 4 and all(row.about == other.about and other.denies is None for row, other in pairs)
    for name, facts in scene.fixtures.items():
        doors = ("closed", "ajar", "open") if facts.door else (None,)
        for door, on in product(doors, (frozenset(), frozenset(facts.switches))):
            world = kitchen.world.with_fixture(name, door=door, on=on)
            for row, other in pairs:
                if facts.switches if row.about == ("switch",) else facts.door:
                    assert row.test(scene, world, name) is not other.test(scene, world, name), (row.name, world)


def test_a_skill_is_what_its_row_does() -> None:
    for name, skill in SKILLS.items():
        target = "" if skill.target == "none" else "x"
        stated = {c.predicate for c in skill.achieves("r", target, "held")}
        assert skill.takes == ("holding" in stated), name
        assert skill.puts == ("inside" in stated and "hand_empty" in stated), name
        assert skill.moves == bool({"at", "aside"} & stated), name
        assert bool(skill.leaves) == ("marked" in stated), name
        assert skill.still == (not stated), name
        undone = {r.condition.predicate for r in skill.requires("r", target) if r.reason == "already_done"}
        assert skill.lasting == bool(undone), name


def test_what_is_refused_says_so_and_nothing_else_does() -> None:
    kitchen, rng = TableKitchen(), np.random.default_rng(5)
    legal = [built_in().subtask(token) for token in built_in().legal(kitchen.scene).values()]
    seen = set()
    for _ in range(400):
        joint = {robot: legal[int(rng.integers(len(legal)))] for robot in (A, B)}
        refused, _ = settle_claims(kitchen.scene, kitchen.world, joint)
        world, outcomes = transition(kitchen.scene, kitchen.world, joint)
        for robot, outcome in outcomes.items():
            assert outcome.refused == (robot in refused)
            seen.add((outcome.status, outcome.refused))
        kitchen.world = world
    assert seen == {("success", False), ("failure", True), ("failure", False)}
    assert not failure("blocked").refused
    for skill, robot in product(SKILLS.values(), (A,)):
        for requirement in skill.requires(robot, "" if skill.target == "none" else "sink"):
            assert requirement.outcome.refused == (requirement.mark == "refuse")


# -- no second list -------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Listed:
    """Where several names of skills, or of predicates, stand in one display."""

    where: str
    names: frozenset[str]


def lists(source: str, where: str) -> Iterator[Listed]:
    """Every tuple, list, set and dict that names two skills or three predicates: what a row should say."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Tuple | ast.List | ast.Set):
            parts = node.elts
        elif isinstance(node, ast.Dict):
            parts = [key for key in node.keys if key is not None]
        else:
            continue
        found = {part.value for part in parts if isinstance(part, ast.Constant) and isinstance(part.value, str)}
        for known, least in ((SKILLS.keys() - {"done", "season"}, 2), (PREDICATES.keys(), 3)):
            if len(found & known) >= least:
                yield Listed(f"{where}:{node.lineno}", frozenset(found & known))


def test_no_module_keeps_a_list_of_skills_or_predicates_of_its_own() -> None:
    code = [path for package in ("remac_env", "remac_agents", "benchmarks/remac_bench")
            for path in sorted((ROOT / package).rglob("*.py"))]  # fmt: skip
    # dispatch.py is the table of motions, and checker_scenes.py that of what shows a condition in a picture;
    # some faults of plans happen to be called as predicates are.
    own = ("dispatch.py", "checker_scenes.py", "faults.py")
    code = [path for path in code if path.parent.name != "rules" and path.name not in own]
    found = [listed for path in code for listed in lists(path.read_text("utf-8"), str(path.relative_to(ROOT)))]
    assert not found


def test_a_planted_list_is_found() -> None:
    planted = 'LASTING = ("open door", "turn on")\nWORDS = {"at": 1, "room": 2, "placed": 3}\nFINE = ("open door", "x")'
    assert [len(listed.names) for listed in lists(planted, "planted")] == [2, 3]
