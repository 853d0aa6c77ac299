"""Bases are told apart by their outlines: MuJoCo misses contacts of upright boxes at one height."""

from __future__ import annotations

import math

import numpy as np
import pytest

import remac_env
from remac_env.backends.physics.separation import bases_apart
from remac_env.robots import bodies

FOOTPRINT = bodies.get().footprint


def sampled(pose: np.ndarray) -> np.ndarray:
    """Points (n, 2) along the edges of a base and inside it, world frame."""
    (x0, y0), (x1, y1) = FOOTPRINT
    x, y = np.meshgrid(np.linspace(x0, x1, 39), np.linspace(y0, y1, 33))
    points = np.column_stack([x.ravel(), y.ravel()])
    c, s = math.cos(pose[2]), math.sin(pose[2])
    return points @ np.array([[c, s], [-s, c]]) + pose[:2]


@pytest.mark.few(8)
@pytest.mark.parametrize("seed", range(30))
def test_bases_are_as_far_apart_as_their_points(seed: int) -> None:
    draw = np.random.default_rng(seed)
    one, other = draw.uniform((-0.35, -0.35, -math.pi), (0.35, 0.35, math.pi), (2, 3))
    gaps = np.linalg.norm(sampled(one)[:, None] - sampled(other)[None], axis=2)
    told = bases_apart(one, other, FOOTPRINT)
    assert math.isclose(told, bases_apart(other, one, FOOTPRINT), abs_tol=1e-12)
    assert told - 1e-9 <= gaps.min() <= told + 0.015


def test_bases_far_apart_are_infinitely_so() -> None:
    assert bases_apart(np.zeros(3), np.array([2.0, 0.0, 1.0]), FOOTPRINT) == math.inf


@pytest.mark.long
def test_two_robots_that_cross_in_a_galley_do_not_meet() -> None:
    env = remac_env.parallel_env("OpenCabinetPnP", robots=2, starts="mixed")
    env.reset(seed=157038)
    for texts in (
        ("navigate to vegetable", "navigate to plate"), ("pick up vegetable", "open cabinet door"),
        ("navigate to plate", "navigate aside"),
    ):  # fmt: skip
        actions = {robot: env.vocabulary.encode(text) for robot, text in zip(env.possible_agents, texts, strict=True)}
        *_, infos = env.step(actions)
        for info in infos.values():
            assert info["outcome"]["status"] == "success" and info["robot_contacts"] == info["near_misses"] == 0, texts
    env.close()
