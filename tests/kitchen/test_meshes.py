"""Meshes are closed, face outwards and have the measures they were given; textures repeat and tile."""

from __future__ import annotations

import numpy as np
import pytest

from remac_env.kitchen import meshes, style, textures
from remac_env.kitchen.meshes import Mesh


def volume(mesh: Mesh) -> float:
    """Signed volume, m3: negative where faces look inwards."""
    corners = mesh.vertices[mesh.faces]
    return float(np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6)


def open_edges(mesh: Mesh) -> int:
    """Edges that do not belong to two faces running in opposite directions, vertices at one place taken as one."""
    _, same = np.unique(np.round(mesh.vertices, 9), axis=0, return_inverse=True)
    faces = same.reshape(-1)[mesh.faces]
    faces = faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])]
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    forth = {tuple(edge) for edge in edges}
    return sum((b, a) not in forth for a, b in forth)


CIRCLE = np.linspace(0, 2 * np.pi, 48, endpoint=False)
SOLIDS = {
    "box": (meshes.rounded_box((0.1, 0.2, 0.3), radius=0.004), 0.048),
    "soft box": (meshes.rounded_box((0.1, 0.1, 0.1), radius=0.02, segments=3), 0.00785),
    "cylinder": (meshes.revolve([(0, 0), (0.1, 0), (0.1, 0.2), (0, 0.2)], sides=48), np.pi * 0.002),
    "vessel": (
        meshes.revolve([(0, 0), (0.1, 0), (0.1, 0.2), (0.08, 0.2), (0.08, 0.02), (0, 0.02)], sides=48),
        0.002664,
    ),
    "rod": (meshes.tube([(0, 0, 0), (0.1, 0, 0), (0.2, 0, 0)], 0.1, sides=48), np.pi * 0.002),
    "upright rod": (meshes.tube([(0, 0, 0), (0, 0, 0.2)], 0.1, sides=48), np.pi * 0.002),
    "ring": (
        meshes.tube(np.column_stack([np.cos(CIRCLE), np.sin(CIRCLE), 0 * CIRCLE]), 0.1, sides=48, closed=True),
        2 * np.pi**2 * 0.01,
    ),
    "slab": (meshes.slab([(0, 0), (1, 0), (1, 1), (0, 1)], 0.1), 0.1),
    "leaf": (meshes.leaf(0.1, 0.02, curl=0.5, azimuth=1.0), None),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_solids_are_closed_and_face_outwards(name: str) -> None:
    mesh, expected = SOLIDS[name]
    assert open_edges(mesh) == 0
    assert volume(mesh) > 0
    if expected is not None:
        assert volume(mesh) == pytest.approx(expected, rel=0.02)


def test_the_check_sees_a_missing_and_a_turned_face() -> None:
    mesh = meshes.rounded_box((1, 1, 1), radius=0.1)
    assert open_edges(Mesh(mesh.vertices, mesh.faces[1:])) > 0
    assert volume(Mesh(mesh.vertices, mesh.faces[:, ::-1])) < 0


def test_box_keeps_its_size_normals_and_texture_scale() -> None:
    mesh = meshes.rounded_box((0.3, 0.2, 0.1), radius=0.01, uv_scale=2.0, uv_offset=(5.0, 7.0))
    low, high = mesh.bounds
    assert np.allclose(high, (0.3, 0.2, 0.1)) and np.allclose(low, -high)
    assert mesh.normals is not None and mesh.uv is not None
    assert np.allclose(np.linalg.norm(mesh.normals, axis=1), 1)
    assert (np.einsum("ij,ij->i", mesh.normals, mesh.vertices) > 0).all()
    top = mesh.normals[:, 2] > 0.999
    assert np.allclose(mesh.uv[top], mesh.vertices[top, :2] * 2 + (5, 7))


def test_radius_larger_than_the_box_is_cut() -> None:
    assert np.allclose(meshes.rounded_box((0.1, 0.1, 0.002), radius=0.05).bounds[1], (0.1, 0.1, 0.002))


def test_transform_scales_then_turns_then_moves() -> None:
    mesh = meshes.rounded_box((1, 1, 1), radius=0.1)
    turn = meshes.rotation((0, 0, 1), np.pi / 2)
    moved = meshes.transform(mesh, position=(10, 0, 0), scale=(2, 1, 1), rotation=turn)
    low, high = moved.bounds
    assert np.allclose(low, (9, -2, -1)) and np.allclose(high, (11, 2, 1))
    assert moved.normals is not None and np.allclose(np.linalg.norm(moved.normals, axis=1), 1)


def test_merge_keeps_all_faces_and_drops_what_is_not_in_all() -> None:
    box, rod = SOLIDS["box"][0], SOLIDS["rod"][0]
    both = meshes.merge(box, rod)
    assert volume(both) == pytest.approx(volume(box) + volume(rod))
    assert both.uv is not None and both.normals is None


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: meshes.rounded_box((1, 0, 1), radius=0.1), "half_extents"),
        (lambda: meshes.rounded_box((1, 1, 1), radius=0), "radius"),
        (lambda: meshes.revolve([(-1, 0), (1, 1)]), "profile"),
        (lambda: meshes.tube([(0, 0, 0)], 0.1), "path"),
        (lambda: meshes.transform(SOLIDS["box"][0], scale=-1), "scale"),
        (lambda: Mesh(np.zeros((3, 3)), np.array([[0, 1, 3]])), "faces"),
        (lambda: textures.texture("tartan", 16, (0, 0, 0), (0, 0, 0)), "tartan.*brick"),
    ],
)
def test_wrong_measures_are_named(call, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        call()


@pytest.mark.parametrize("pattern", sorted(textures.PATTERNS))
def test_textures_repeat_exactly_and_show_something(pattern: str) -> None:
    arguments = (pattern, 96, (0.8, 0.6, 0.4), (0.2, 0.3, 0.5))
    first = textures.texture(*arguments)
    textures.texture.cache_clear()
    again = textures.texture(*arguments)
    assert first.shape == (96, 96, 3) and first.dtype == np.uint8 and not first.flags.writeable
    assert first is not again and (first == again).all()
    assert len(np.unique(first)) > 5


def test_noise_tiles_without_a_seam() -> None:
    field = textures.noise(128, seed=1, base=(4, 4))
    inside = np.abs(np.diff(field, axis=1)).max()
    assert np.abs(field[:, 0] - field[:, -1]).max() <= 1.5 * inside


def test_styles_differ_and_cover_all_roles() -> None:
    styled = [style.load(name) for name in style.names()]
    assert {"modern_1", "farmhouse", "industrial", "coastal"} <= {look.name for look in styled}
    assert all(tuple(look.finishes) == style.roles() for look in styled)
    for role in ("base_door", "wall", "counter", "backsplash", "handle"):
        assert len({(look[role].pattern, look[role].color) for look in styled}) == len(styled), role


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("sofa = { color = '#ffffff' }", ["sofa", "base_door"]),
        ("floor = { colour = '#ffffff' }", ["floor.colour", "color"]),
        ("floor = { color = 'red' }", ["floor.color", "#rrggbb"]),
        ("floor = { pattern = 'tartan' }", ["floor.pattern", "tartan", "planks"]),
        ("floor = { specular = 2 }", ["floor.specular", "0 to 1"]),
        ("floor = 3", ["floor", "table"]),
        ("floor = {", ["TOML"]),
        ("title = 3", ["title"]),
    ],
)
def test_bad_style_file_names_file_key_and_choices(tmp_path, text: str, words: list[str]) -> None:
    from remac_env.errors import KitchenFileError

    path = tmp_path / "odd.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(KitchenFileError) as caught:
        style.read(path)
    for word in ["odd.toml", *words]:
        assert word in str(caught.value)


def test_unknown_style_lists_the_styles() -> None:
    from remac_env.errors import UnknownNameError

    with pytest.raises(UnknownNameError, match="coastal.*modern_1"):
        style.load("baroque")


def test_materials_compile_with_every_role() -> None:
    import mujoco

    from remac_env.kitchen.materials import add_materials

    spec = mujoco.MjSpec()
    add_materials(spec, style.load("modern_1"), texture_size=32)
    spec.worldbody.add_geom(size=[0.1, 0, 0], material="floor")
    model = spec.compile()
    assert {model.material(i).name for i in range(model.nmat)} == set(style.roles())
    assert model.ntex == sum(bool(finish.pattern) for finish in style.load("modern_1").finishes.values())
