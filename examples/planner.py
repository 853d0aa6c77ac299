"""A planner of your own. In a benchmark: remac bench run --planner examples/planner.py:plan --out runs/mine"""

import remac_agents
import remac_env


def plan(request):  # request.goal: "place the vegetable into the microwave"
    _, _, thing, _, _, place = request.goal.split()
    steps = [f"navigate to {place}", f"open {place} door", f"navigate to {thing}", f"pick up {thing}"]
    return {request.lead: [*steps, f"navigate to {place}", f"place to {place}"]}


if __name__ == "__main__":
    env = remac_env.parallel_env("OpenMicrowavePnP", robots=1, backend="symbolic")
    agent, (observations, infos) = remac_agents.make("BASE", planner=plan), env.reset(seed=0)
    agent.reset(observations, infos)
    while env.agents:
        observations, _, _, _, infos = env.step(agent.act(observations, infos))
    print("success", infos["robot_0"]["success"], "after", infos["robot_0"]["round"], "rounds")
