"""What this machine has: versions for the records, and the facts that `remac doctor` prints."""

from __future__ import annotations

import importlib.util
import os
import platform
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from remac_bench.playing.code import code_digest
from remac_env.errors import RenderingError
from remac_env.simulator import load_mujoco

PACKAGES: Mapping[str, str] = {
    "mujoco": "the physics backend and pictures",
    "numpy": "everywhere",
    "gymnasium": "the single-agent interface",
    "pettingzoo": "the multi-agent interface",
    "opencv-python-headless": "videos",
    "httpx": "language models",
    "pydantic": "records",
    "typer": "this command",
    "rich": "tables and progress bars",
}
EXTRAS: Mapping[str, str] = {
    "robosuite": "the tasks as its environments; docs/robosuite.md says how to install it",
    "torch": "training skills, remac learn train; they are played without",
    "h5py": "demonstrations, remac learn record",
    "ray": "jobs on many machines",
}


@dataclass(frozen=True)
class Finding:
    """One line of the doctor's. `ok` is None for an option not taken: nothing is there, nothing is wrong."""

    group: str
    name: str
    value: str
    ok: bool | None
    purpose: str


def versions() -> dict[str, str]:
    """The versions on which an episode depends: remac, its code by digest, python, mujoco, numpy."""
    return dict(_versions())


@lru_cache(maxsize=1)
def _versions() -> tuple[tuple[str, str], ...]:
    import remac_env

    packages = [(name, _version(name) or "missing") for name in ("mujoco", "numpy")]
    code = ("code", code_digest())
    return (("remac", remac_env.__version__), code, ("python", platform.python_version()), *packages)


@lru_cache(maxsize=1)
def machine() -> str:
    """What this machine is, without its name: "Linux x86_64, AMD EPYC 7B12, 2 cores"."""
    count = cores()
    parts = (f"{platform.system()} {platform.machine()}", _processor(), f"{count} core{'s' * (count != 1)}")
    return ", ".join(part for part in parts if part)


def _processor() -> str:
    """The processor's name; "" where the system does not tell it."""
    try:
        lines = Path("/proc/cpuinfo").read_text("utf-8", errors="replace").splitlines()
    except OSError:
        return platform.processor()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "")


def cores() -> int:
    """The processor cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def examine() -> list[Finding]:
    """Everything that the doctor looks at here. Takes a second or two: OpenGL is tried in a process of its own."""
    return [*_machine(), *_packages(), _mujoco(), _opengl(), *_extras()]


def _machine() -> list[Finding]:
    supported = tuple(int(part) for part in platform.python_version_tuple()[:2]) >= (3, 11)
    memory = _memory_gib()
    return [
        Finding("machine", "Python", platform.python_version(), supported, "3.11 or later is needed"),
        Finding("machine", "system", f"{platform.system()} {platform.machine()}", True, ""),
        Finding("machine", "cores", str(cores()), True, "one worker process each"),
        Finding("machine", "memory", memory or "unknown", True, "about 0.5 GiB a worker in physics"),
    ]


def _memory_gib() -> str:
    try:
        total = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return ""
    return f"{total / 2**30:.1f} GiB"


def _packages() -> list[Finding]:
    import remac_env

    ours = Finding("packages", "remac-kitchen", remac_env.__version__, True, "this package")
    found = [(name, _version(name), purpose) for name, purpose in PACKAGES.items()]
    return [
        ours,
        *(Finding("packages", n, v or "missing", v is not None, purpose) for n, v, purpose in found),
    ]


def _mujoco() -> Finding:
    """Whether MuJoCo not only is installed but steps."""
    purpose = "the physics backend; without it use --backend symbolic"
    try:
        load_mujoco()
        import mujoco

        model = mujoco.MjModel.from_xml_string('<mujoco><worldbody><geom size=".1"/></worldbody></mujoco>')
        data = mujoco.MjData(model)
        mujoco.mj_step(model, data)
    except (RenderingError, ImportError, OSError, ValueError) as error:
        return Finding("physics", "MuJoCo", f"does not work: {error}", False, purpose)
    return Finding("physics", "MuJoCo", f"{mujoco.__version__} steps", data.time > 0, purpose)


def _opengl() -> Finding:
    purpose = "fast pictures; without it they come from the slower ray renderer"
    try:
        from remac_env.rendering import gl

        found = gl.probe()
    except RenderingError as error:
        return Finding("pictures", "OpenGL", str(error), False, purpose)
    except ImportError as error:
        return Finding("pictures", "OpenGL", f"cannot be tried: {error}", False, purpose)
    return Finding("pictures", "OpenGL", found or gl.advice(), True if found else None, purpose)


def _extras() -> list[Finding]:
    found = [(name, importlib.util.find_spec(name) is not None, purpose) for name, purpose in EXTRAS.items()]
    return [
        Finding(
            "extras", name, (_version(name) or "present") if here else "not installed", here or None, purpose
        )
        for name, here, purpose in found
    ]


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None
