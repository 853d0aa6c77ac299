"""The options of an agent, one row each: the keywords of `remac_agents.make`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from remac_agents.text.options import MOST_SPENT
from remac_env.option_rows import Real, Switch, Whole, Word, check_rows, option, rows
from remac_env.values import python_values

if TYPE_CHECKING:
    from remac_agents.llm import Cassette, Limiter, Manners
    from remac_agents.memory import Memory

_MODEL = (
    "provider:model or provider:model,option=value: it fills every role that speaks and is given to nobody else; the "
    "checker only if the provider lists images, else that is truth."
)


@dataclass(frozen=True, kw_only=True)
class ModelOptions:
    """How an agent uses language models (docs/models.md)."""

    model: str | None = option(None, _MODEL, group="model")
    base_url: str | None = option(
        None, "Address of custom:<model>, such as http://127.0.0.1:8000/v1.", Word(), group="reach"
    )
    providers: str | Path | None = option(
        None, "FILE.toml that adds to the providers that are built in, or overrides them.", group="reach"
    )
    via: str | None = option(
        None, "Provider by which models are reached, or auto: the first route whose key is set.", Word(),
        group="reach",
    )
    cassette: Cassette | str | Path | None = option(
        None, "File of exchanges: replays what it holds, requests the rest and records it.", group="reach"
    )
    replay: bool = option(
        False, "Send no requests: what the cassette does not hold ends an episode unscored.", Switch(),
        group="reach", flag="--replay",
    )  # fmt: skip
    max_calls: int | None = option(None, "Maximum requests per job.", Whole(0, int(MOST_SPENT)), group="budget")
    max_tokens: int | None = option(None, "Maximum tokens per job.", Whole(0, int(MOST_SPENT)), group="budget")
    max_money: float | None = option(None, "Maximum US dollars per job.", Real(0.0, MOST_SPENT), group="budget")
    max_seconds: float | None = option(
        None, "Maximum seconds in requests per job.", Real(0.0, MOST_SPENT), group="budget"
    )
    limiter: Limiter | None = option(
        None, "How many requests may be under way, where several agents share an endpoint.", spoken=False
    )
    manners: Manners | None = option(
        None, "What was learnt of how endpoints want to be asked, where several agents share it.", spoken=False
    )

    def __post_init__(self) -> None:
        """Refuse numbers out of their ranges; NumPy's values become Python's, but those of roles, which read their own.

        Raises:
            OptionError: naming the option, the value and what is valid.
        """
        for name, row in rows(self).items():
            if row.group != "role":
                object.__setattr__(self, name, python_values(getattr(self, name)))
        check_rows(self)

    @property
    def budget(self) -> dict[str, float | None]:
        """The bounds by the names that budgets have for them; None: `remac_agents.models.LIMITS`, none on money."""
        return {name: getattr(self, f"max_{name}") for name in ("calls", "tokens", "money", "seconds")}

    @property
    def given(self) -> bool:
        """Whether any of them is."""
        return any(getattr(self, name) != row.default for name, row in rows(ModelOptions).items())


@dataclass(frozen=True, kw_only=True)
class AgentOptions(ModelOptions):
    """All of them."""

    planner: Any = option(
        None,
        "A name, package.module:Name, path/file.py:Name, http://HOST:PORT/PATH, answers:FILE.json, policy:FILE.npz "
        "or pddl:COMMAND; options as name,option=value.",
        group="role",
    )
    conditions: Any = option(None, "Says what should be true before and after a subtask.", group="role")
    checker: Any = option(None, "Judges whether it is true.", group="role")
    adjuster: Any = option(None, "Repairs a plan.", group="role")
    reflector: Any = option(None, "Says what was learnt.", group="role")
    handover: Any = option(None, "How work is handed to a second robot, and to further ones.", group="role")
    summariser: Any = option(None, "Summarises what happened and why it failed (REFLECT).", group="role")
    retries: int = option(2, "How often a subtask whose post-conditions fail is tried again.", Whole(), group="bound")
    max_adjustments: int = option(20, "Maximum number of changes to a plan.", Whole(), group="bound")
    max_rounds: int = option(60, "Rounds after which a method stops by itself.", Whole(), group="bound")
    lead: str | None = option(
        None, "The robot that works alone or leads; by default the first by name.", Word(), group="robot"
    )
    helper: str | None = option(
        None, "The second robot of a team; by default the first by name of those that do not lead.", Word(),
        group="robot",
    )
    iterations: int | None = option(
        None, "Number of the last iteration: 2 plays 0, 1, 2 (methods that learn, and best-of controls).", Whole()
    )
    memory: Memory | str | Path | None = option(
        None, "A Memory, a path of a JSON-lines file, or None for one in this process.", spoken=False
    )
