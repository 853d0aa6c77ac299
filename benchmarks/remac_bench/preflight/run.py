"""Which models a run asks, and what it may cost."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from remac_agents.llm import Cassette, ChatClient, Model
from remac_agents.prompting.models import LIMITS
from remac_bench.playing import agents
from remac_bench.playing.jobs import Job
from remac_bench.playing.shared import make
from remac_bench.preflight.estimates import Costs, Need
from remac_bench.prices import PRICE_OPTIONS, UNKNOWN, dollars

PAPER_METHODS = ("BASE", "CC", "RE", "REMAC")

Filled = Mapping[str, ChatClient]
"""Role -> the client of the model that fills it."""


@dataclass(frozen=True)
class Bill:
    """What jobs cost, US dollars; None: not known.

    Attributes:
        jobs: how many.
        estimate: by the tokens that episodes were measured to take.
        most: what their budgets allow.
        bound: what bounds them, in words.
        need: the calls and tokens that they are expected to take, thoughts included; None: not measured.
    """

    jobs: int
    estimate: float | None
    most: float | None
    bound: str
    need: Need | None = None

    @property
    def told(self) -> str:
        """One line."""
        jobs = f"{self.jobs} job{'s' * (self.jobs != 1)}"
        if self.need is None:
            takes = "calls and tokens were not measured"
        else:
            takes = f"about {_about(self.need.calls)} calls, {_about(self.need.prompt)} tokens in, "
            takes += f"{_about(self.need.completion)} out, as measured"
        if self.most is None:
            return f"{jobs}: {takes}; the cost is {UNKNOWN} ({PRICE_OPTIONS}), and max_money cannot bound it"
        cost = "" if self.estimate is None else f": about {dollars(self.estimate)}"
        return f"{jobs}: {takes}{cost}, {dollars(self.most)} at most ({self.bound})"


def filled_by_models(job: Job) -> Filled:
    """The roles of a job's agent that language models fill; nothing is asked, and no cassette opened.

    Raises:
        UnknownNameError, OptionError: see `remac_agents.make`.
    """
    access = job.access
    if not agents.asked_models(job.agent, providers=access.providers):
        return {}
    agent: Any = make(job, {"base_url": access.base_url, "providers": access.providers})
    return clients_of(agent.roles.named())


def clients_of(roles: Mapping[str, object]) -> Filled:
    """Those of these roles that ask a language model."""
    found = {name: getattr(role, "client", None) for name, role in roles.items()}
    return {name: client for name, client in found.items() if isinstance(client, ChatClient)}


def by_kind(jobs: Iterable[Job]) -> dict[tuple[str, str], Filled]:
    """Each kind of agent among the jobs, as `kind` names it -> the roles that models fill."""
    found: dict[tuple[str, str], Filled] = {}
    for job in jobs:
        if kind(job) not in found:
            found[kind(job)] = filled_by_models(job)
    return found


def kind(job: Job) -> tuple[str, str]:
    """Equal for jobs whose agents are."""
    return job.method, repr((sorted(job.agent.items()), job.access))


def distinct(kinds: Iterable[Filled]) -> list[ChatClient]:
    """One client for every model, address and way of asking it."""
    found = {repr((c.endpoint, c.settings)): c for filled in kinds for c in filled.values()}
    return list(found.values())


def to_ask(clients: Sequence[ChatClient], access: agents.Access) -> list[ChatClient]:
    """Those that may have to be asked at all: none in a replay, and none for which the cassette holds answers."""
    if access.replay:
        return []
    if access.cassette is None or not Path(access.cassette).is_file():
        return list(clients)
    known = Cassette(access.cassette, mode="replay").models
    return [client for client in clients if client.endpoint.name not in known]


def bill(jobs: Sequence[Job], kinds: Mapping[tuple[str, str], Filled], costs: Costs) -> Bill:
    """What jobs with models cost; those without cost nothing and are not counted."""
    asking = [job for job in jobs if kinds[kind(job)]]
    estimates = [_estimate(job, kinds[kind(job)], costs) for job in asking]
    bounds = [_most(job, kinds[kind(job)]) for job in asking]
    words = list(dict.fromkeys(told for _, told in bounds))
    return Bill(
        len(asking),
        _sum(estimates),
        _sum([most for most, _ in bounds]),
        " or ".join(words) if words else "no budget",
        _needed([_need(job, kinds[kind(job)], costs) for job in asking]),
    )


def episodes_told(model: Model, costs: Costs) -> str:
    """What an episode of each of the paper's methods costs with a model, a mean over tasks."""
    told = []
    for method in PAPER_METHODS:
        needs = [costs.whole(method, task, images=model.images) for task in costs.needs.get(method, {})]
        whole = sum((need for need in needs if need is not None), Need())
        money = whole.times(1 / len(needs)).money(model) if needs else None
        told.append(f"{method} {dollars(money)}")
    return f"about {', '.join(told)} an episode, by measured tokens"


def _estimate(job: Job, filled: Filled, costs: Costs) -> float | None:
    takes = _takes(job, filled, costs)
    if takes is None:
        return None
    return _sum([takes[role].money(client.endpoint.model) for role, client in filled.items()])


def _need(job: Job, filled: Filled, costs: Costs) -> Need | None:
    """What all roles of a job take together, with what its models think."""
    takes = _takes(job, filled, costs)
    if takes is None:
        return None
    thought = {role: takes[role].answers(client.endpoint.model) for role, client in filled.items()}
    return sum((Need(need.calls, need.prompt, thought[role]) for role, need in takes.items()), Need())


def _takes(job: Job, filled: Filled, costs: Costs) -> dict[str, Need] | None:
    """Role -> what it takes in all iterations; None where the method was not measured."""
    needs = costs.of(job.method, job.task)
    if needs is None:
        return None
    return {role: needs.get(role, Need()).times(job.iterations + 1) for role in filled}


def _needed(parts: Sequence[Need | None]) -> Need | None:
    known = [part for part in parts if part is not None]
    return sum(known, Need()) if len(known) == len(parts) else None


def _about(number: float) -> str:
    """A count with two digits that matter."""
    digits = len(str(round(number)))
    return f"{round(number, min(0, 2 - digits)):,.0f}"


def _most(job: Job, filled: Filled) -> tuple[float | None, str]:
    """What a job's budget allows, and what bounds it."""
    models = [client.endpoint.model for client in filled.values()]
    dearest = [_dearest(model) for model in models]
    money = job.agent.get("max_money")
    if all(price == 0 for price in dearest):
        return 0.0, "the models are free"
    if any(price is None for price in dearest):
        return None, "a price is unknown, so that no bound on money holds"
    if money is not None:
        return float(money), f"max_money {dollars(float(money))} a job"
    tokens = float(job.agent.get("max_tokens") or LIMITS["tokens"])
    return tokens * max(price or 0.0 for price in dearest) / 1e6, f"max_tokens {tokens:.0f} a job, no max_money"


def _dearest(model: Model) -> float | None:
    if model.price_in is None or model.price_out is None:
        return None
    return max(model.price_in, model.price_out)


def _sum(parts: Sequence[float | None]) -> float | None:
    return None if any(part is None for part in parts) else sum(part or 0.0 for part in parts)
