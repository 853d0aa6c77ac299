"""A submission: a folder with records, the cassettes and provider files that play them again, and entry.toml."""

from __future__ import annotations

import hashlib
import json
import shutil
import tomllib
import unicodedata
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

from remac_agents.llm.resolving import load
from remac_bench.errors import StorageError, UsageError
from remac_bench.playing import agents
from remac_bench.playing.code import code_digest
from remac_bench.playing.machine import versions
from remac_bench.proof.again import outsiders
from remac_bench.records import Record
from remac_bench.store import FILE, Store
from remac_env.files import prepare_folder, read_text

ENTRY = "entry.toml"
FORMAT = 1
CASSETTE = "cassette.jsonl"
PROVIDERS = "providers.toml"
FILES = (FILE, CASSETTE, PROVIDERS)
"""What a submission may hold beside entry.toml."""

CANARY = "REMAC Kitchen benchmark record. Not for training: remac-kitchen-canary-6b1f9c52-0d3e-4a77-9d0e-8c5a2f41e7b3"
"""Stands in every submission, so that those who train models can leave it out, and others can find out who did not."""

Kind = Literal["standard", "custom"]
KINDS: tuple[str, ...] = Kind.__args__  # type: ignore[attr-defined]
"""standard: methods of this project as they are; custom: with providers of one's own."""

NAME_MAX = 60

NOT_ASKED_AGAIN = (
    "code from outside, programs, files, addresses and people cannot be asked again by whoever accepts a submission; "
    "valid: this project's roles, and language models with --cassette"
)


@dataclass(frozen=True, kw_only=True)
class Entry:
    """What entry.toml says.

    Attributes:
        name, contact, kind: who enters, where to ask, and one of KINDS.
        code: digest of the code that played it. `suite`: its name, version and digest, joined; "" for none.
        models: the language models that were asked.
        files: file name -> SHA-256.
    """

    name: str
    contact: str
    kind: str
    code: str
    suite: str
    models: tuple[str, ...]
    files: Mapping[str, str]


def pack(
    folder: str | Path,
    out: str | Path,
    *,
    name: str,
    contact: str = "",
    kind: str = "standard",
    cassette: str | Path | None = None,
    providers: str | Path | None = None,
) -> Entry:
    """Copy a run and what plays it again into a new folder.

    Args:
        folder: the --out of a run. `out`: a folder that does not exist, or is empty.
        cassette: of the models' answers; None: the file that the records name, in `folder`.
        providers: the --providers file of the run, if there was one.

    Raises:
        UsageError: for a run that could not be accepted, before anything is written.
        StorageError: if the folder cannot be written.
    """
    records = Store(folder).read()
    if not records:
        raise UsageError(f"no records in {str(folder)!r}; give the --out of a `remac bench run`")
    _check_words(name, contact, kind)
    if reasons := list(refused(agents_of(records), providers)):
        raise UsageError(f"this run cannot be accepted: {reasons[0]}")
    models = _models(records, providers)
    sources: dict[str, Path] = {FILE: Store(folder).path}
    if models:
        sources[CASSETTE] = _found_cassette(Path(folder), records, cassette)
    if providers is not None:
        sources[PROVIDERS] = Path(providers)
    target = Path(out)
    if target.is_dir() and any(target.iterdir()):
        raise UsageError(f"{str(target)!r} is not empty; give a new folder")
    entry = Entry(
        name=name,
        contact=contact,
        kind=kind,
        code=records[0].versions.get("code", ""),
        suite=_suite(records),
        models=models,
        files={file: _sha256(path) for file, path in sources.items()},
    )
    prepare_folder(target, "--out")
    try:
        for file, path in sources.items():
            shutil.copyfile(path, target / file)
        (target / ENTRY).write_text(_written(entry), "utf-8")
    except OSError as error:
        raise StorageError(f"{target}: {error.strerror or error}; make room, or give another folder") from error
    return entry


def read_entry(folder: str | Path) -> Entry:
    """A submission's entry.toml, with its files as they are listed.

    Raises:
        UsageError: for a file that is missing, malformed, or of another format.
    """
    path = Path(folder) / ENTRY
    if path.is_symlink() or (path.exists() and not path.is_file()):
        raise UsageError(f"{path} is no file of this folder; `remac bench submit` writes one")
    try:
        data = tomllib.loads(read_text(path))
    except (OSError, tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UsageError(f"{path} cannot be read: {error}; `remac bench submit` writes it") from error
    if data.get("format") != FORMAT:
        raise UsageError(f"{path}: format {data.get('format')!r} is not valid; valid: {FORMAT}")
    texts = {key: data.get(key) for key in ("name", "contact", "kind", "code", "suite")}
    files, models = data.get("files"), data.get("models", [])
    wrong = [key for key, value in texts.items() if not isinstance(value, str)]
    if wrong or not isinstance(files, dict) or FILE not in files or not isinstance(models, list):
        raise UsageError(f"{path}: {', '.join(wrong) or 'files'} is missing or no text; `remac bench submit` writes it")
    _check_words(str(texts["name"]), str(texts["contact"]), str(texts["kind"]))
    if not set(files) <= set(FILES):
        raise UsageError(f"{path}: files {sorted(set(files) - set(FILES))} are not valid; valid: {', '.join(FILES)}")
    listed = {str(file): str(value) for file, value in files.items()}
    return Entry(**texts, models=tuple(map(str, models)), files=listed)  # type: ignore[arg-type]


def changed_files(folder: str | Path, entry: Entry) -> list[str]:
    """Files of a submission that are not as entry.toml lists them: links too, which may change later, and those that
    it does not list, though they would be read."""
    return [file for file in FILES if _digest(Path(folder) / file) != entry.files.get(file)]


def _digest(path: Path) -> str | None:
    """The SHA-256 of a file, "" of what is none, None where nothing is."""
    if not path.exists() and not path.is_symlink():
        return None
    return _sha256(path) if path.is_file() and not path.is_symlink() else ""


def submission_digest(entry: Entry) -> str:
    """A name for a submission, all that it says of itself and its files, by which an acceptance knows it again."""
    told = json.dumps(asdict(entry), sort_keys=True)
    return hashlib.sha256(told.encode()).hexdigest()


def refused(entries: Sequence[Mapping[str, Any]], providers: str | Path | None) -> Iterator[str]:
    """Why a run of these agents can never be accepted, whatever its scores.

    Args:
        providers: its file of providers.

    Raises:
        OptionError: for such a file that is not valid.
    """
    told = None if providers is None else str(providers)
    for who in sorted({who for agent in entries for who in outsiders(agent, providers=told)}):
        yield f"{who}: {NOT_ASKED_AGAIN}"
    known, own = load().providers, load(told).providers
    if changed := [name for name in known if own.get(name) != known[name]]:
        yield f"{PROVIDERS} changes {', '.join(changed)}, which others know; valid: providers of another name"


def agents_of(records: Sequence[Record]) -> list[Mapping[str, Any]]:
    """The agents of records, each once."""
    return list({str(agent): agent for record in records if (agent := record.options.get("agent", {}))}.values())


def _models(records: Sequence[Record], providers: str | Path | None) -> tuple[str, ...]:
    told = None if providers is None else str(providers)
    return tuple(sorted({m for agent in agents_of(records) for m in agents.asked_models(agent, providers=told)}))


def _found_cassette(folder: Path, records: Sequence[Record], given: str | Path | None) -> Path:
    names = {str(record.options.get("access", {}).get("cassette") or "") for record in records}
    here = [folder / name for name in sorted(names) if name]
    path = Path(given) if given is not None else next((each for each in here if each.is_file()), None)
    if path is None or not path.is_file():
        raise UsageError(
            "the models' answers are missing: a run that is to be submitted needs --cassette FILE from the start; "
            "give that file to submit as --cassette"
        )
    return path


def _suite(records: Sequence[Record]) -> str:
    record = records[0]
    return "" if record.suite is None else f"{record.suite} {record.suite_version} {record.suite_digest}"


def _check_words(name: str, contact: str, kind: str) -> None:
    if not looks(name) or len(name) > NAME_MAX or not name.isprintable() or set(name) & set(_BLANK):
        raise UsageError(f"name {name[:80]!r} is not valid; valid: 1 to {NAME_MAX} printable characters")
    if len(_alphabets(name)) > 1:
        raise UsageError(f"name {name!r} is not valid; valid: letters of one alphabet, so that no two names look alike")
    if len(contact) > 200 or not contact.isprintable():
        raise UsageError("contact is not valid; valid: at most 200 printable characters")
    if kind not in KINDS:
        raise UsageError(f"kind {kind!r} is not valid; valid: {', '.join(KINDS)}")


def looks(name: str) -> str:
    """What two names have in common that look alike: without case, spaces, accents and forms of the same letters."""
    plain = unicodedata.normalize("NFD", unicodedata.normalize("NFKC", name).translate(_LIKE_LATIN).casefold())
    seen = "".join(letter for letter in plain if unicodedata.category(letter) not in _NOT_SEEN)
    return seen.translate(_LIKE_EACH_OTHER).replace("rn", "m").replace("vv", "w")


_LIKE_LATIN = str.maketrans(
    "\u0410\u0412\u0415\u041a\u041c\u041d\u041e\u0420\u0421\u0422\u0423\u0425\u0406\u0408\u0405"
    "\u0430\u0435\u043e\u0440\u0441\u0443\u0445\u0456\u0458\u0455\u04bb\u0501\u051b\u051d"
    "\u0391\u0392\u0395\u0396\u0397\u0399\u039a\u039c\u039d\u039f\u03a1\u03a4\u03a5\u03a7"
    "\u03bf\u03bd\u03b1\u03c1\u03c5\u03b3\u0131",
    "ABEKMHOPCTYXIJS" "aeopcyxijshdqw" "ABEZHIKMNOPTYX" "ovapuyi",
)
"""Letters of the Cyrillic and the Greek alphabet, and a dotless i -> the Latin ones that look like them."""

_LIKE_EACH_OTHER = str.maketrans("01i|", "olll")
_NOT_SEEN = ("Mn", "Me", "Lm", "Sk", "Zs", "Cf")
_BLANK = "\u115f\u1160\u2800\u3164\uffa0"
"""Letters and a symbol, by their category, of which nothing is seen."""


def _alphabets(name: str) -> set[str]:
    """Of the alphabets whose letters look alike those in which a name is written."""
    words = {unicodedata.name(letter, "").partition(" ")[0] for letter in unicodedata.normalize("NFKC", name)}
    return words & {"LATIN", "GREEK", "CYRILLIC", "ARMENIAN", "CHEROKEE", "COPTIC", "DESERET", "LISU"}


def _written(entry: Entry) -> str:
    def text(value: str) -> str:
        return json.dumps(value, ensure_ascii=False)

    head = {"name": entry.name, "contact": entry.contact, "kind": entry.kind, "code": entry.code, "suite": entry.suite}
    lines = [f"# {CANARY}", f"format = {FORMAT}", *(f"{key} = {text(value)}" for key, value in head.items())]
    lines += [f"models = [{', '.join(map(text, entry.models))}]", "", "[versions]"]
    lines += [f"{text(key)} = {text(value)}" for key, value in {**versions(), "submitted with": code_digest()}.items()]
    lines += ["", "[files]", *(f"{text(file)} = {text(value)}" for file, value in entry.files.items()), ""]
    return "\n".join(lines)


def _sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
