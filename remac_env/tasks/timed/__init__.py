"""Tasks in which things take their time by themselves, or are too late: for the event clock alone.

In the first six the best plan does something else meanwhile; the last three have a deadline that one robot cannot keep.
"""

from __future__ import annotations

from remac_env.tasks.timed.falling_door import SPEC as _FALLING_DOOR
from remac_env.tasks.timed.fill_and_shelve import SPEC as _FILL_AND_SHELVE
from remac_env.tasks.timed.frozen_in_time import SPEC as _FROZEN_IN_TIME
from remac_env.tasks.timed.heat_and_shelve import SPEC as _HEAT_AND_SHELVE
from remac_env.tasks.timed.heat_both import SPEC as _HEAT_BOTH
from remac_env.tasks.timed.microwave_and_fill import SPEC as _MICROWAVE_AND_FILL
from remac_env.tasks.timed.rinse_and_stow import SPEC as _RINSE_AND_STOW
from remac_env.tasks.timed.rinse_then_heat import SPEC as _RINSE_THEN_HEAT
from remac_env.tasks.timed.supper_in_time import SPEC as _SUPPER_IN_TIME

SPECS = (
    *(_HEAT_AND_SHELVE, _RINSE_AND_STOW, _FILL_AND_SHELVE),
    *(_MICROWAVE_AND_FILL, _HEAT_BOTH, _RINSE_THEN_HEAT),
    *(_FROZEN_IN_TIME, _FALLING_DOOR, _SUPPER_IN_TIME),
)
"""All of them, in the order of the tables."""
