# A method of your own: remac bench run --import examples/method.py --methods CHEERFUL --out runs/mine
import remac_agents
import remac_env


@remac_agents.register_method("CHEERFUL", checks=False)
def cheerful(run):
    run.make_plan(run.briefing.robots)
    while not run.finished:
        yield run.turn  # robot -> its subtask, for one round; what comes back says how it went,
        run.advance()  # which does not trouble this one: it goes on (remac_agents.methods has more to choose from)


if __name__ == "__main__":
    env = remac_env.parallel_env("OpenMicrowavePnP", robots=1, backend="symbolic")
    agent, (observations, infos) = remac_agents.make("CHEERFUL", planner="oracle"), env.reset(seed=0)
    agent.reset(observations, infos)
    while env.agents:
        observations, _, _, _, infos = env.step(agent.act(observations, infos))
    print("success", infos["robot_0"]["success"], "after", infos["robot_0"]["round"], "rounds")
