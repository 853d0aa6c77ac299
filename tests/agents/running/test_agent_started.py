"""What a robot has started by itself is waited for, and what others have started, or what follows from it, is not."""

from __future__ import annotations

import pytest
from agent_kitchens import play, suite_kitchen

import remac_agents
from remac_agents.running.started import Started
from remac_env.rules.subtasks import Subtask

ON, OFF, TAKE, PUT = (Subtask(*told) for told in (
    ("turn on", "faucet"), ("turn off", "faucet"), ("pick up", "bowl"), ("place to", "sink")
))  # fmt: skip


def test_what_one_has_started_is_not_ended_before_it_is_over() -> None:
    started = Started()
    started.look({"filling bowl": 3.0}, 10.0)
    assert not started.ends(OFF) and not started.over, "it has turned nothing on"
    started.ended(ON, 10.0)
    started.look({"filling bowl": 5.0, "melting fish": 30.0}, 15.0)
    assert started.ends(OFF) and started.ends(TAKE) and not started.over
    assert not started.ends(Subtask("turn off", "stove")) and not started.ends(Subtask("pick up", "fish"))
    started.look({"melting fish": 50.0, "overflowing bowl": 0.0}, 35.0)
    assert started.over and not started.ends(OFF), "what follows is not waited for"
    started.ended(ON, 40.0)
    assert not started.over and not started.ends(OFF)


def test_what_is_put_under_running_water_is_waited_for_too() -> None:
    started = Started()
    started.ended(ON, 10.0)
    started.look({}, 10.0)
    started.ended(PUT, 20.0)
    started.look({"filling bowl": 4.0}, 24.0)
    assert started.ends(OFF) and started.ends(TAKE)
    started.look({}, 30.0)
    assert started.over


@pytest.mark.long
@pytest.mark.parametrize(
    ("task", "seconds"),
    [("RinseAndStow", 63.0), ("FillAndShelve", 68.0), ("MicrowaveAndFill", 105.0), ("RinseThenHeat", 140.0)],
)
def test_remac_shares_what_takes_its_time(task: str, seconds: float) -> None:
    """As quick as the plans of benchmarks/timed_plans.toml."""
    env = suite_kitchen(task, robots=2, layout="one_wall_large", clock="events")
    agent = remac_agents.make("REMAC", planner="timely")
    play(env, agent, seed=1)
    assert play(env, agent, seed=1).success
    assert max(span.ended for span in env.timeline) == seconds
