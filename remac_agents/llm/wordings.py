"""What a refusal is about, by the words that endpoints use: which field of the request, or how many tokens.

The rules are general on purpose - a name of a field beside a word of refusal, numbers beside words for tokens - since
every endpoint words it differently, and words it anew with every version.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

NO_SYSTEM = (
    r"roles must alternate|system role.{0,20}not supported|only user and assistant roles"
    r"|'user' or 'assistant'.*\(param: messages[^)]{0,20}role\)"
)
"""So servers refuse what the system says whose template of a model's has no place for it, under status 500 too."""

TOKEN_FIELDS = ("max_tokens", "max_completion_tokens", "max_output_tokens", "max_new_tokens")

FIELDS: dict[str, str] = {
    "images": (
        r"images?|image_url|image_urls|pictures?|vision|visual|multi-?modal|mmproj|content.{0,20} must be a string"
        r"|invalid type: sequence"
    ),
    "stream_options": r"stream[_ ]options|include_usage",
    "response_format": (
        r"response[_ ]?formats?|json[_ ]?(?:object|schema|mode|output)|structured[_ ]outputs?|guided\w*|grammar"
        r"|json_validate_failed|failed_generation|generate json"
    ),
    "temperature": r"temperature",
    "seed": r"seed",
    "stream": r"stream|streaming|streamed",
    "system": (
        r"system[_ ](?:role|message|prompt|instruction)s?|role[^a-z]{1,3}system|['\"`]system['\"`]"
        r"|developer instruction"
    ),
}
"""Field of a request -> how endpoints speak of it."""

_REFUSING = re.compile(
    r"support|unrecogni[sz]ed|not recogni[sz]ed|unknown|unexpected|permit|not allowed|only allowed|forbidden"
    r"|extra (?:inputs|fields)|extra_forbidden|invalid|not valid|unavailable|not available|accept|only the default|must"
    r"|should|cannot|can't|can not|not a |isn't|not enabled|disabled|not implemented|deprecated|incompatible|compatible"
    r"|removed|failed to|expected|reject|illegal|no endpoints found|do(?:es)? not exist|additional propert|not be used"
    r"|not used|ignored|at most|limited to|restricted|verified|not one of"
)
_SIZE = re.compile(
    r"too (?:large|big|high|many|long)|at most|maximum|exceed|range|less than|smaller than|<=|\u2264|limit|greater than"
    r"|larger than|more than|no more|at least|upper bound|up to|between|above|below|\bmax\b|> \d|less or equal"
)
_LEAST = re.compile(r"minimum|at least|must be (?:greater|larger|more) than|too (?:small|low|few)|>=|\u2265")
_MOST = re.compile(
    r"too (?:large|big|high|many|long)|at most|maximum|exceed|range|less than|<=|\u2264|limit|between|up to"
)
_MUCH = re.compile(r"too (?:large|big|high|many)|(?<!be )(?:greater|larger|more) than")
_SPOKEN = re.compile(r"\bmax_?(output|completion|new)?_?tokens\b")
_OTHER = re.compile(r"instead|deprecated|renamed|replaced|unsupported parameter|\buse ['\"`]?max_")
_NUMBER = r"(\d{1,3}(?:[,_]\d{3})+|\d+)"
_CONTEXT = (
    rf"(?:context(?: length| window| size| limit)?|max_model_len|sequence length)[^\d.;]{{0,40}}?{_NUMBER}",
    rf"n_ctx\W{{1,3}}{_NUMBER}",
    rf"maximum (?:model length of|allowed length|prompt length is|number of tokens allowed|input tokens\W)"
    rf"\W{{0,3}}{_NUMBER}",
    rf"{_NUMBER} maximum context",
    rf"{_NUMBER}[- ]tokens? (?:context|window)",
    rf"(?:limit|maximum)(?: of| is)? {_NUMBER} tokens",
)
_PROMPT = (
    rf"n_prompt_tokens\W{{1,3}}{_NUMBER}",
    rf"{_NUMBER} `?(?:input|prompt)s?`? tokens",
    rf"(?:requested tokens|request|input token count)(?: contains)? \(?{_NUMBER}",
    rf"{_NUMBER} (?:tokens )?(?:in|from) (?:the|your) (?:messages|prompt|input)",
    rf"(?:input|prompt|messages) \((?:length )?{_NUMBER}",
    rf"(?:messages resulted in|(?:prompt|input)(?: tokens)?(?: \w+){{0,3}}? (?:contains|has|is|of|with)(?: at least)?"
    rf"|(?:prompt|input) (?:is too long|too long|tokens|length)\W{{1,3}})\s*{_NUMBER}",
)
_OF_INPUT = rf"{_NUMBER} of (?:\w+) input"
_SUM = rf"{_NUMBER} \+ {_NUMBER} > {_NUMBER}"
_SUM_AT_MOST = rf"tokens \+ [`'\w]+ must be (?:<=|at most|less than or equal to) `?{_NUMBER}"


@dataclass(frozen=True)
class Told:
    """Tokens of which a refusal speaks. None: it does not. `at_least`: the prompt may have more.

    Attributes:
        context: of prompt and answer together.
        prompt: of the prompt.
        bound: the largest answer that may be asked for.
    """

    context: int | None = None
    prompt: int | None = None
    bound: int | None = None
    at_least: bool = False


def speaks_of(text: str, field: str) -> int | None:
    """Where a text, in small letters, speaks of a field; None if it does not."""
    words = FIELDS.get(field) or re.escape(field.casefold())
    named = re.search(r"\(param: ([^)]*)\)", text)
    if named is not None and re.fullmatch(rf"(?:\w+\W+)*?(?:{words})(?:\W.*)?", named[1]):
        return -1  # what the endpoint gives as the field comes before whatever its message mentions besides
    found = re.search(rf"(?<![\w-])(?:{words})(?![\w-])", text)
    return None if found is None else found.start()


def refuses(text: str) -> bool:
    """Whether a text says in some way that something is not taken."""
    return _REFUSING.search(text) is not None


def first_named(text: str, fields: Iterable[str]) -> str | None:
    """The field that a text names first."""
    places = {field: place for field in fields if (place := speaks_of(text, field)) is not None}
    return min(places, key=lambda field: places[field]) if places else None


def is_about_size(text: str) -> bool:
    """Whether a text is about the number of tokens."""
    named = _SPOKEN.search(text) is not None
    named = named or re.search(r"(?:completion|output|generated|new|max|maximum) tokens", text) is not None
    return named and _SIZE.search(text) is not None


def is_too_much(text: str) -> bool:
    """Whether a text says that the answer asked for is too long, without saying how long it may be."""
    return is_about_size(text) and _MUCH.search(text) is not None


def other_name(text: str, field: str) -> str | None:
    """The name by which an endpoint wants the bound on an answer, where it refuses `field`; "" where it tells none."""
    if speaks_of(text, field) is None or re.search(r"too (?:large|big|high)|context", text):
        return None
    others = [name for name in TOKEN_FIELDS if name != field and speaks_of(text, name) is not None]
    if others and _OTHER.search(text):
        return others[0]
    return "" if refuses(text) and not _SIZE.search(text) else None


def tokens_told(text: str, sent: int) -> Told:
    """The numbers of tokens in a refusal of a request that asked for an answer of `sent` tokens."""
    context, prompt = _first(_CONTEXT, text), _first(_PROMPT, text)
    if (found := re.search(_SUM, text)) is not None:
        return Told(_number(found[3]), _number(found[1]))
    if (found := re.search(_SUM_AT_MOST, text)) is not None:
        return Told(_number(found[1]), prompt)
    parts = [_number(part) for part in re.findall(_OF_INPUT, text)]
    prompt = sum(parts) if parts else prompt
    bound = None
    tight = re.search(rf"limit:? {_NUMBER}, requested:? {_NUMBER}", text)
    if tight is not None:
        limit, requested = _number(tight[1]), _number(tight[2])
        return Told(limit, requested - sent if sent < requested else None)
    least = _LEAST.search(text) is not None and _MOST.search(text) is None
    if is_about_size(text) and not least and not ("context" in text and context is not None):
        # Whatever number is less than what was asked for, in a text about its size, is the bound.
        numbers = [_number(found) for found in re.findall(rf"(?<![\w.-]){_NUMBER}(?![\w-]|\.\d)", text)]
        smaller = [number for number in numbers if 1 < number < sent and number != prompt]
        bound = max(smaller, default=None)
        if bound is not None and f"{bound} (exclusive)" in text:
            bound -= 1
    return Told(context, prompt, bound, "at least" in text)


def _first(patterns: Iterable[str], text: str) -> int | None:
    for pattern in patterns:
        if (found := re.search(pattern, text)) is not None:
            return _number(found[1])
    return None


def _number(text: str) -> int:
    return int(text.replace(",", "").replace("_", "")[:12])
