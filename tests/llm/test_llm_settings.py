"""Options of models: one reader for `--model`, for every role, and for Python."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from chaos_server import says
from llm_kit import ASK, Kit, open_kit
from remac_bench.playing.agents import asked_models

import remac_agents
from remac_agents.llm import Budget, ChatClient, ModelSettings, plain_model_name, read_model_name, resolve
from remac_agents.text.options import join_options, split_options
from remac_agents.wiring.catalogue import MODEL_ROLES, make_role, read_role
from remac_env.errors import OptionError, RemacError, UnknownNameError

ALL = (
    "seconds=900,max_tokens=4096,max_tokens_bound=9000,temperature=none,stream=true,images=false,seed=7,"
    "max_tokens_field=max_completion_tokens,response_format=none,context=8192,price_in=1,price_out=2.5,"
    "extra.reasoning_effort=high,extra.reasoning.max_tokens=10,stream_usage=false"
)


@pytest.fixture
def kit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Kit]:
    with open_kit(tmp_path, monkeypatch) as kit:
        yield kit


@pytest.mark.parametrize(
    ("text", "name", "options"),
    [
        ("literal", "literal", {}),
        ("noisy, miss=0.2 ,x=a b", "noisy", {"miss": "0.2", "x": "a b"}),
        ("com,ma/p.py:plan", "com,ma/p.py:plan", {}),
        ("a,b,c/p.py:plan,n=2", "a,b,c/p.py:plan", {"n": "2"}),
        ("answers:one,two.json", "answers:one,two.json", {}),
        (r"a\,x=1/p.py:plan,n=2", "a,x=1/p.py:plan", {"n": "2"}),
        (r"C:\new\p.py:plan,n=2", r"C:\new\p.py:plan", {"n": "2"}),
        ("m,list=[1,2],o={\"a\":1,\"b\":2}", "m", {"list": "[1,2]", "o": '{"a":1,"b":2}'}),
        (r"m,stop=a\,b=c", "m", {"stop": "a,b=c"}),
        ("http://h:1/p?q=1,seconds=2", "http://h:1/p?q=1", {"seconds": "2"}),
        ("m,a=b=c", "m", {"a": "b=c"}),
    ],
)
def test_options_are_split_from_names_by_one_rule(text: str, name: str, options: dict[str, str]) -> None:
    assert split_options(text) == (name, options)
    assert split_options(join_options(name, options)) == (name, options)


@pytest.mark.parametrize("text", ["noisy,miss", "noisy,", "m,a=1,a=2"])
def test_options_that_are_none(text: str) -> None:
    with pytest.raises(OptionError, match="valid"):
        split_options(text)


def test_every_property_is_set_where_the_model_is_named() -> None:
    name, settings = read_model_name(f"vllm:org/m,{ALL}")
    assert name == "vllm:org/m"
    assert settings == ModelSettings(
        seconds=900,
        max_tokens=4096,
        max_tokens_bound=9000,
        temperature=None,
        stream=True,
        images=False,
        seed=7,
        max_tokens_field="max_completion_tokens",
        response_format="none",
        context=8192,
        price_in=1,
        price_out=2.5,
        extra={"reasoning_effort": "high", "reasoning": {"max_tokens": 10}},
        stream_usage=False,
    )
    model = settings.applied(resolve(name)).model
    assert (model.seconds, model.max_tokens, model.context, model.images) == (900, 4096, 8192, False)
    assert (model.response_format, model.money(1_000_000, 1_000_000)) == ((), 3.5)
    assert read_model_name("o3") == ("o3", ModelSettings())


@pytest.mark.parametrize(
    ("option", "told"),
    [
        ("max_token=5", "unknown option 'max_token'.*valid:.*max_tokens.*extra.NAME"),
        ("max-tokens=5", "unknown option 'max-tokens'"),
        ("max_tokens", "'max_tokens' is not valid; valid: name,option=value"),
        ("x y", "'x y' is not valid"),
        ("max_tokens=0", "max_tokens 0 .*valid: a whole number from 1"),
        ("max_tokens=-3", "max_tokens -3"),
        ("max_tokens=1.5", "max_tokens 1.5 .*whole"),
        ("max_tokens=many", "max_tokens 'many'"),
        ("max_tokens=true", "max_tokens True"),
        ("max_tokens=1e999", "max_tokens inf"),
        ("seconds=inf", "seconds 'inf' .*to 86400"),
        ("seconds=Infinity", "seconds inf"),
        ("seconds=nan", "seconds 'nan'"),
        ("seconds=NaN", "seconds nan"),
        ("seconds=0", "seconds 0"),
        ("temperature=3", "temperature 3 .*0 to 2, or none"),
        ("context=0", "context 0"),
        ("price_in=-1", "price_in -1"),
        ("stream=maybe", "stream 'maybe' .*true or false"),
        ("images=1", "images 1 .*true or false"),
        ("max_tokens_field=tokens", "max_tokens_field 'tokens' .*max_completion_tokens"),
        ("response_format=xml", "response_format 'xml' .*json_object"),
        ("extra.temperature=1", "extra.temperature"),
        ("extra.=1", "extra. is not valid"),
        ("extra.a=1,extra.a.b=2", "fields of its own"),
        ("extra.a=NaN", "valid: values of JSON"),
        ("seed=1,seed=2", "'seed' is given twice"),
    ],
)
def test_wrong_options_are_refused_everywhere(option: str, told: str) -> None:
    with pytest.raises(OptionError, match=told):
        read_model_name(f"custom:m,{option}")
    with pytest.raises(RemacError, match=told):
        remac_agents.make("CC", model=f"custom:m,{option}", base_url="http://127.0.0.1:1/v1")
    for role in MODEL_ROLES:
        with pytest.raises(RemacError, match=told):
            remac_agents.make("CC", **{role: f"custom:m,{option}"}, base_url="http://127.0.0.1:1/v1")


@pytest.mark.parametrize("role", MODEL_ROLES)
def test_options_mean_the_same_for_every_role(role: str, kit: Kit) -> None:
    text = f"custom:m,base_url={kit.server.url},{ALL.replace('images=false', 'images=true')}"
    mapping = read_role(text)
    for given in (text, mapping):
        made = make_role(role, given)
        kit.server.plays(says())
        made.client.complete(ASK, response_format={"type": "json_object"})
        assert kit.server.asked[0].body == {
            "model": "m",
            "messages": ASK,
            "max_completion_tokens": 4096,
            "seed": 7,
            "stream": True,
            "reasoning_effort": "high",
            "reasoning": {"max_tokens": 10},
        }
        assert made.client.endpoint.model.seconds == 900


def test_python_values_do_as_well_as_text(kit: Kit) -> None:
    made = make_role("planner", {"name": "custom:m", "base_url": kit.server.url, "extra": {"a": {"b": "5"}}, "seed": 3})
    kit.server.plays(says())
    made.client.complete(ASK)
    assert (kit.server.asked[0].body["a"], kit.server.asked[0].body["seed"]) == ({"b": "5"}, 3)


def test_a_client_of_a_name_takes_its_options(kit: Kit) -> None:
    kit.server.plays(says())
    with ChatClient(f"custom:m,base_url={kit.server.url},temperature=0.5,stream=false", environ={}) as client:
        client.complete(ASK)
        client.complete(ASK, temperature=None)
    first, second = (asked.body for asked in kit.server.asked)
    assert first["temperature"] == 0.5 and "stream" not in first
    assert "temperature" not in second


def test_new_options_alone_change_the_key_of_a_question(kit: Kit) -> None:
    def key(**options: Any) -> str:
        return kit.reply(says(), options=options).key

    plain = key()
    same = {"seconds": 5, "images": False, "stream_usage": False, "max_tokens_field": "max_completion_tokens"}
    assert {key(**{name: value}) for name, value in same.items()} == {plain}, "how it is sent is no part of a question"
    assert len({plain, key(**{"extra.a": 1}), key(temperature=1), key(seed=1)}) == 4


def test_entries_have_one_name_whatever_the_order() -> None:
    one = plain_model_name("vllm:m, seed=3,max_tokens=9")
    assert one == plain_model_name("vllm:m,max_tokens=9,seed=3") == "vllm:m,max_tokens=9,seed=3"
    assert plain_model_name("openai:o3") == "openai:o3"
    assert asked_models({"model": one, "checker": "o3,seconds=5", "planner": "com,ma/p.py:plan"}) == ["o3", "vllm:m"]


def test_paths_with_commas_are_found(tmp_path: Path) -> None:
    for folder, written in (("com,ma", "com,ma"), ("a,b=c", r"a\,b=c")):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "p.py").write_text("def plan(request):\n    return []\n")
        assert make_role("planner", f"{tmp_path}/{written}/p.py:plan").plan(None) == []
    file = tmp_path / "one,two.json"
    file.write_text(json.dumps({}))
    with pytest.raises(UnknownNameError, match=r"options: name,option=value.*\\,"):
        make_role("planner", "one,two.toml")


@pytest.mark.parametrize("name", ["max_calls", "max_tokens", "max_money", "max_seconds"])
@pytest.mark.parametrize("value", [float("inf"), float("nan"), -1, "x", True])
def test_bounds_that_are_no_numbers(name: str, value: Any) -> None:
    with pytest.raises(OptionError, match=f"{name} .* is not valid; valid: (a .*number from 0|whole numbers 0)"):
        remac_agents.make("CC", **{name: value})
    with pytest.raises(OptionError, match="is not valid; valid: a number from 0"):
        Budget(**{name.removeprefix("max_"): value})


@pytest.mark.parametrize("value", ["nan", "inf", "x", "-1", "7", "true"])
def test_numbers_of_the_noisy_checker(value: str) -> None:
    with pytest.raises(OptionError, match="miss .* is not valid; valid: a number from 0 to 1"):
        make_role("checker", f"noisy,miss={value}")
