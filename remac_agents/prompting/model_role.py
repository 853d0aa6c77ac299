"""What roles filled by a language model have in common: whom they ask, how, and what becomes of a bad answer."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from remac_agents.llm import BadAnswer, ChatReply, Picture, read_json
from remac_agents.llm.settings import read_settings
from remac_agents.prompting import wording
from remac_agents.prompting.models import Models
from remac_agents.prompting.prompt import Message, load
from remac_agents.roles import ANSWERS
from remac_agents.text.shapes import shape_problems

MOST_PROBLEMS = 12
"""Problems of the shape of one answer that are told."""

LONGEST = 8000
"""Characters of a refused answer that are sent back, its end, where plans and JSON stand."""

JSON = {"type": "json_object"}

Shape = TypeVar("Shape", bound=BaseModel)
T = TypeVar("T")


class ModelRole:
    """Base of the roles. `role` is the name under which its questions are recorded.

    `asks_once`: a question - the same words and pictures - that was answered in this episode is not put again but
    answered as before. False where another answer is wanted.

    Args:
        model: `provider:model`, or a name of the paper's models.
        models: the agent's; None: its own.
        options: those of `llm.ModelSettings`; `extra.NAME` for further fields of requests.

    Raises:
        UnknownNameError, OptionError: for a model, option or address that is not valid.
    """

    role = ""
    needs_truth = needs_rules = False
    asks_once = True

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
        """The answer as `read` reads it. One that it cannot read is sent back; at last the problem is noted.

        Raises:
            StopEpisode: see `Models.ask`.
        """
        messages = load(prompt).messages(fields)
        question = self._question(messages, images)
        told = self.models.answered(question)
        if told is not None and not isinstance(again := read(told), BadAnswer):
            return again
        problem = BadAnswer("")
        for _ in range(ANSWERS):
            text = self.say(messages, about=about, images=images, form=form)
            if isinstance(text, BadAnswer):
                problem = text
                break  # the client has asked as often as is useful
            answer = read(text)
            if not isinstance(answer, BadAnswer):
                self.models.keep(question, text)
                return answer
            problem = answer
            messages = sent_back(messages, text, [answer.problem])
        self.models.page.errors.append(f"{self.role}: {problem.problem}")
        return problem

    def _question(self, messages: Sequence[Message], images: Sequence[Picture]) -> str:
        """What is the same for the same question, "" for one that is put each time."""
        if not self.asks_once:
            return ""
        asked = [(message["role"], message["content"]) for message in messages]
        return repr((self.client.endpoint.name, self.role, asked, [picture.digest for picture in images]))


def sent_back(messages: Sequence[Message], answer: str, problems: Sequence[str]) -> list[Message]:
    """A dialogue with an answer that was of no use, and the question again with all that is wrong with it."""
    (_, again) = load("again").messages({"problems": wording.bullets(problems)})
    cut = answer if len(answer) <= LONGEST else f"[...] {answer[-LONGEST:]}"
    return [*messages, {"role": "assistant", "content": cut or "(no answer)"}, again]


def reads(
    shape: type[Shape], also: Callable[[Mapping[str, Any]], Iterable[str]] | None = None
) -> Callable[[str], Shape | BadAnswer]:
    """A reader of JSON objects of this shape; fields beyond it are passed over.

    Args:
        also: further problems of an object, whose fields may be of any type or missing; told along with those of its
            shape, so that all are mended at once.
    """

    def read(text: str) -> Shape | BadAnswer:
        answer = read_json(text)
        if isinstance(answer, BadAnswer):
            return answer
        found: Shape | None = None
        problems: list[str] = []
        try:
            found = shape.model_validate(answer.value, strict=True)
        except ValidationError as error:
            problems = shape_problems(error, shape)[:MOST_PROBLEMS]
            problems.append(f"valid: a JSON object with {', '.join(shape.model_fields)}")
        if also is not None and isinstance(answer.value, Mapping):
            problems = [*also(answer.value), *problems]
        return BadAnswer("; ".join(problems)) if found is None or problems else found

    return read


def texts_in(value: Mapping[str, Any], name: str) -> list[str]:
    """The texts of a list that an object may have under this name."""
    given = value.get(name)
    return [text for text in given if isinstance(text, str)] if isinstance(given, list) else []
