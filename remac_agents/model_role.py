"""What roles filled by a language model have in common: whom they ask, how, and what becomes of a bad answer."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from remac_agents.llm import BadAnswer, ChatReply, Picture, read_json
from remac_agents.llm.settings import read_settings
from remac_agents.models import Models
from remac_agents.prompt import Message, load

ANSWERS = 2
"""How often a question is put: an answer that cannot be read is sent back once, with what is wrong with it."""

JSON = {"type": "json_object"}

Shape = TypeVar("Shape", bound=BaseModel)
T = TypeVar("T")


class ModelRole:
    """Base of the roles. `role` is the name under which its questions are recorded.

    Args:
        model: `provider:model`, or a name of the paper's models.
        models: the agent's; None: its own.
        options: those of `llm.ModelSettings`; `extra.NAME` for further fields of requests.

    Raises:
        UnknownNameError, OptionError: for a model, option or address that is not valid.
    """

    role = ""
    needs_truth = False

    def __init__(self, model: str, *, models: Models | None = None, **options: Any) -> None:
        self.models = models or Models()
        self.client = self.models.client(model, read_settings(options))
        self.open()

    def open(self) -> None:
        """What a role asks of its model; most ask nothing.

        Raises:
            OptionError: for a model that cannot fill it.
        """

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.client.endpoint.name!r})"

    def say(
        self,
        messages: Sequence[Message],
        *,
        about: str = "",
        images: Sequence[Picture] = (),
        form: Mapping[str, Any] | None = None,
    ) -> str | BadAnswer:
        """The model's answer to one question, or why there is none.

        Raises:
            StopEpisode: see `Models.ask`.
        """
        reply = self.models.ask(self.client, self.role, messages, about=about, images=images, response_format=form)
        return reply.text if isinstance(reply, ChatReply) else BadAnswer(f"{reply.kind}: {reply.detail}")

    def ask(
        self,
        prompt: str,
        fields: Mapping[str, str],
        read: Callable[[str], T | BadAnswer],
        *,
        about: str = "",
        images: Sequence[Picture] = (),
        form: Mapping[str, Any] | None = JSON,
    ) -> T | BadAnswer:
        """The answer as `read` reads it. One that it cannot read is sent back once; then the problem is noted.

        Raises:
            StopEpisode: see `Models.ask`.
        """
        messages = load(prompt).messages(fields)
        problem = BadAnswer("")
        for _ in range(ANSWERS):
            text = self.say(messages, about=about, images=images, form=form)
            if isinstance(text, BadAnswer):
                problem = text
                break  # the client has asked as often as helps
            answer = read(text)
            if not isinstance(answer, BadAnswer):
                return answer
            problem = answer
            (_, again) = load("again").messages({"problem": answer.problem})
            messages = [*messages, {"role": "assistant", "content": text}, again]
        self.models.page.errors.append(f"{self.role}: {problem.problem}")
        return problem


def reads(shape: type[Shape]) -> Callable[[str], Shape | BadAnswer]:
    """A reader of JSON objects of this shape; fields beyond it are passed over."""

    def read(text: str) -> Shape | BadAnswer:
        answer = read_json(text)
        if isinstance(answer, BadAnswer):
            return answer
        try:
            return shape.model_validate(answer.value, strict=True)
        except ValidationError as error:
            found = error.errors(include_url=False, include_input=False, include_context=False)
            told = "; ".join(f"{'.'.join(map(str, each['loc'])) or 'the answer'}: {each['msg']}" for each in found[:3])
            return BadAnswer(f"{told}; valid: a JSON object with {', '.join(shape.model_fields)}")

    return read
