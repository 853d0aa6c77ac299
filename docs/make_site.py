"""Builds the site from README, docs, examples and docstrings: `make docs`, or

    python docs/make_site.py [--stage FOLDER]

Pages are Markdown that is read in the repository as well. Here they are put side by side, with links to match; each
example becomes a page, each public module a page of the reference, and the commands one. Zensical builds the site from
these; it takes `mkdocs.yml`, which has the order of pages. With --stage they are only put into that folder.
"""

from __future__ import annotations

import argparse
import ast
import posixpath
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
STAGE = ROOT / "build" / "pages"
SITE = ROOT / "build" / "site"

REFERENCE = {
    "environment": ("Making environments", (
        "remac_env", "remac_env.envs.parallel", "remac_env.envs.gym_view", "remac_env.envs.aec", "remac_env.options",
        "remac_env.vocabulary", "remac_env.errors",
    )),
    "integrations": ("Integrations", ("remac_env.integrations.sb3",)),
    "state": ("State and skills", ("remac_env.state", "remac_env.rules.scene", "remac_env.rules.outcomes",
              "remac_env.rules.conditions", "remac_env.rules.predicates", "remac_env.start")),
    "tasks": ("Tasks", ("remac_env.tasks.spec", "remac_env.tasks.goals", "remac_env.tasks.compound",
              "remac_env.tasks.setup", "remac_env.rules.facts")),
    "testing": ("Checks for environments", ("remac_env.testing",)),
    "oracle": ("Exact search", ("remac_env.oracle",)),
    "agents": ("Agents", ("remac_agents", "remac_agents.options", "remac_agents.report", "remac_agents.memory",
               "remac_agents.plan", "remac_agents.planners.policy_file")),
    "roles": ("Roles", ("remac_agents.roles",)),
    "methods": ("Methods", ("remac_agents.methods",)),
    "llm": ("Language models", ("remac_agents.llm",)),
    "bench": ("Records and judging", ("remac_bench.records", "remac_bench.store", "remac_bench.metrics",
              "remac_bench.judging", "remac_bench.board")),
}  # fmt: skip
"""Pages of the reference: title, and the modules from which users import."""

_LINK = re.compile(r"(\]\()(?!https?:|#|mailto:)([^)\s#]+)(#[^)\s]*)?(\))")
_FENCED = re.compile(r"(^```.*?^```$)", re.M | re.S)
_SOURCE = re.compile(r"(src=\")(?!https?:)([^\"]+)(\")")


class SiteError(Exception):
    """A page that cannot be put on the site; the message names it."""


def main() -> None:
    """Put the pages side by side, and build the site unless only that is asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--stage", type=Path, help="only put the pages into this folder")
    given = parser.parse_args()
    stage(given.stage or STAGE)
    if given.stage is None:
        build()
        print(f"{sum(1 for _ in SITE.rglob('*.html'))} pages: {SITE / 'index.html'}. With a search:")
        print(f"  python3 -m http.server --bind 127.0.0.1 --directory {SITE.relative_to(ROOT)} 8080")


def places() -> dict[str, str]:
    """Where each file of the repository that has a page stands on the site: both as paths with slashes."""
    found = {"README.md": "index.md", "CHANGELOG.md": "changelog.md", "benchmarks/README.md": "benchmarks.md"}
    found |= {"LICENSE": "licence.md", "CITATION.cff": "citation.md", "docs/site.css": "site.css"}
    found |= {_path(path): _path(path, ROOT / "docs") for path in sorted((ROOT / "docs").rglob("*.md"))}
    pictures = [path for path in sorted((ROOT / "docs" / "pictures").iterdir()) if path.suffix != ".py"]
    found |= {_path(path): _path(path, ROOT / "docs") for path in pictures}
    examples = [path for path in sorted((ROOT / "examples").rglob("*")) if path.suffix in (".py", ".toml")]
    return found | {_path(path): f"{_path(path)[: -len(path.suffix)]}.md" for path in examples}


def stage(folder: Path) -> None:
    """Put everything that the site is made of into a folder, which is emptied first."""
    shutil.rmtree(folder, ignore_errors=True)
    where = places()
    for source, target in where.items():
        path = folder / target
        path.parent.mkdir(parents=True, exist_ok=True)
        if Path(target).suffix != ".md":
            shutil.copyfile(ROOT / source, path)
        elif source.endswith(".md"):
            path.write_text(moved((ROOT / source).read_text("utf-8"), source, where), "utf-8")
        else:
            path.write_text(shown(ROOT / source), "utf-8")
    (folder / "examples.md").write_text(examples(where), "utf-8")
    (folder / "reference").mkdir()
    for name, (title, modules) in REFERENCE.items():
        parts = [f"# {title}\n", *(f"::: {module}\n" for module in modules)]
        (folder / "reference" / f"{name}.md").write_text("\n".join(parts), "utf-8")
    (folder / "reference" / "commands.md").write_text(commands(), "utf-8")


def moved(text: str, source: str, where: dict[str, str]) -> str:
    """A page with its links leading to where things are on the site; code stays as it is.

    Raises:
        SiteError: for a link to what is not on the site.
    """

    def led(target: str) -> str:
        aimed = posixpath.normpath(posixpath.join(posixpath.dirname(source), target))
        if aimed not in where:
            raise SiteError(f"{source} leads to {target}, which is not on the site")
        return posixpath.relpath(where[aimed], posixpath.dirname(where[source]) or ".")

    parts = _FENCED.split(text)
    for at in range(0, len(parts), 2):
        parts[at] = _LINK.sub(lambda m: m[1] + led(m[2]) + (m[3] or "") + m[4], parts[at])
        parts[at] = _SOURCE.sub(lambda m: m[1] + led(m[2]) + m[3], parts[at])
    return "".join(parts)


def shown(path: Path) -> str:
    """A file as a page: its name, what it says of itself, and its text."""
    language = {".py": "python", ".toml": "toml", ".cff": "yaml"}.get(path.suffix, "text")
    return f"# {_path(path)}\n\n{_told(path)}\n\n```{language}\n{path.read_text('utf-8').rstrip()}\n```\n"


def examples(where: dict[str, str]) -> str:
    """The page that leads to all examples."""
    kept = {name: page for name, page in where.items() if name.startswith("examples/")}
    rows = [f"| [{name}]({page}) | {_told(ROOT / name)} |" for name, page in kept.items()]
    head = "# Examples\n\nFiles to copy, which run as they are.\n\n| file | what it is |\n|---|---|\n"
    return head + "\n".join(rows) + "\n"


def _told(path: Path) -> str:
    """The first line of what a file says of itself."""
    text = path.read_text("utf-8")
    told = ast.get_docstring(ast.parse(text)) if path.suffix == ".py" else None
    return (told or text.lstrip("# ") if path.suffix in (".py", ".toml") else "").partition("\n")[0]


def commands() -> str:
    """The page of all commands of `remac`: what each does, its arguments and options with defaults."""
    import typer
    from remac_bench.cli import app

    lines = ["# Commands\n", "What `remac COMMAND --help` says, on one page.\n"]
    for name, command in _leaves("remac", typer.main.get_command(app)):
        lines += [f"## {name}\n", " ".join((command.help or "").split()) + "\n"]
        rows = [_row(param) for param in command.params if param.name != "help"]
        if rows:
            lines += ["| | what it is | default |\n|---|---|---|\n" + "".join(rows)]
    return "\n".join(lines)


def _leaves(name: str, command: object) -> Iterator[tuple[str, object]]:
    inner = getattr(command, "commands", None)
    if inner is None:
        yield name, command
        return
    if command.invoke_without_command and " " in name:  # a group that does something by itself
        yield name, command
    for key, below in inner.items():
        yield from _leaves(f"{name} {key}", below)


def _row(param: object) -> str:
    names = [*param.opts, *param.secondary_opts]
    told = " ".join((getattr(param, "help", None) or "").split()).replace("|", "\\|").replace("<", "&lt;")
    default = "needed" if param.required else "" if param.default in (None, "") else f"`{param.default}`"
    return f"| {', '.join(f'`{name}`' for name in names)} | {told} | {default} |\n"


def build() -> None:
    """Build the site from the staged pages.

    Raises:
        SystemExit: where anything is warned of, or a page would fetch something from elsewhere.
    """
    shutil.rmtree(SITE, ignore_errors=True)
    line = [sys.executable, "-m", "zensical", "build", "--strict", "--clean", "--config-file", str(ROOT / "mkdocs.yml")]
    done = subprocess.run(line, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    sys.stdout.write(done.stdout)
    if done.returncode or re.search(r"^(griffe|warning)\b", done.stdout, re.I | re.M):
        raise SystemExit(done.returncode or "the site is built with warnings")
    foreign = [f"{path.relative_to(SITE)}: {what}" for path in SITE.rglob("*.html") for what in fetched(path)]
    if foreign:
        raise SystemExit("pages fetch from elsewhere:\n" + "\n".join(foreign))


def fetched(page: Path) -> list[str]:
    """What a browser that opens the page would get from elsewhere: scripts, styles, fonts, pictures."""
    text = page.read_text("utf-8")
    return re.findall(r"(?:src=|<link[^>]+href=|url\()[\"']?((?:https?:)?//[^\"')> ]+)", text)


def _path(path: Path, below: Path = ROOT) -> str:
    return path.relative_to(below).as_posix()


if __name__ == "__main__":
    main()
