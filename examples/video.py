"""A video of an episode, in example.webm. On a machine without a display: MUJOCO_GL=egl, or osmesa."""

import remac_env

# A picture a round; with backend="physics" every motion, up to 150 pictures, which take half a minute.
env = remac_env.parallel_env("OpenMicrowavePnP", robots=1, backend="symbolic")
env.start_recording()
env.reset(seed=0)
for command in ("navigate to microwave", "open microwave door"):
    _, _, _, _, infos = env.step({"robot_0": env.vocabulary.encode(command)})
    print(command, "->", infos["robot_0"]["outcome"]["status"])
print("pictures in example.webm:", env.save_recording("example.webm"))
env.close()
