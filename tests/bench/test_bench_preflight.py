"""One tiny question to each model before a run, against a real endpoint on loopback with every manner."""

from __future__ import annotations

import json
import re
import socket
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest
from bench_helpers import read
from chaos_server import DONE, Act, Asked, ChaosServer, chunk, completion, drips, hangs, refuses, says, sends, streams
from remac_bench.cli import app
from remac_bench.playing import agents
from remac_bench.playing.job_lists import make_jobs
from remac_bench.playing.jobs import Job
from remac_bench.preflight.estimates import Costs, Need, measured
from remac_bench.preflight.probes import Preflight, Probe, ask
from remac_bench.preflight.run import bill, by_kind, distinct, to_ask
from typer.testing import CliRunner, Result

from remac_agents.llm import Cassette, ChatClient, read_settings, resolve

SEES = '{"colour": "red"}'
PLAIN = '{"ok": true}'


@pytest.fixture
def server() -> Iterator[ChaosServer]:
    with ChaosServer([says(SEES)]) as server:
        yield server


def client(url: str, model: str = "custom:m", **facts: Any) -> ChatClient:
    return ChatClient(resolve(model, base_url=url), environ={"CUSTOM_API_KEY": "k"}, **facts)


def found(preflight: Preflight) -> dict[str, Probe]:
    return {probe.check: probe for probe in preflight.probes}


def picture_shown(asked: Asked) -> bool:
    return isinstance(asked.body["messages"][-1]["content"], list)


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as one:
        return int(one.getsockname()[1])


def test_all_is_well_after_one_question(server: ChaosServer) -> None:
    preflight = ask(client(server.url))
    probes = found(preflight)
    assert [probes[check].ok for check in ("address", "key", "answer", "pictures", "JSON", "tokens")] == [True] * 6
    assert not preflight.fatal and not preflight.warnings
    assert preflight.questions == len(server.asked) == 1
    assert probes["price"].ok and probes["price"].told == "$0 by the table: free (on this machine)"
    assert preflight.money == 0.0
    assert picture_shown(server.asked[0]) and server.asked[0].body["response_format"] == {"type": "json_object"}
    assert "10 in, 5 out" in probes["tokens"].told


def test_what_the_endpoint_says_it_did_cost(server: ChaosServer) -> None:
    usage = {"prompt_tokens": 10, "completion_tokens": 5, "cost": 0.25}
    server.plays(says(SEES, usage=usage))
    preflight = ask(client(server.url))
    assert preflight.money == 0.25 and found(preflight)["price"].told == (
        "$0.25, as the endpoint says; by the table: free (on this machine)"
    )


@dataclass(frozen=True)
class Fatal:
    act: Act
    check: str
    told: str


@pytest.mark.parametrize(
    "case",
    [
        Fatal(refuses(401, "bad key"), "key", "said 401: bad key"),
        Fatal(refuses(402, "no credits"), "key", "said 402: no credits"),
        Fatal(refuses(404, "no such model m"), "model", "said 404: no such model m"),
        Fatal(refuses(429, "insufficient_quota"), "key", "insufficient_quota"),
        Fatal(sends(b"", status=302, headers=["location: http://x.example/"]), "address", "302"),
    ],
)
def test_what_no_job_would_be_spared(server: ChaosServer, case: Fatal) -> None:
    server.plays(case.act)
    preflight = ask(client(server.url))
    (probe,) = preflight.fatal
    assert probe.check == case.check and case.told in probe.told and server.url in probe.told
    assert len(server.asked) == 1  # nothing is asked again in vain


def test_a_dead_server_and_a_missing_key_are_said_with_address_and_name() -> None:
    url = f"http://127.0.0.1:{free_port()}/v1"
    (probe,) = ask(client(url)).fatal
    assert probe.check == "address" and url in probe.told
    (probe,) = ask(ChatClient(resolve("openai:o3"), environ={})).fatal
    assert probe.check == "key" and "OPENAI_API_KEY" in probe.told


@pytest.mark.parametrize("act", [refuses(500, "oops"), refuses(429, "slow down"), sends(b"<html>"), drips(b"HTTP/1.1")])
def test_what_may_pass_is_a_warning(server: ChaosServer, act: Act) -> None:
    server.plays(act)
    preflight = ask(client(server.url))
    assert not preflight.fatal
    (warning,) = preflight.warnings
    assert warning.check == "answer" and warning.told.endswith("continues") and server.url in warning.told
    assert len(server.asked) <= 3


def test_a_model_that_thinks_is_not_waited_for(server: ChaosServer) -> None:
    server.plays(hangs(5))
    preflight = ask(client(server.url), seconds=0.3)
    (probe,) = preflight.probes
    assert probe.ok is None and not preflight.fatal and "continues" in probe.told and len(server.asked) == 1


def test_a_refused_picture_is_named(server: ChaosServer) -> None:
    def act(connection: socket.socket, asked: Asked) -> None:
        refused = picture_shown(asked)
        (refuses(400, "m is not a multimodal model") if refused else says(PLAIN))(connection, asked)

    server.plays(act)
    preflight = ask(client(server.url))
    probes = found(preflight)
    assert probes["pictures"].ok is False and "not a multimodal model" in probes["pictures"].told
    assert "images=false" in probes["pictures"].told and probes["JSON"].ok is True
    assert preflight.questions == 2 and not preflight.fatal


def test_it_is_said_who_says_that_no_pictures_are_taken(server: ChaosServer) -> None:
    server.plays(says(PLAIN))
    blind = ask(client(server.url, settings=read_settings({"images": False})))
    assert found(blind)["pictures"].told == "not taken, says the option images=false"
    listed = replace(client(server.url).endpoint, model=replace(client(server.url).endpoint.model, images=False))
    told = found(ask(ChatClient(listed, environ={})))["pictures"].told
    assert told == "not taken, says the providers' table"


def test_a_refused_form_is_named(server: ChaosServer) -> None:
    def act(connection: socket.socket, asked: Asked) -> None:
        refused = "response_format" in asked.body
        (refuses(400, "response_format is not supported") if refused else says(PLAIN))(connection, asked)

    server.plays(act)
    probes = found(ask(client(server.url)))
    assert probes["JSON"].ok is False and "response_format=none" in probes["JSON"].told


def test_what_the_endpoint_wants_otherwise_is_told(server: ChaosServer) -> None:
    def act(connection: socket.socket, asked: Asked) -> None:
        old = "Unsupported parameter: 'max_tokens' is not supported. Use 'max_completion_tokens' instead."
        (refuses(400, old, param="max_tokens") if "max_tokens" in asked.body else says(SEES))(connection, asked)

    server.plays(act)
    preflight = ask(client(server.url))
    assert "max_tokens -> max_completion_tokens" in found(preflight)["options"].told
    assert preflight.questions == len(server.asked) == 2 and not preflight.warnings


@pytest.mark.parametrize(
    ("act", "check", "ok"),
    [
        (says("It is a red square."), "JSON", False),
        (says('{"colour": "blue"}'), "pictures", False),
        (sends(json.dumps({k: v for k, v in completion(SEES).items() if k != "usage"}).encode()), "tokens", None),
        (says(SEES, finish="length"), "answer", True),
        (streams(chunk(SEES), chunk(finish="stop"), DONE), "JSON", True),
    ],
)
def test_other_findings(server: ChaosServer, act: Act, check: str, ok: bool | None) -> None:
    server.plays(act)
    preflight = ask(client(server.url))
    assert found(preflight)[check].ok is ok and not preflight.fatal


def test_questions_are_on_no_cassette_and_in_no_budget(server: ChaosServer, tmp_path: Path) -> None:
    one = client(server.url, cassette=Cassette(tmp_path / "c.jsonl", mode="fill"))
    ask(one)
    assert (tmp_path / "c.jsonl").read_text() == "" and one.budget.spent.calls == 0


def job(url: str, **changes: Any) -> Job:
    facts: dict[str, Any] = {"tasks": ["HeatOnStove"], "methods": ["BASE"], "seeds": [0]}
    kitchen = {"backend": "symbolic"}
    access = agents.Access(base_url=url, **changes.pop("access", {}))
    (made,) = make_jobs(**facts, kitchen=kitchen, agent={"model": "custom:m", **changes}, access=access)
    return made


def offline(**agent: Any) -> Job:
    (made,) = make_jobs(tasks=["HeatOnStove"], methods=["BASE"], seeds=[0], kitchen={}, agent=agent)
    return made


def test_each_model_is_asked_once_and_none_that_need_not_be(server: ChaosServer, tmp_path: Path) -> None:
    mixed = [job(server.url), job(server.url, planner="ollama:n", max_calls=3), job(server.url, max_calls=9)]
    clients = distinct(by_kind(mixed).values())
    assert sorted(each.endpoint.name for each in clients) == ["custom:m", "ollama:n"]
    assert to_ask(clients, agents.Access(replay=True, cassette="x")) == []
    cassette = Cassette(tmp_path / "c.jsonl", mode="fill")
    access = agents.Access(cassette=str(cassette.path))
    assert len(to_ask(clients, access)) == 2
    client(server.url, cassette=cassette).complete([{"role": "user", "content": "?"}])
    assert [each.endpoint.name for each in to_ask(clients, access)] == ["ollama:n"]
    assert list(by_kind([offline()]).values()) == [{}]


def test_what_a_run_may_cost() -> None:
    costs = Costs({"BASE": {"HeatOnStove": {"planner": Need(1, 1_000_000, 100_000), "checker": Need(5, 5, 5)}}})
    priced = offline(planner="openai:gpt-4o", max_money=3.0)
    told = bill([priced], by_kind([priced]), costs)
    assert (told.jobs, told.most) == (1, 3.0) and told.estimate == pytest.approx(2.5 + 1.0)
    thinking = Need(2, 0, 0).money(resolve("openai:o3").model)
    assert thinking == pytest.approx(2 * resolve("openai:o3").model.reasoning_tokens * 8 / 1e6)
    unknown = job("https://far.example/v1", max_money=3.0)
    told = bill([unknown], by_kind([unknown]), costs)
    assert told.estimate is told.most is None and "$" not in told.told
    assert told.told == (
        "1 job: about 6 calls, 1,000,000 tokens in, 100,000 out, as measured; the cost is unknown (to name the price: "
        "price_in=...,price_out=... behind the model's name, dollars a million tokens), and max_money cannot bound it"
    )
    named = job("https://far.example/v1", model="custom:m,price_in=1,price_out=2")
    told = bill([named] * 3, by_kind([named]), costs)
    assert told.told.startswith("3 jobs: about 18 calls, 3,000,000 tokens in, 300,000 out, as measured: about $3.60, $")
    strange = bill([named], by_kind([named]), Costs({}))
    assert strange.need is None and strange.told.startswith("1 job: calls and tokens were not measured, $")
    own = job("http://127.0.0.1:9/v1")
    assert (bill([own], by_kind([own]), costs).estimate, bill([own], by_kind([own]), costs).most) == (0.0, 0.0)
    local = job("http://127.0.0.1:9/v1", model="ollama:m")
    assert bill([local], by_kind([local]), costs).most == 0.0
    loose = offline(planner="openai:o3", max_tokens=1000)
    assert bill([loose], by_kind([loose]), costs).most == pytest.approx(1000 * 8 / 1e6)
    assert Costs({}).of("BASE", "HeatOnStove") is None
    assert costs.of("BASE", "SomeOther") == costs.of("BASE", "HeatOnStove")


def run(folder: Path, *more: str, url: str, env: dict[str, str] | None = None) -> Result:
    arguments = ("bench", "run", "--out", str(folder), "--tasks", "HeatOnStove", "--methods", "BASE", "--seeds", "0:2")
    models = ("--model", "custom:m", "--base-url", url, "--backend", "symbolic", "--jobs", "0")
    return CliRunner().invoke(app, [*arguments, *models, *more], env=env)


def test_a_run_stops_before_any_job(server: ChaosServer, tmp_path: Path) -> None:
    server.plays(refuses(401, "bad key"))
    result = run(tmp_path, url=server.url)
    assert result.exit_code == 2 and len(server.asked) == 1 and not (tmp_path / "records.jsonl").exists()
    (line,) = (line for line in result.stderr.splitlines() if line.startswith("error:"))
    assert "custom:m: key:" in line and "bad key" in line
    assert run(tmp_path, "--no-preflight", url=server.url).exit_code == 1  # every job is infrastructure
    dead = f"http://127.0.0.1:{free_port()}/v1"
    result = run(tmp_path / "dead", url=dead)
    assert result.exit_code == 2 and dead in result.stderr and not (tmp_path / "dead" / "records.jsonl").exists()


def test_a_run_goes_on_and_counts_the_question_apart(server: ChaosServer, tmp_path: Path) -> None:
    server.plays(says(SEES), says("Plan: [turn on stove]"))
    result = run(tmp_path, url=server.url)
    assert result.exit_code == 0, result.output
    assert "preflight: custom:m: key" in result.stderr and "1 question in" in result.stderr
    assert re.search(r"2 jobs: about 2 calls, [0-9,]+ tokens in, [0-9,]+ out, as measured: about \$0, ", result.stderr)
    assert [record.usage.calls for record in read(tmp_path)] == [1, 1] and len(server.asked) == 3
    assert run(tmp_path, url=server.url).exit_code == 0 and len(server.asked) == 3  # nothing left to play


def test_a_run_by_a_route_of_ones_own(server: ChaosServer, tmp_path: Path) -> None:
    file = tmp_path / "p.toml"
    mine = f'[providers.mine]\ntitle="M"\nbase_url="{server.url}"\nkey="MINE_KEY"\nany_model=true\nimages=false\n'
    file.write_text(mine + "[paper]\no3 = ['openai:o3', 'mine:thinker']\n", "utf-8")
    server.plays(says(PLAIN), says("Plan: [turn on stove]"))
    arguments = ["bench", "run", "--out", str(tmp_path / "out"), "--tasks", "HeatOnStove", "--methods", "BASE,CC"]
    more = ["--seeds", "0", "--backend", "symbolic", "--jobs", "0", "--providers", str(file)]
    reach = ["--model", "o3", "--via", "auto", "--adjuster", "rule", "--conditions", "rule"]
    result = CliRunner().invoke(app, [*arguments, *more, *reach], env={"MINE_KEY": "k", "OPENAI_API_KEY": ""})
    assert result.exit_code == 0, result.output
    for record in read(tmp_path / "out"):
        assert record.options["agent"]["model"] == "mine:thinker"
        assert record.options["access"]["providers"].startswith("p.toml ")
        assert record.usage.unpriced == record.usage.calls > 0
    assert {asked.body["model"] for asked in server.asked} == {"thinker"}
    assert "unknown" in result.stdout or "USD" not in result.stdout
    assert CliRunner().invoke(app, ["bench", "verify", str(tmp_path / "out")]).exit_code == 0


def test_the_doctor_asks(server: ChaosServer) -> None:
    server.plays(refuses(400, "no pictures here"), says(PLAIN))
    ask_for = ["doctor", "--model", "custom:m", "--base-url", server.url]
    result = CliRunner().invoke(app, ask_for)
    assert result.exit_code == 0, result.output
    assert "no pictures here" in result.output.replace("\n", " ") and "2 questions" in result.output
    assert "BASE $0, CC $0" in result.output
    server.plays(refuses(404, "no model m"))
    result = CliRunner().invoke(app, [*ask_for, "--json"])
    assert result.exit_code == 1
    (probe,) = json.loads(result.stdout)
    assert (probe["check"], probe["ok"], probe["fatal"]) == ("model", False, True)
    result = CliRunner().invoke(app, ["doctor", "--model", "o3", "--via", "xai"])
    assert result.exit_code == 2 and "valid: openai:o3, openrouter:openai/o3" in result.stderr
    assert "go with --model" in CliRunner().invoke(app, ["doctor", "--via", "xai"]).stderr


@pytest.mark.parametrize("command", [["plan", "--task", "HeatOnStove"], ["bench", "run", "--out", "never"]])
def test_a_wrong_provider_is_refused_where_no_model_is_asked_too(command: list[str], tmp_path: Path) -> None:
    for flag, told in ((["--via", "opnai"], "unknown via 'opnai'"), (["--providers", str(tmp_path / "no")], "read")):
        result = CliRunner().invoke(app, [*command, *flag])
        assert result.exit_code == 2 and told in result.stderr, result.output


def test_plans_and_experiments_ask_first_too(server: ChaosServer, tmp_path: Path) -> None:
    file = tmp_path / "p.toml"
    mine = f'[providers.mine]\ntitle="M"\nbase_url="{server.url}"\nkey="MINE_KEY"\nany_model=true\n'
    file.write_text(mine + "[paper]\no3 = ['mine:thinker']\n", "utf-8")
    more = ["--planner", "o3,seconds=20", "--providers", str(file), "--via", "auto"]
    trial = ["experiment", "validity", "--tasks", "HeatOnStove", "--n", "1"]
    for command in (["plan", "--task", "HeatOnStove"], trial):
        server.plays(refuses(401, "bad key"))
        result = CliRunner().invoke(app, [*command, *more], env={"MINE_KEY": "k"})
        assert result.exit_code == 2 and "error: mine:thinker: key:" in result.stderr and len(server.asked) == 1
        server.plays(says(SEES), says("Plan: [turn on stove]"))
        result = CliRunner().invoke(app, [*command, *more], env={"MINE_KEY": "k"})
        assert result.exit_code == 0, result.output
        assert "preflight: mine:thinker" in result.stderr and server.asked[1].body["model"] == "thinker"
        server.plays(says("Plan: [turn on stove]"))
        result = CliRunner().invoke(app, [*command, *more, "--no-preflight"], env={"MINE_KEY": "k"})
        assert result.exit_code == 0 and "preflight" not in result.stderr


def test_the_measured_table_can_be_read() -> None:
    for method, tasks in measured().needs.items():
        for task, roles in tasks.items():
            assert all(need.calls > 0 and need.prompt > need.calls for need in roles.values()), (method, task)
