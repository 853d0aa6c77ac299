"""Language models over OpenAI-compatible endpoints: a client, its providers, budgets and cassettes.

with ChatClient("openai:gpt-4o", budget=Budget(calls=100, money=2.0)) as client:
    reply = client.complete([{"role": "user", "content": "..."}], max_tokens=500)
    if isinstance(reply, ChatError):
        ...  # reply.kind is one of KINDS; reply.infrastructure: not the model's fault
"""

from __future__ import annotations

from remac_agents.llm.adapting import Manners
from remac_agents.llm.budget import Budget, Spent
from remac_agents.llm.cassette import Cassette
from remac_agents.llm.client import ChatClient
from remac_agents.llm.limiter import Limiter
from remac_agents.llm.outcomes import KINDS, Bill, ChatError, ChatReply
from remac_agents.llm.providers import Catalogue, Endpoint, Model, Provider
from remac_agents.llm.redaction import file_name, plain
from remac_agents.llm.request import Picture
from remac_agents.llm.resolving import load, resolve, route
from remac_agents.llm.settings import ModelSettings, plain_model_name, read_model_name, read_settings
from remac_agents.text.json_text import Answer, BadAnswer, read_json

__all__ = [
    "KINDS",
    "Answer",
    "BadAnswer",
    "Bill",
    "Budget",
    "Cassette",
    "Catalogue",
    "ChatClient",
    "ChatError",
    "ChatReply",
    "Endpoint",
    "Limiter",
    "Manners",
    "Model",
    "ModelSettings",
    "Picture",
    "Provider",
    "Spent",
    "file_name",
    "load",
    "plain",
    "plain_model_name",
    "read_json",
    "read_model_name",
    "read_settings",
    "resolve",
    "route",
]
