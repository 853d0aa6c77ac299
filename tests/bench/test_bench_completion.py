"""What Tab completes: names behind options, in process for each kind and in a real bash with a real Tab."""

from __future__ import annotations

import os
import pty
import re
import select
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from remac_bench.cli import app
from remac_bench.completion import NAMES
from remac_bench.flags import TABLE
from remac_bench.playing import suites
from typer.testing import CliRunner

import remac_agents
import remac_env

Ask = Callable[[str], list[str]]


@pytest.fixture
def tab() -> Ask:
    """What the Tab key would offer at the end of a line, as bash asks for it."""

    def ask(line: str) -> list[str]:
        words = line.split(" ")
        asked = {"_REMAC_COMPLETE": "complete_bash", "COMP_WORDS": line, "COMP_CWORD": str(len(words) - 1)}
        told = CliRunner().invoke(app, [], env=asked, prog_name="remac")
        assert told.exit_code == 0, told.output
        return told.stdout.split("\n")[:-1] if told.stdout.strip() else []

    return ask


def test_each_kind_of_name_is_completed(tab: Ask) -> None:
    assert tab("remac play --task ")[:4] == remac_env.tasks()[:4]
    assert tab("remac play --task Open") == ["OpenCabinetPnP", "OpenMicrowavePnP"]
    assert tab("remac bench run --suite ") == suites.names()
    assert tab("remac plan --planner ") == remac_agents.roles()["planner"]
    assert tab("remac bench run --checker n") == ["noisy", "none"]
    assert tab("remac bench run --methods REM") == [name for name in remac_agents.methods() if name.startswith("REM")]
    assert tab("remac learn train --skills Turn") == ["TurnOn", "TurnOff"]
    assert tab("remac bench run --style coas") == ["coastal"]
    assert tab("remac oracle --layout rich_gal") == ["rich_galley"]
    assert tab("remac play --backend ") == ["physics", "symbolic"]
    assert tab("remac experiment ") == ["reflection", "wording", "validity", "headroom"]
    assert tab("remac play --seed ") == []


def test_lists_go_on_behind_their_comma_and_offer_nothing_twice(tab: Ask) -> None:
    assert tab("remac bench run --tasks HeatOnStove,Heat") == ["HeatOnStove,HeatAndShelve", "HeatOnStove,HeatBoth"]
    assert tab("remac bench run --cameras front,w") == ["front,wrist"]
    assert tab("remac play --task HeatOnStove,Heat") == []  # one name only


def test_a_line_that_is_wrong_so_far_is_completed_all_the_same(tab: Ask) -> None:
    assert tab("remac play --task Wrong --robots many --task Open") == ["OpenCabinetPnP", "OpenMicrowavePnP"]


def test_what_was_registered_since_is_among_the_names(tab: Ask, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(remac_env, "tasks", lambda clock: ["PotatoToSink"])
    assert tab("remac play --task P") == ["PotatoToSink"]


def test_no_table_of_names_is_for_an_option_that_there_is_not() -> None:
    known = {name for flag in TABLE.values() for name in (flag.keyword, f"{flag.home}.{flag.keyword}")}
    assert set(NAMES) <= known


@pytest.mark.long
@pytest.mark.skipif(shutil.which("bash") is None, reason="there is no bash")
def test_a_real_bash_completes_with_a_real_tab(tmp_path: Path) -> None:
    """The script that `remac --show-completion` prints, in an interactive bash at a terminal of its own."""
    command = tmp_path / "remac"
    command.write_text(f"#!{sys.executable}\nfrom remac_bench.cli import main\nmain()\n")
    command.chmod(0o755)
    paths = {"PATH": f"{tmp_path}:{os.environ['PATH']}", "PYTHONPATH": os.pathsep.join(sys.path)}
    env = {**os.environ, **paths, "PS1": "> "}
    asked = {**env, "_REMAC_COMPLETE": "source_bash"}
    script = subprocess.run(["remac"], env=asked, capture_output=True, text=True, check=True).stdout
    (tmp_path / "completion.sh").write_text(script)
    lines = {
        "remac play --task OpenC\t": "remac play --task OpenCabinetPnP ",
        "remac bench run --suite graded-\t": "remac bench run --suite graded-heldout ",
        "remac learn train --skills Seas\t": "remac learn train --skills Season ",
        "remac plan --task HeatOnStove --planner mem\t": "remac plan --task HeatOnStove --planner memorised ",
        "remac bench run --tasks HeatOnStove,Defr\t": "remac bench run --tasks HeatOnStove,DefrostInBowl ",
    }
    shell, terminal = pty.openpty()
    ends, line = {"stdin": terminal, "stdout": terminal, "stderr": terminal}, ["bash", "--norc", "--noprofile", "-i"]
    bash = subprocess.Popen(line, env=env, cwd=tmp_path, start_new_session=True, **ends)
    try:
        os.write(shell, b"bind 'set enable-bracketed-paste off'; . ./completion.sh; echo READY-$((1 + 1))\n")
        _until(shell, "READY-2")
        for typed, completed in lines.items():
            os.write(shell, typed.encode())
            _until(shell, completed)
            os.write(shell, b"\x15")  # Ctrl-U: nothing of it is run
    finally:
        bash.kill()
        bash.wait()
        os.close(shell)
        os.close(terminal)


def _until(shell: int, wanted: str, seconds: float = 60.0) -> None:
    """Read what bash shows until it has shown this."""
    shown = ""
    while wanted not in shown:
        ready, _, _ = select.select([shell], [], [], seconds)
        assert ready, f"waited for {wanted!r}, and there is only {shown!r}"
        shown += re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]|\x07|\r", "", os.read(shell, 4096).decode(errors="replace"))
