"""How far a plan has come, as a value; and where robots stand as far as a plan says, which asking does not change."""

from __future__ import annotations

from agent_kitchens import suite_kitchen

from remac_agents.plan import Plan
from remac_agents.planning.whereabouts import Whereabouts
from remac_agents.running.round_state import RoundState
from remac_env.rules.scene import PublicScene, public_scene
from remac_env.rules.subtasks import WAIT, Subtask

OPEN, FETCH, WASH = Subtask("open door", "microwave"), Subtask("pick up", "bowl"), Subtask("turn on", "sink")
DRIVE = Subtask("navigate to", "sink")


def opened(**rows: list[Subtask]) -> RoundState:
    return RoundState().opened(Plan.of(rows))


def test_a_robot_that_is_through_waits_until_the_others_are() -> None:
    before = opened(a=[OPEN, FETCH], b=[FETCH])
    after = before.tried(worked={"a"}, slipped={"b"})
    assert before.turn == {"a": OPEN, "b": FETCH} and before.tries == 0, "a value does not change"
    assert after.turn == {"a": WAIT, "b": FETCH} and after.through == {"a": OPEN} and after.tries == 1
    assert after.slipped == {"b"} and after.tried(worked={"b"}, slipped=()).slipped == frozenset()
    assert after.opened(after.plan.rest()).turn == {"a": FETCH, "b": WAIT}


def test_a_robot_that_only_waited_is_still_one_that_slipped() -> None:
    slipped = opened(a=[OPEN], b=[FETCH, OPEN]).tried(worked={"b"}, slipped={"a"})
    waiting = slipped.opened(Plan.of({"a": [WAIT, OPEN], "b": [OPEN]}))
    assert waiting.tried(worked={"a", "b"}, slipped=()).slipped == {"a"}


def test_a_new_row_puts_what_was_done_behind() -> None:
    half = opened(a=[OPEN, FETCH], b=[FETCH]).tried(worked={"a"}, slipped={"b"})
    changed = half.with_row("b", [DRIVE, FETCH])
    assert changed.plan.as_text() == {"a": ("wait", "wait", FETCH.text), "b": (DRIVE.text, FETCH.text)}
    assert changed.pending == {"a", "b"} and changed.tries == 0


def test_what_is_accepted_holds_for_one_moment() -> None:
    state = opened(a=[OPEN]).accepting("a")
    assert state.accepted == {"a"} and state.at_next_moment().accepted == frozenset()


def test_others_go_on_past_drives_that_are_refused_and_past_nothing_else() -> None:
    state = opened(a=[DRIVE, WASH], b=[FETCH, OPEN]).tried(worked={"b"}, slipped={"a"})
    assert state.past_refused_drives() == Plan.of({"a": [DRIVE, WASH], "b": [OPEN]})
    assert opened(a=[DRIVE], b=[FETCH]).tried(worked={"b"}, slipped={"a"}).past_refused_drives() is None
    assert opened(a=[FETCH], b=[OPEN, FETCH]).tried(worked={"b"}, slipped={"a"}).past_refused_drives() is None


def scene() -> PublicScene:
    env = suite_kitchen("OpenMicrowavePnP")
    _, infos = env.reset(seed=3)
    return public_scene(next(iter(infos.values()))["scene"])


def test_asking_where_something_is_changes_nothing() -> None:
    facts = scene()
    wide = next(name for name in facts.fixtures if len(facts.stations_of(name)) > 1)
    one = next(name for name in facts.fixtures if len(facts.stations_of(name)) == 1)
    quiet, asked = Whereabouts(facts), Whereabouts(facts)
    for step in (Subtask("navigate to", wide), Subtask("navigate to", one), Subtask("navigate to", wide)):
        assert asked.of(wide) is None and asked.goal("a", Subtask("navigate to", wide)) is None
        assert not asked.is_at("a", wide) and asked.of(one) == facts.stations_of(one)[0]
        quiet.run("a", step)
        asked.run("a", step)
        assert quiet.station == asked.station
    first = Whereabouts(facts)
    first.run("a", Subtask("navigate to", wide))
    assert first.station != quiet.station, "each visit has a place of its own"
    assert not first.is_at("b", wide) and not Whereabouts(facts).is_at("a", wide)
