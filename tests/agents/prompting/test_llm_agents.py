"""What surrounds a model in the roles: budgets, endpoints that are down, cassettes, images, and options."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from agent_kitchens import play
from chaos_server import refuses
from scripted_model import RIGHT, ScriptedModel, agent_of, run, scripted

import remac_agents
from remac_agents.llm import Cassette
from remac_env.errors import RemacError


def timeless(report: remac_agents.EpisodeReport) -> Any:
    """The report without what hangs on the clock, or on whether a network was asked."""
    exchanges = tuple(replace(exchange, seconds=0.0) for exchange in report.exchanges)
    return replace(report, exchanges=exchanges, usage=replace(report.usage, seconds=0.0))


def test_a_budget_that_is_spent_is_a_failure_of_the_agent() -> None:
    with scripted() as model:
        report = run(model, "CC", max_calls=3)
        assert not report.success and report.infrastructure is None
        assert report.usage.calls == 3 == len(model.heard)
        assert "over_budget" in " ".join(report.errors)


@pytest.mark.parametrize("status", [401, 404])
def test_an_endpoint_that_cannot_answer_is_nobodys_failure_and_is_asked_once(status: int) -> None:
    with scripted() as model:
        model.server.script = [refuses(status)]
        report = run(model, "CC")
        assert not report.success
        assert report.infrastructure is not None
        assert len(model.server.asked) == 1


def test_a_replayed_run_is_the_recorded_one_without_a_server(tmp_path: Path) -> None:
    path = tmp_path / "all.jsonl"
    with scripted() as model:
        recorded = [play(model.env, agent) for agent in [agent_of(model, "RE", cassette=path)] for _ in range(2)]
        asked = len(model.heard)
        agent = agent_of(model, "RE", cassette=path, replay=True)
        replayed = [play(model.env, agent) for _ in range(2)]
        assert len(model.heard) == asked > 0
    assert [timeless(report) for report in replayed] == [timeless(report) for report in recorded]


def test_what_the_cassette_does_not_hold_is_shown_as_a_difference(tmp_path: Path) -> None:
    path = tmp_path / "all.jsonl"
    with scripted() as model:
        run(model, "BASE", cassette=path)
        other = play(model.env, agent_of(model, "CC", cassette=Cassette(path, mode="replay")), seed=4)
        assert other.infrastructure is not None and "cassette_miss" in other.infrastructure
        assert not other.success


def test_a_checker_is_shown_the_images() -> None:
    with scripted(obs="state+images", image_size=32) as model:
        report = run(model, "CC", checker={"name": "custom:scripted", "base_url": model.server.url})
        shown = [name for name, _ in model.heard if name == "checker_seen"]
        assert shown and report.success
        bodies = [asked.body["messages"][-1]["content"] for asked in model.server.asked]
        pictured = [body for body in bodies if isinstance(body, list)]
        assert len(pictured) == len(shown)
        assert all(part["image_url"]["url"].startswith("data:image/png;base64,") for part in pictured[0][1:])
        assert report.pictures and all(png.startswith(b"\x89PNG") for png in report.pictures.values())


@pytest.mark.parametrize(
    "text",
    [
        f"Plan: [{RIGHT}]",
        f"robot_0: [{RIGHT}]",
        f"<think>robot_0: [wait]</think>\n**Plan:** [{RIGHT}]",
        "```json\n" + str(RIGHT.split(", ")).replace("'", '"') + "\n```",
        "\n".join(f"{n}. {step}" for n, step in enumerate(RIGHT.split(", "), 1)),
    ],
)
def test_plans_are_read_in_the_forms_that_models_use(text: str) -> None:
    with scripted() as model:
        model.answers = {"planner": text}
        report = run(model, "BASE")
        assert report.success, report.errors


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"model": "nobody:x"}, "nobody"),
        ({"model": 3}, "provider:model"),
        ({"model": "openai:o3", "max_calls": -1}, "max_calls -1"),
        ({"model": "openai:o3", "replay": True}, "replay needs a cassette"),
        ({"model": "openai:o3", "limiter": 3}, "limiter 3"),
        ({"tea": 1}, "tea"),
    ],
)
def test_bad_options_are_refused_and_say_what_is_valid(options: dict[str, Any], told: str) -> None:
    with pytest.raises(RemacError, match=told):
        remac_agents.make("REMAC", **options)


def test_a_model_without_eyes_leaves_the_checker_to_the_truth() -> None:
    blind = remac_agents.make("CC", model="deepseek:deepseek-reasoner", planner="literal")
    assert type(blind.roles.checker).__name__ == "TruthChecker"
    assert type(blind.roles.planner).__name__ == "LiteralPlanner"
    assert type(blind.roles.adjuster).__name__ == "LlmAdjuster"


def test_the_script_itself_can_fail() -> None:
    with scripted() as model:
        assert not run(model, "BASE").success
        assert isinstance(model, ScriptedModel)
