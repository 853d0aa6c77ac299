"""The roles that methods are made of: one small protocol each, with a frozen request and a frozen reply.

Every role is given the PublicScene; one that sets `needs_rules = True` also the Rules (what the skill table enforces or
advises about this kitchen), one that sets `needs_truth = True` both and the WorldState: every report lists which. One
that sets `needs_images = True` looks at pictures: its kitchen is made with obs="state+images", with `picture_size` in
the size that it makes use of, in pixels, and with `cameras` with these pictures in place of the usual ones. A role may
also have `begin_episode(seed, iteration)`, called at each reset: whatever it draws by chance comes from there. The
episode's own seed is for roles of this package and for those that are given the truth; others get one made of what
they are told.
"""

from remac_agents.roles.accounts import Attempt, PreviousTry, Ran, Repair
from remac_agents.roles.free_text import FreeText
from remac_agents.roles.protocols import (
    Adjuster,
    Checker,
    Conditions,
    Handover,
    Planner,
    Reflector,
    Roles,
    StopEpisode,
    Summariser,
)
from remac_agents.roles.requests import (
    ANSWERS,
    AdjustRequest,
    Advice,
    Ask,
    HandoverRequest,
    Images,
    PlanRequest,
    ReflectRequest,
    Report,
    Verdict,
    View,
)
from remac_agents.roles.summaries import ExplainRequest, Explanation, SeenStep, Summary, last_tries

__all__ = [
    "ANSWERS",
    "AdjustRequest",
    "Adjuster",
    "Advice",
    "Ask",
    "Attempt",
    "Checker",
    "Conditions",
    "ExplainRequest",
    "Explanation",
    "FreeText",
    "Handover",
    "HandoverRequest",
    "Images",
    "PlanRequest",
    "Planner",
    "PreviousTry",
    "Ran",
    "ReflectRequest",
    "Reflector",
    "Repair",
    "Report",
    "Roles",
    "SeenStep",
    "StopEpisode",
    "Summariser",
    "Summary",
    "Verdict",
    "View",
    "last_tries",
]
