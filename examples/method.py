# A method of your own: a generator that says what comes next. This one looks back, and never ahead.
import remac_agents
import remac_env


def looks_back(episode):
    episode.make_plan(episode.briefing.robots)
    while not episode.finished:
        yield episode.turn  # robot -> its subtask; plays a round
        episode.check_after()  # goes on, or tries again what did not work


remac_agents.register_method(remac_agents.Method(name="LOOKS-BACK", run=looks_back))  # for --import examples/method.py
if __name__ == "__main__":
    env = remac_env.parallel_env("OpenMicrowavePnP", robots=1, backend="symbolic", failure_rate=0.3)
    agent, (observations, infos) = remac_agents.make("LOOKS-BACK", planner="oracle"), env.reset(seed=0)
    agent.reset(observations, infos)
    while env.agents:
        observations, _, _, _, infos = env.step(agent.act(observations, infos))
    print("success", infos["robot_0"]["success"], "with", agent.report().retries, "retries")
