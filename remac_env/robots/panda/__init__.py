"""The mobile Panda: kinematic data, MuJoCo model and inverse kinematics. Imported by `robots.bodies` alone."""
