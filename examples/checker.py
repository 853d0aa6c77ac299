"""A checker of your own: it says of each condition whether it holds (True, False, or None: it cannot tell)."""

import remac_agents
import remac_env
from remac_agents.roles import Verdict


class Optimist:
    def check(self, conditions, view):  # view: what is seen, held and reported; not the truth
        return [Verdict(condition, True, "I hope so") for condition in conditions]


env = remac_env.parallel_env("OpenMicrowavePnP", robots=1, backend="symbolic")
agent, (observations, infos) = remac_agents.make("CC", checker=Optimist()), env.reset(seed=0)
agent.reset(observations, infos)
while env.agents:
    observations, _, _, _, infos = env.step(agent.act(observations, infos))
checks = agent.report().pre_checks
print(f"{sum(check.verdict != check.truth for check in checks)} of {len(checks)} verdicts were wrong; the first:")
print(next(check.condition for check in checks if check.verdict != check.truth))
