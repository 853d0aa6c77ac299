"""Routes to the paper's models, files of providers, and what a request did cost."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from chaos_server import completion, sends
from llm_kit import Kit, open_kit

import remac_agents
from remac_agents.llm import load, read_settings, resolve, route
from remac_agents.llm.judging import cost
from remac_agents.llm.provider_files import digest
from remac_env.errors import OptionError, UnknownNameError

PAPER = ["gpt-4o", "o3", "DeepSeek-R1", "QwQ", "Qwen3", "Grok3"]
ONE_KEY = {"OPENROUTER_API_KEY": "k"}
MINE = '[providers.mine]\ntitle = "Mine"\nbase_url = "https://x.example/v1"\nkey = "MINE_KEY"\n'


@pytest.fixture
def kit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Kit]:
    with open_kit(tmp_path, monkeypatch) as kit:
        yield kit


def write(folder: Path, text: str, name: str = "p.toml") -> Path:
    file = folder / name
    file.write_text(text, "utf-8")
    return file


@pytest.mark.parametrize("name", PAPER)
@pytest.mark.parametrize("via", ["openrouter", "auto"])
def test_one_key_reaches_all_models_of_the_paper(name: str, via: str) -> None:
    full = route(name, via=via, environ=ONE_KEY)
    assert full.startswith("openrouter:")
    model = resolve(full).model
    assert model.context >= 32_768 and model.price_in is not None and model.extra == {"usage": {"include": True}}
    assert model.images == (name in ("gpt-4o", "o3"))
    assert (model.seconds == 900) == (name not in ("gpt-4o", "Grok3")) == (model.reasoning_tokens > 0)
    assert model.max_tokens < model.context


def test_auto_takes_the_first_route_with_a_key() -> None:
    both = {"OPENAI_API_KEY": "k", **ONE_KEY}
    assert route("o3", via="auto", environ=both) == "openai:o3"
    assert route("openai:o3", via="auto", environ=ONE_KEY) == "openrouter:openai/o3"
    assert route("openrouter:openai/o3", via="auto", environ=both) == "openrouter:openai/o3"
    assert route("custom:m", via="auto", environ={}) == "custom:m"
    with pytest.raises(OptionError, match=r"'o3'.*OPENAI_API_KEY \(openai:o3\), OPENROUTER_API_KEY"):
        route("o3", via="auto", environ={"OPENAI_API_KEY": "  "})


def test_routes_are_names_too_and_a_missing_one_is_told_with_those_there_are() -> None:
    assert route("O3") == "openai:o3" and route("openrouter:openai/o3") == "openrouter:openai/o3"
    assert route("openai:o3", via="openrouter") == "openrouter:openai/o3"
    with pytest.raises(UnknownNameError, match="'Grok3' has no route via 'openai'; valid: xai:grok-3, openrouter:x-ai"):
        route("Grok3", via="openai")
    with pytest.raises(UnknownNameError, match="unknown via 'opnrouter'.*auto.*openrouter"):
        route("o3", via="opnrouter")


def test_an_agent_of_one_route(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    agent = remac_agents.make("BASE", model="DeepSeek-R1", via="huggingface")
    assert "huggingface:deepseek-ai/DeepSeek-R1" in repr(agent.roles.planner)
    file = write(tmp_path, MINE + "any_model = true\n")
    agent = remac_agents.make("BASE", planner="mine:thinker", providers=file)
    assert "mine:thinker" in repr(agent.roles.planner)
    for wrong in ({"providers": 3}, {"via": 3}):
        with pytest.raises((OptionError, UnknownNameError), match="valid: "):
            remac_agents.make("BASE", model="o3", **wrong)
    with pytest.raises(UnknownNameError, match="mine:thinker"):
        remac_agents.make("BASE", planner="mine:thinker")


def test_a_file_is_laid_over_what_is_built_in_field_by_field(tmp_path: Path) -> None:
    file = write(
        tmp_path,
        "\ufeff[providers.openai.models.o3]\nprice_in = 1.5\nprice_out = 9\n[providers.openrouter.models.'a/b']\n"
        f"context = 5\nextra = {{ top_k = 3 }}\n{MINE}[providers.mine.models.small]\n"
        "[paper]\no3 = ['mine:small', 'openai:o3']\nNew = 'mine:small'\n",
    )
    o3, built_in = resolve("openai:o3", file=file).model, resolve("openai:o3").model
    assert (o3.price_in, o3.price_out, o3.context) == (1.5, 9, built_in.context) and built_in.price_in != 1.5
    assert resolve("openrouter:a/b", file=file).model.extra == {"usage": {"include": True}, "top_k": 3}
    catalogue = load(file)
    assert set(load().providers) < set(catalogue.providers) and "mine" not in load().providers
    assert catalogue.paper["o3"] == ("mine:small", "openai:o3") and catalogue.paper["QwQ"] == load().paper["QwQ"]
    assert route("o3", via="auto", file=file, environ={"MINE_KEY": "k"}) == "mine:small"
    before = digest(file)
    write(tmp_path, MINE)
    assert "New" not in load(file).paper and digest(file) != before  # read again, not remembered by its name


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("[modles]\n", "unknown key 'modles'; valid: version, paper, providers"),
        (MINE + "colour = 3\n", "mine.*'colour'; valid: .*context"),
        (MINE + "[providers.mine.models.m]\nkey = 'OTHER'\n", "mine:m: unknown key 'key'"),
        ("[providers.mine]\ntitle = 'x'\n", "provider mine: base_url, key missing"),
        ("providers = 3\n", "providers: 3 is not valid; valid: a table"),
        ("[providers.openai]\ncontext = -1\n", "context -1 is not valid; valid: a whole number, 0"),
        ("[providers.openai]\ncontext = true\n", "context True is not valid"),
        ("[providers.openai]\nmax_tokens = 0\n", "max_tokens 0 is not valid; valid: a whole number, 1 to"),
        ("[providers.openai]\nseconds = inf\n", "seconds inf is not valid; valid: seconds, 1 to 86400"),
        ("[providers.openai]\nprice_in = nan\nprice_out = 1\n", "price_in nan is not valid"),
        ("[providers.openai]\nprice_in = -1\nprice_out = 1\n", "price_in -1 is not valid"),
        ("[providers.mine2]\ntitle='m'\nbase_url='https://x/v1'\nkey='K'\nprice_in = 1\n", "price_out"),
        ("[providers.openai]\nimages = 'yes'\n", "images 'yes' is not valid; valid: true or false"),
        ("[providers.openai]\nany_model = 1\n", "any_model 1 is not valid; valid: true or false"),
        ("[providers.openai]\nresponse_format = ['xml']\n", "valid: a list of json_object, json_schema"),
        ("[providers.openai]\nextra = 3\n", "extra 3 is not valid; valid: a table"),
        ("[paper]\no3 = []\n", "valid: a list of provider:model"),
        ("[paper]\no3 = 'opnai:o3'\n", "no such provider; valid: openai"),
        ("[paper]\no3 = 'openai:o33'\n", "no such model; valid: openai:gpt-4o"),
        ("version = 2\n", "version 2 is not valid; valid: 1"),
        ("[paper\n", "p.toml: "),
    ],
)
def test_what_is_wrong_in_a_file_is_named(tmp_path: Path, text: str, told: str) -> None:
    file = write(tmp_path, text)
    with pytest.raises(OptionError, match=told) as raised:
        load(file)
    assert str(file) in str(raised.value)
    assert load().providers  # what is built in is as it was


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    for path in (tmp_path / "none.toml", tmp_path):
        with pytest.raises(OptionError, match="cannot be read"):
            load(path)
    (tmp_path / "latin.toml").write_bytes(b"# \xe9")
    with pytest.raises(OptionError, match="latin.toml"):
        load(tmp_path / "latin.toml")


@pytest.mark.parametrize(
    ("usage", "money"),
    [
        ({"cost": 0.25}, 0.25),
        ({"cost": 0}, 0.0),
        ({"cost": {"total_cost": 0.5, "input_tokens_cost": 0.1}}, 0.5),
        ({"total_cost": 0.75}, 0.75),
        ({"cost": 0.95, "cost_details": {"upstream_inference_cost": 19}}, 19.95),
        ({"cost": 0.95, "is_byok": True, "cost_details": {"upstream_inference_cost": 0.5}}, 1.45),
        ({"cost": 0.95, "is_byok": False, "cost_details": {"upstream_inference_cost": 19}}, 0.95),
        ({"cost": 0.95, "cost_details": {"upstream_inference_cost": 0.95}}, 0.95),
        ({"cost": 0.95, "cost_details": {"upstream_inference_cost": None}}, 0.95),
        ({"cost_details": {"upstream_inference_cost": 0.3}}, 0.3),
        ({"cost": float("nan")}, None),
        ({"cost": float("inf")}, None),
        ({"cost": 10**400}, None),
        ({"cost": -1}, None),
        ({"cost": True}, None),
        ({"cost": "0.1"}, None),
        ({"cost": -1, "total_cost": 0.1}, 0.1),
        ({"prompt_tokens": 3}, None),
        ([], None),
        (None, None),
    ],
)
def test_what_an_endpoint_says_a_request_did_cost(usage: Any, money: float | None) -> None:
    assert cost(usage) == pytest.approx(money) if money is not None else cost(usage) is None


def test_the_told_cost_is_believed_before_the_list_price(kit: Kit) -> None:
    usage = {"prompt_tokens": 10, "completion_tokens": 5, "cost": 0.125}
    told = sends(json.dumps(completion("yes", usage=usage)).encode())
    assert kit.reply(told).money == 0.125
    only_cost = sends(json.dumps(completion("yes", usage={"cost": 0.5})).encode())
    with kit.client() as client:
        kit.server.plays(only_cost)
        outcome = client.complete([{"role": "user", "content": "?"}])
        assert outcome.money == 0.5 and outcome.tokens_in is None
        assert (client.budget.spent.money, client.budget.spent.unpriced) == (0.5, 0)


def test_a_local_server_costs_nothing_even_if_it_counts_no_tokens() -> None:
    for name in ("ollama:m", "vllm:m", "llamacpp:m"):
        assert resolve(name).model.money(None, None) == 0.0
    for host in ("127.0.0.1:9", "127.8.0.1", "[::1]:9", "localhost:9"):
        own = resolve("custom:m", base_url=f"http://{host}/v1")
        assert own.model.money(10, 10) == 0.0, host
        assert read_settings({"price_in": 1, "price_out": 2}).applied(own).model.money(10**6, 10**6) == 3.0
    for host in ("192.168.0.7:9", "example.org", "localhost.example.org", "127.0.0.1.example.org"):
        assert resolve("custom:m", base_url=f"https://{host}/v1").model.money(10, 10) is None, host
    assert resolve("openai:o3").model.money(None, 3) is None


def test_openrouter_is_asked_for_the_cost(kit: Kit, tmp_path: Path) -> None:
    file = write(tmp_path, f"[providers.openrouter]\nbase_url = '{kit.server.url}'\n")
    from remac_agents.llm import ChatClient

    kit.server.plays(sends(json.dumps(completion("yes")).encode()))
    with ChatClient(resolve("Qwen3", via="openrouter", file=file), environ=ONE_KEY) as client:
        client.complete([{"role": "user", "content": "?"}])
    assert kit.server.asked[0].body["usage"] == {"include": True}
    kit.outcome(sends(json.dumps(completion("yes")).encode()))
    assert "usage" not in kit.server.asked[0].body
