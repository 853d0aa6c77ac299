"""Drawn dishes, bottle and shaker, standing on z = 0 around the z axis. Measures follow the catalogue's bodies."""

from __future__ import annotations

import numpy as np

from remac_env.kitchen.meshes import Floats, merge, revolve, rounded_box, smooth_profile, transform, tube
from remac_env.kitchen.objects.part import DrawnPart, bands, glossy, grid, picture
from remac_env.kitchen.style import Finish

_PORCELAIN = Finish(color=(1.0, 1.0, 1.0), specular=0.6, shininess=0.7)
_ROUND = 32


def plate() -> tuple[DrawnPart, ...]:
    """White porcelain with a blue rim, which sets it off from pale worktops."""
    mesh = revolve(
        [(0, 0.002), (0.068, 0.002), (0.070, 0), (0.078, 0), (0.095, 0.006), (0.1045, 0.019), (0.1115, 0.0305),
         (0.1125, 0.0323), (0.1100, 0.0327), (0.1010, 0.0203), (0.093, 0.0108), (0.086, 0.009), (0, 0.009)],
        sides=_ROUND,
    )  # fmt: skip
    white, blue = (0.96, 0.96, 0.94), (0.18, 0.34, 0.60)
    return (
        DrawnPart(mesh, _PORCELAIN, bands((0, white), (0.505, blue), (0.585, white))),
    )


def bowl() -> tuple[DrawnPart, ...]:
    """Blue glaze outside, pale inside."""
    mesh = revolve(
        [(0, 0.003), (0.054, 0.003), (0.056, 0), (0.064, 0), (0.073, 0.007), (0.089, 0.030), (0.1020, 0.0543),
         (0.1005, 0.0561), (0.098, 0.0548), (0.0850, 0.030), (0.069, 0.012), (0.062, 0.009), (0, 0.009)],
        sides=_ROUND,
    )  # fmt: skip
    return (
        DrawnPart(
            mesh,
            _PORCELAIN,
            bands((0, (0.20, 0.42, 0.66)), (0.515, (0.93, 0.95, 0.95)), (0.53, (0.55, 0.74, 0.86))),
        ),
    )


def pan() -> tuple[DrawnPart, ...]:
    """A black frying pan with a bright rim and a wooden handle towards -y."""
    mesh = revolve(
        [(0, 0), (0.094, 0), (0.099, 0.004), (0.1120, 0.047), (0.1130, 0.0495), (0.1105, 0.0500), (0.1075, 0.046),
         (0.0945, 0.013), (0.088, 0.009), (0, 0.009)],
        sides=_ROUND,
    )  # fmt: skip
    dark, coated, bright = (0.12, 0.12, 0.13), (0.20, 0.20, 0.215), (0.62, 0.63, 0.65)
    neck = tube(
        [(0, -0.106, 0.034), (0, -0.125, 0.041), (0, -0.150, 0.045)],
        [0.008, 0.008, 0.008],
        squash=(1.5, 0.6),
        sides=10,
    )
    handle = tube(
        [(0, -0.140, 0.0445), (0, -0.150, 0.045), (0, -0.200, 0.046), (0, -0.262, 0.047), (0, -0.270, 0.047)],
        [0.008, 0.0105, 0.011, 0.012, 0.008],
        squash=(1.0, 0.75),
        sides=10,
    )
    rim = tube(_ring(0.1115, 0.0490), 0.0018, sides=6, closed=True)
    return (
        DrawnPart(mesh, Finish(color=(1.0, 1.0, 1.0), specular=0.5, shininess=0.5), bands((0, dark), (0.53, coated))),
        DrawnPart(merge(rim, neck), glossy(*bright, specular=0.9, shininess=0.7)),
        DrawnPart(handle, glossy(0.45, 0.27, 0.15, specular=0.3)),
    )


def mug() -> tuple[DrawnPart, ...]:
    """Coral glaze, pale inside, with an ear towards +x."""
    cup = revolve(
        [(0, 0.003), (0.026, 0.003), (0.028, 0), (0.031, 0.001), (0.0338, 0.005), (0.0340, 0.085), (0.0325, 0.088),
         (0.0305, 0.086), (0.0300, 0.014), (0.026, 0.009), (0, 0.009)],
        sides=26,
    )  # fmt: skip
    turn = np.linspace(-1.45, 1.45, 12)
    ear = tube(
        np.column_stack([0.033 + 0.024 * np.cos(turn), 0 * turn, 0.045 + 0.026 * np.sin(turn)]),
        0.005,
        sides=8,
    )
    coral = (0.87, 0.36, 0.25)
    glaze = bands((0, coral), (0.535, (0.96, 0.93, 0.87)))
    return DrawnPart(cup, _PORCELAIN, glaze), DrawnPart(ear, glossy(*coral, specular=0.6, shininess=0.7))


def bottle() -> tuple[DrawnPart, ...]:
    """Green glass with a label and a golden cap."""
    shoulder = smooth_profile([(0.035, 0.110), (0.0345, 0.132), (0.0290, 0.158), (0.0150, 0.182), (0.0135, 0.218)])
    profile = np.vstack([[(0, 0), (0.0330, 0), (0.0350, 0.005)], shoulder, [(0, 0.219)]])
    label = revolve([(0.0352, 0.040), (0.0357, 0.042), (0.0357, 0.106), (0.0352, 0.108)], sides=24)
    cap = revolve([(0, 0.214), (0.0150, 0.214), (0.0150, 0.236), (0.0125, 0.240), (0, 0.240)], sides=20)
    v, u = grid()
    paper = np.full((*v.shape, 3), (0.93, 0.89, 0.75))
    paper[(v < 0.12) | (v > 0.88)] = (0.60, 0.14, 0.14)
    paper[np.hypot(3 * ((2 * u) % 1 - 0.5), v - 0.5) < 0.24] = (0.25, 0.44, 0.20)
    return (
        DrawnPart(revolve(profile, sides=22), glossy(0.16, 0.36, 0.16, specular=0.9, shininess=0.8)),
        DrawnPart(label, Finish(color=(1.0, 1.0, 1.0), specular=0.1, shininess=0.2), picture(paper)),
        DrawnPart(cap, glossy(0.76, 0.62, 0.24, specular=0.8, shininess=0.7)),
    )


def seasoning() -> tuple[DrawnPart, ...]:
    """A glass shaker full of spice with a metal top and holes."""
    jar = revolve([(0, 0), (0.0205, 0), (0.0220, 0.004), (0.0195, 0.060), (0, 0.060)], sides=20)
    top = revolve(
        [(0, 0.056), (0.0212, 0.056), (0.0215, 0.072), (0.0190, 0.081), (0.0110, 0.088), (0, 0.090)], sides=20
    )
    hole = rounded_box((0.0022, 0.0022, 0.0012), radius=0.001)
    places = [(0.0, 0.0, 0.0896)] + [(0.009 * np.cos(a), 0.009 * np.sin(a), 0.0882) for a in np.arange(5) * 1.2566]
    holes = merge(*(transform(hole, position=place) for place in places))
    spice, glass, paper = (0.72, 0.25, 0.12), (0.86, 0.90, 0.90), (0.97, 0.95, 0.88)
    filling = bands((0, spice), (0.38, paper), (0.52, spice), (0.60, glass))
    return (
        DrawnPart(jar, Finish(color=(1.0, 1.0, 1.0), specular=0.8, shininess=0.8), filling),
        DrawnPart(top, glossy(0.76, 0.78, 0.80, specular=0.9, shininess=0.7)),
        DrawnPart(holes, glossy(0.08, 0.08, 0.08)),
    )


def _ring(radius: float, height: float) -> Floats:
    """Points (k, 3) of a level circle around the z axis."""
    turn = np.linspace(0, 2 * np.pi, _ROUND, endpoint=False)
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn), np.full(_ROUND, height)])
