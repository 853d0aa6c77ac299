"""`python -m remac_agents`: the version, the methods, and who can fill each role."""

from __future__ import annotations

import sys

import remac_agents
import remac_env

if __name__ == "__main__":
    sys.stdout.write(f"remac_agents {remac_env.__version__}; methods: {', '.join(remac_agents.methods())}\n")
    for role, names in remac_agents.roles().items():
        sys.stdout.write(f"{role}: {', '.join(names)}\n")
