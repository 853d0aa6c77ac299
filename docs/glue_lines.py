"""Prints what works with which library, and how many lines of glue that takes: `python docs/glue_lines.py`.

Glue is what a user writes between our environments and a library; learning itself does not count. It is counted in the
examples: lines with code of the classes and functions that are named, or of the whole file; docstrings are no code.
"""

from __future__ import annotations

import ast
from pathlib import Path

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"

LIBRARIES = (
    ("Gymnasium", "`gymnasium.make`, `make_vec`, `SyncVectorEnv`, `AsyncVectorEnv` (fork and spawn), every "
     "`AutoresetMode`, `RecordVideo`; one and two robots", "", ()),
    ("PettingZoo", "`parallel_env` and `env` (AEC), with its API, seed and render tests; two to four robots", "", ()),
    ("Stable-Baselines3", "`MultiInputPolicy` on the dict form, with and without pictures; `MlpPolicy` on "
     '`obs_format="flat"`; its `check_env` raises no warning; one policy for a team, as below', "", ()),
    ("sb3-contrib", "`MaskablePPO` finds `action_masks()`, for one and two robots; one policy for a team, as below",
     "rl/maskable_ppo.py", ()),
    ("SuperSuit", "`flatten_v0`, `frame_stack_v1` and `agent_indicator_v0` on the flat form", "", ()),
    ("torch alone", "PPO in one file, in the manner of CleanRL", "rl/ppo_in_torch.py", ()),
    ("RLlib", "its new API stack with two robots, one shared network and masks; observations are renamed to what its "
     "module for masks wants, and say which robot it is", "rl/rllib_two_robots.py", ("Team",)),
    ("Tianshou", "PPO with masks, one robot", "rl/tianshou_ppo.py", ("Masked", "Network")),
    ("LeRobot", "`lerobot-eval` finds the skills by EnvHub's `make_env`", "lerobot/env.py", ("*",)),
    ("Inspect AI", "a model plays by a tool, and its plans become records: tool, solver, scorer and task",
     "inspect/kitchen.py", ("*",)),
)  # fmt: skip
"""Library, what works, the example that shows it, and what of it is glue: names, or "*" for all."""


def main() -> None:
    """Print the table."""
    print("| library | what works | lines of glue |\n|---|---|---:|")
    for library, works, example, names in LIBRARIES:
        link = f": [examples/{example}](../examples/{example})" if example else ""
        print(f"| {library} | {works}{link} | {glue(example, names) if names else 0} |")


def glue(example: str, names: tuple[str, ...]) -> int:
    """Lines with code of what is named in an example.

    Raises:
        SystemExit: for a name that the example does not have.
    """
    text = (EXAMPLES / example).read_text("utf-8")
    tree = ast.parse(text)
    parts = {getattr(node, "name", ""): node for node in tree.body}
    if missing := [name for name in names if name not in parts and name != "*"]:
        raise SystemExit(f"examples/{example} has no {', '.join(missing)}")
    nodes = tree.body if names == ("*",) else [parts[name] for name in names]
    told = {line for node in ast.walk(tree) if _is_text(node) for line in _span(node)}
    written = {at for at, line in enumerate(text.splitlines(), 1) if line.strip() and not line.lstrip().startswith("#")}
    return len({line for node in nodes for line in _span(node)} & written - told)


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)


def _span(node: ast.AST) -> range:
    return range(node.lineno, node.end_lineno + 1)


if __name__ == "__main__":
    main()
