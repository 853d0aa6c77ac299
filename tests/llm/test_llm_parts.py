"""Providers, limiter and cassette by themselves."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy
import pytest
from chaos_server import Asked, says
from llm_kit import ASK, FakeTime, Kit, open_kit

from remac_agents.llm import Cassette, ChatClient, ChatError, ChatReply, Limiter, Picture, load, resolve
from remac_agents.llm.limiter import STRIKE_PAUSE_S, STRIKES
from remac_env.errors import OptionError, UnknownNameError


@pytest.fixture
def kit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Kit]:
    with open_kit(tmp_path, monkeypatch) as kit:
        yield kit


@pytest.mark.parametrize(
    "name", ["gpt-4o", "o3", "DeepSeek-R1", "QwQ", "Qwen3", "Grok3", "grok3", "openai:gpt-4o-mini"]
)
def test_the_papers_models_are_ready(name: str) -> None:
    endpoint = resolve(name)
    assert endpoint.base_url.startswith("https://") and endpoint.provider.key.endswith("_API_KEY")
    assert endpoint.model.context > 60_000 and endpoint.model.max_tokens > 1000


def test_every_listed_price_has_its_date() -> None:
    catalogue = load()
    models = [model for provider in catalogue.providers.values() for model in provider.models.values()]
    assert len(catalogue.providers) == 10 and len(models) > 8
    for model in models:
        assert (model.price_in is None) == (model.price_out is None) == (model.priced_on == ""), model.name
    for alias in catalogue.paper:
        resolve(alias)
    assert resolve("xai:grok-3").model.money(1_000_000, 1_000_000) == 18.0
    assert resolve("ollama:anything").model.money(10, 10) == 0.0
    assert resolve("openrouter:some/thing").model.money(10, 10) is None


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("openai:gpt-4", "did you mean 'gpt-4o'.*valid: gpt-4o, gpt-4o-mini, o3"),
        ("openia:o3", "openai:o3.*ollama:<model>"),
        ("genius", "DeepSeek-R1"),
        ("openai:", "openai:gpt-4o"),
        ("", "valid"),
    ],
)
def test_unknown_names_list_the_valid_ones(name: str, told: str) -> None:
    with pytest.raises(UnknownNameError, match=told):
        resolve(name)


def test_base_urls() -> None:
    assert resolve("custom:m", base_url="http://127.0.0.1:9/v1/").base_url == "http://127.0.0.1:9/v1"
    assert resolve("vllm:org/m:tag", base_url="http://gpu-box:8000/v1").model.name == "org/m:tag"
    new = resolve("openai:gpt-9", base_url="https://api.openai.com/v1")
    assert new.model.money(1, 1) is None and new.model.max_tokens_field == "max_completion_tokens"
    for url, told in (
        (None, "needs base_url"),
        ("ftp://x/v1", "http://"),
        ("http://user:secret@x/v1", "may hold no user"),
        ("http://x/v1?key=secret", "may hold no"),
        ("http://169.254.169.254/latest", "machine services"),
        ("http://[fe80::1]/", "machine services"),
        ("http://x:99999/", "address"),
        ("localhost:8000", "http://"),
    ):
        with pytest.raises(OptionError, match=told) as raised:
            resolve("custom:m", base_url=url)
        assert "secret" not in str(raised.value)
    for url in ("https://api.openai.com.evil.example/v1", "http://api.openai.com/v1", "https://api.openai.com:8443/v1"):
        with pytest.raises(OptionError, match="its key goes nowhere else"):
            resolve("openai:o3", base_url=url)


def test_a_providers_file_of_ones_own(tmp_path: Path) -> None:
    file = tmp_path / "p.toml"
    head = '[providers.mine]\ntitle = "Mine"\nbase_url = "https://x.example/v1"\nkey = "MINE"\n'
    file.write_text(head + "[providers.mine.models.small]\ncontext = 5\n")
    assert resolve("mine:small", file=file).model.context == 5
    file = tmp_path / "q.toml"
    file.write_text(head + "colour = 3\n")
    with pytest.raises(OptionError, match="mine.*'colour'.*valid:.*context"):
        load(file)
    with pytest.raises(OptionError, match="none.toml"):
        load(tmp_path / "none.toml")


def test_the_limit_shrinks_at_once_and_grows_slowly() -> None:
    clock = FakeTime()
    limiter = Limiter(start=8, most=9, clock=clock.clock)
    limiter.rate_limited(0)
    limiter.rate_limited(0)
    assert limiter.limit == 6, "a burst is one message"
    clock.skipped += 16
    limiter.rate_limited(0)
    assert limiter.limit == 5
    for _ in range(4):
        limiter.succeeded()
    assert limiter.limit == 5
    for _ in range(200):
        limiter.succeeded()
    assert limiter.limit == 9 and limiter.history == (8, 6, 5, 6, 7, 8, 9)
    for _ in range(20):
        clock.skipped += 16
        limiter.rate_limited(0)
    assert limiter.limit == 1
    with pytest.raises(OptionError, match="1 <= start"):
        Limiter(start=0)


def test_a_failing_endpoint_is_left_alone_for_a_while() -> None:
    clock = FakeTime()
    limiter = Limiter(clock=clock.clock)
    for _ in range(STRIKES - 1):
        limiter.failed()
    limiter.succeeded()
    limiter.failed()
    with limiter.place(clock.clock.monotonic() + 10) as got:
        assert got and clock.slept == [], "an answer in between starts the count anew"
    for _ in range(STRIKES):
        limiter.failed()
    with limiter.place(clock.clock.monotonic() + 10) as got:
        assert not got, "the pause is longer than the call may last"
    with limiter.place(clock.clock.monotonic() + 100) as got:
        assert got and sum(clock.slept) == pytest.approx(STRIKE_PAUSE_S, abs=0.5)


def test_no_more_requests_than_the_limit_are_under_way(kit: Kit) -> None:
    lock, now, most = threading.Lock(), 0, 0

    def slowly(connection: object, asked: Asked) -> None:
        nonlocal now, most
        with lock:
            now += 1
            most = max(most, now)
        time.sleep(0.05)
        with lock:
            now -= 1
        says()(connection, asked)  # type: ignore[arg-type]

    kit.server.plays(slowly)
    limiter = Limiter(start=2, most=2)
    replies: list[object] = []
    with ChatClient(kit.client().endpoint, limiter=limiter, environ={}) as client:
        threads = [threading.Thread(target=lambda: replies.append(client.complete(ASK))) for _ in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    assert most == 2 and len(replies) == 8
    assert all(isinstance(reply, ChatReply) for reply in replies)


def test_a_full_house_is_waited_for_no_longer_than_the_deadline() -> None:
    limiter = Limiter(start=1, most=1)
    with limiter.place(time.monotonic() + 5) as first, limiter.place(time.monotonic() + 0.1) as second:
        assert (first, second) == (True, False)
    with limiter.place(time.monotonic() + 5) as third:
        assert third


def test_a_cassette_replays_without_a_network_and_without_a_key(kit: Kit) -> None:
    path = kit.folder / "deep" / "c.jsonl"
    picture = Picture.of(numpy.full((8, 8, 3), 7, dtype=numpy.uint8))
    told = kit.reply(says("yes", reasoning="because"), cassette=Cassette(path), ask={"images": [picture]})
    assert "base64" not in path.read_text() and picture.digest in path.read_text()
    url = kit.server.url
    kit.server.plays(says("live"))
    other_encoding = Picture(b"other bytes", picture.digest)
    cassette = Cassette(path, mode="replay")
    reply = kit.reply(cassette=cassette, base_url=url, key="", stream=True, ask={"images": [other_encoding]})
    assert (reply.text, reply.reasoning, reply.tokens_out, reply.key) == ("yes", "because", 5, told.key)
    assert (reply.attempts, kit.server.asked) == (0, [])


def test_a_miss_shows_the_difference_to_the_nearest_prompt(kit: Kit) -> None:
    path = kit.folder / "c.jsonl"
    kit.server.plays(says())
    with kit.client(cassette=Cassette(path)) as client:
        client.complete([{"role": "user", "content": "goal: heat it\nscene: a red box\nrobots: 2"}])
        client.complete([{"role": "user", "content": "something else altogether, and longer than the other"}])
    cassette = Cassette(path, mode="replay")
    with kit.client(cassette=cassette) as client:
        error = client.complete([{"role": "user", "content": "goal: heat it\nscene: a blue\x1b[31m box\nrobots: 2"}])
    assert isinstance(error, ChatError) and error.kind == "cassette_miss" and error.infrastructure
    lines = error.detail.splitlines()
    assert "-scene: a red box" in lines and "+scene: a blue box" in lines
    assert not [line for line in lines if "something else" in line] and "\x1b" not in error.detail
    assert (cassette.misses, len(cassette)) == (1, 2)


def test_labels_keep_equal_prompts_apart(kit: Kit) -> None:
    path = kit.folder / "c.jsonl"
    for label in ("seed 1", "seed 2"):
        kit.reply(says(f"for {label}"), cassette=Cassette(path), ask={"label": label})
    cassette = Cassette(path, mode="replay")
    for label in ("seed 2", "seed 1"):
        assert kit.reply(cassette=cassette, ask={"label": label}).text == f"for {label}"


def test_modes_of_a_cassette(tmp_path: Path) -> None:
    with pytest.raises(OptionError, match=r"none\.jsonl"):
        Cassette(tmp_path / "none.jsonl", mode="replay")
    with pytest.raises(UnknownNameError, match="record, replay, fill"):
        Cassette(tmp_path / "c.jsonl", mode="play")  # type: ignore[arg-type]
    assert len(Cassette(tmp_path / "new.jsonl", mode="fill")) == 0
