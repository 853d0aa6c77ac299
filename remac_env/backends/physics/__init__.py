"""The physics backend: MuJoCo decides what a skill achieves."""
