"""Pictures of particles in three dimensions: faces, what hides what, sections."""

import numpy as np
import pytest
from PIL import Image

from mpmcli.results.pictures import Request, plot
from mpmcli.results.pictures.drawing import PictureError
from mpmcli.results.pictures.space import directions, faces_towards, hidden, sections

CUBE = np.tile(0.5 * np.eye(3), (1, 1, 1))


def area(polygon):
    """Area of a convex polygon whose corners may repeat."""
    x, y = polygon.T
    return 0.5 * abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


@pytest.mark.parametrize("view", ["iso", "xy", "xz", "yz"])
def test_views_are_orthonormal_and_right_handed(view):
    across, up, towards = directions(view)
    np.testing.assert_allclose([across @ up, across @ towards, up @ towards], 0.0, atol=1e-15)
    np.testing.assert_allclose(np.cross(across, up), towards, atol=1e-15)
    assert up[2] > 0 or view == "xy"


@pytest.mark.parametrize("options", [{"view": "iso"}, {"view": "xz"}, {"section": (2, None)}])
def test_pictures_of_space(make_results, tmp_path, options):
    request = Request(what=("particles",), output=tmp_path / "a.png", **options)
    (path,), notes = plot(make_results(3), request)
    assert notes == []
    with Image.open(path) as image:
        assert image.convert("RGB").getcolors(20) is None


def test_undeformed_domains_are_noted(make_results, tmp_path):
    for options in ({}, {"section": (0, None)}):
        request = Request(what=("particles",), output=tmp_path / "a.png", **options)
        _, (note,) = plot(make_results(3, fields=("stress",), name=f"r{len(options)}"), request)
        assert "add deformation_gradient" in note


@pytest.mark.parametrize("view", ["iso", "xy", "xz", "yz"])
def test_the_faces_seen_cover_the_shadow_of_a_box(view):
    """The projected area of a convex body is half of what all its faces project to (Cauchy)."""
    F = np.array([[1.2, 0.3, 0.0], [0.0, 0.9, 0.2], [-0.1, 0.0, 1.1]])
    edges = (F @ CUBE[0])[None]
    faces, light = faces_towards(np.zeros((1, 3)), edges, directions(view))
    towards = directions(view)[2]
    columns = 2.0 * edges[0]
    shadows = [np.cross(columns[:, a], columns[:, (a + 1) % 3]) @ towards for a in range(3)]
    assert sum(area(face) for face in faces[0]) == pytest.approx(np.abs(shadows).sum())
    assert ((light >= 0.0) & (light <= 1.0 + 1e-12)).all()
    mirrored, _ = faces_towards(np.zeros((1, 3)), edges * np.array([1, 1, -1]), directions(view))
    assert sum(area(face) for face in mirrored[0]) == pytest.approx(np.abs(shadows).sum())


def test_particles_inside_a_block_are_hidden_and_none_at_its_front():
    axis = np.arange(20) + 0.5
    X = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    edges = np.repeat(CUBE, len(X), axis=0)
    view = directions("iso")
    is_hidden = hidden(X, edges, view)
    towards = view[2]
    front = (X[:, 0] > 19) if towards[0] > 0 else (X[:, 0] < 1)
    front |= (X[:, 1] > 19) if towards[1] > 0 else (X[:, 1] < 1)
    front |= X[:, 2] > 19
    assert not is_hidden[front].any()
    assert is_hidden.sum() > 0.5 * len(X)
    assert not hidden(X[:1], edges[:1], view).any()
    assert hidden(X[:0], edges[:0], view).shape == (0,)
    apart = X * [1e6, 1.0, 1.0]
    assert not hidden(apart, edges, view).any()


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("position", [0.0, 0.2, 1.0, 1.37])
def test_a_section_of_a_block_fills_its_face_once(axis, position):
    """At a plane between two layers of particles, too."""
    places = np.arange(4) + 0.5
    X = np.stack(np.meshgrid(places, places, places, indexing="ij"), axis=-1).reshape(-1, 3)
    polygons, is_cut = sections(X, np.repeat(CUBE, len(X), axis=0), axis, position)
    if position == 0.0:
        assert is_cut.sum() in (0, 16)  # it touches the face
    else:
        assert is_cut.sum() == 16
        assert [area(polygon) for polygon in polygons] == pytest.approx([1.0] * 16)
        low, high = polygons.min(axis=(0, 1)), polygons.max(axis=(0, 1))
        np.testing.assert_allclose([low, high], [[0, 0], [4, 4]], atol=1e-12)


def test_sections_of_a_tilted_cube_are_triangles_and_a_hexagon():
    """Across its diagonal, at heights h from the middle: side 1, diagonal √3."""
    towards = np.ones(3) / np.sqrt(3)
    across = np.array([1, -1, 0]) / np.sqrt(2)
    turn = np.stack([across, np.cross(towards, across), towards])
    edges = 0.5 * turn[None]
    (hexagon,), _ = sections(np.zeros((1, 3)), edges, 2, 0.0)
    assert area(hexagon) == pytest.approx(3 * np.sqrt(3) / 4)
    h = 0.6
    (triangle,), _ = sections(np.zeros((1, 3)), edges, 2, h)
    tip = np.sqrt(3) / 2 - h
    assert area(triangle) == pytest.approx(1.5 * np.sqrt(3) * tip**2)
    _, is_cut = sections(np.zeros((1, 3)), edges, 2, 0.9)
    assert not is_cut.any()


def test_a_section_goes_through_particles_near_the_middle_or_where_it_is_asked(make_results, tmp_path):
    directory = make_results(3)
    with pytest.raises(PictureError, match="the plane z = 5 cuts no particle; the particles span 0 to 2"):
        plot(directory, Request(section=(2, 5.0)))
    (path,), _ = plot(directory, Request(section=(2, 1.9), output=tmp_path / "b.png", what=("particles",)))
    assert path.exists()
    (path,), _ = plot(directory, Request(section=(1, None), animate="gif"))
    with Image.open(path) as image:
        assert image.n_frames == 3
