"""Episodes as PDDL: a domain and a problem that any classical or temporal planner reads, and its plans as commands."""

from remac_env.pddl.actions import LEVELS
from remac_env.pddl.plans import Step, printed_plan, read_plan
from remac_env.pddl.playing import Played, play_plan
from remac_env.pddl.stating import Stated, state_plan
from remac_env.pddl.writing import unsaid, write_domain, write_problem

__all__ = [
    "LEVELS", "Played", "Stated", "Step", "play_plan", "printed_plan", "read_plan", "state_plan", "unsaid",
    "write_domain", "write_problem",
]
