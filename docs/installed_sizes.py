"""Prints how large what is installed is: `python docs/installed_sizes.py [FOLDER ...] [--packages 12]`.

A FOLDER is an environment, such as .venv or .venv-rl; without one it is that of this Python. Sizes are those of the
files that each package says to have installed, compiled byte code left out, in MB of 1,000,000 bytes; a package that
was installed editable, as ours is in a checkout, counts without its sources.
"""

from __future__ import annotations

import argparse
import sys
from importlib.metadata import Distribution, distributions
from pathlib import Path

TOOLS = ("pip", "setuptools", "wheel")
"""What every environment begins with."""


def main() -> None:
    """Print a table of environments, or of one environment's packages."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="*", type=Path, default=[Path(sys.prefix)])
    parser.add_argument("--packages", type=int, default=4, help="how many of the largest are named")
    given = parser.parse_args()
    found = {str(folder): sizes(folder) for folder in given.folders}
    if len(found) == 1:
        ((name, packages),) = found.items()
        print(f"| package in `{name}` | MB |\n|---|---:|")
        for package, size in largest(packages, given.packages):
            print(f"| {package} | {size / 1e6:.1f} |")
        print(f"| all {len(packages)} packages | {sum(packages.values()) / 1e6:.0f} |")
        return
    print("| environment | packages | MB | the largest |\n|---|---:|---:|---|")
    for name, packages in found.items():
        named = ", ".join(f"{package} {size / 1e6:.0f}" for package, size in largest(packages, given.packages))
        print(f"| `{name}` | {len(packages)} | {sum(packages.values()) / 1e6:.0f} | {named} |")


def sizes(folder: Path) -> dict[str, int]:
    """Package -> bytes of its files.

    Raises:
        SystemExit: for a folder that is no environment.
    """
    places = sorted(folder.glob("lib/python3.*/site-packages")) or sorted(folder.glob("Lib/site-packages"))
    if not places:
        raise SystemExit(f"{folder} is no environment: it has no site-packages; make one, as `make install` does")
    found = {each.metadata["Name"]: size(each) for each in distributions(path=[str(place) for place in places])}
    return {name: bytes_ for name, bytes_ in found.items() if name.lower() not in TOOLS}


def size(package: Distribution) -> int:
    """Bytes of a package's files that are there."""
    paths = {Path(str(file.locate())) for file in package.files or () if file.suffix != ".pyc"}
    return sum(path.stat().st_size for path in paths if path.is_file())


def largest(packages: dict[str, int], count: int) -> list[tuple[str, int]]:
    """The largest packages first, equal ones by name."""
    return sorted(packages.items(), key=lambda each: (-each[1], each[0].lower()))[:count]


if __name__ == "__main__":
    main()
