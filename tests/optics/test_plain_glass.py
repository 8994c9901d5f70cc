"""The plain second opinion on glass, against what is known of it in closed form."""

import math

import numpy as np
import pytest

from tests.helpers.plain_glass import (
    Block,
    Body,
    Cylinder,
    Sphere,
    Traced,
    absorbance,
    fresnel,
    irradiance,
    traced,
    within,
)

BODIES: list[Body] = [Block((4.0, 5.0, 7.0)), Cylinder(2.5), Cylinder(2.5, 6.0), Sphere(3.0)]


def light(elevation_deg: float, angle_deg: float = 0.0) -> np.ndarray:
    """Parallel light in the axes of a body that is turned by an angle, as in `docs/conventions.md`."""
    e, t = math.radians(elevation_deg), math.radians(angle_deg)
    return np.array([math.cos(e) * math.cos(t), -math.cos(e) * math.sin(t), -math.sin(e)])


def beams(body: Body, ior: float, seed: int = 5) -> list[Traced]:
    random = np.random.default_rng(seed)
    found = [traced(body, random.uniform(-2, 2, 3), random.normal(size=3), ior) for _ in range(200)]
    return [beam for beam in found if beam is not None]


@pytest.mark.parametrize("body", BODIES, ids=str)
@pytest.mark.parametrize("ior", [1.2, 1.5])
def test_energy_is_one_and_directions_are_unit_vectors(body: Body, ior: float) -> None:
    for beam in beams(body, ior):
        assert beam.transmitted + beam.reflected + beam.kept_inside == pytest.approx(1, abs=1e-12)
        assert min(beam.transmitted, beam.reflected, beam.kept_inside) >= 0
        assert np.linalg.norm(beam.inner) == pytest.approx(1, abs=1e-12)
        assert np.linalg.norm(beam.outgoing) == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize("body", BODIES, ids=str)
def test_light_goes_back_the_way_that_it_came(body: Body) -> None:
    found = beams(body, 1.5)
    assert len(found) > 50
    for beam in found:
        back = traced(body, beam.exit + beam.outgoing, -beam.outgoing, 1.5)
        assert back is not None
        # A beam near a rim or an edge magnifies rounding.
        np.testing.assert_allclose(back.points, beam.points[::-1], atol=1e-7)
        assert back.transmitted == pytest.approx(beam.transmitted, abs=1e-7)


@pytest.mark.parametrize("body", BODIES, ids=str)
def test_glass_of_the_index_of_air_bends_nothing(body: Body) -> None:
    for beam in beams(body, 1.0):
        assert beam.transmitted == 1
        np.testing.assert_allclose(beam.outgoing, beam.inner, atol=1e-12)
        np.testing.assert_allclose(np.cross(beam.exit - beam.entry, beam.inner), 0, atol=1e-12)


def test_a_block_shifts_light_and_does_not_turn_it() -> None:
    """And none leaves through a face beside that of its entry, where n > √2; what is turned back was at a wall."""
    direct = turned = 0
    for beam in beams(Block((4.0, 5.0, 7.0)), 1.42):
        way = beam.entry - beam.exit
        assert np.any(np.isclose(np.abs(way), [4, 5, 7], atol=1e-12))
        flips = np.abs(beam.outgoing)
        mine = traced(Block((4.0, 5.0, 7.0)), beam.exit, -beam.outgoing, 1.42)
        assert mine is not None
        np.testing.assert_allclose(np.abs(mine.outgoing), flips, atol=1e-12)
        if beam.is_direct:
            direct += 1
            np.testing.assert_allclose(mine.outgoing, -beam.outgoing, atol=1e-12)
        else:
            turned += 1
            assert 3 <= len(beam.points) <= 4, "at most once an axis"
    assert direct > 20
    assert turned > 20


def test_neighbouring_faces_let_light_through_below_the_root_of_two() -> None:
    ways = [beam.entry - beam.exit for beam in beams(Block((4.0, 5.0, 7.0)), 1.2) if beam.is_direct]
    assert any(not np.any(np.isclose(np.abs(way), [4, 5, 7], atol=1e-9)) for way in ways)


def test_square_on_a_face_throws_back_its_share_twice() -> None:
    share = (0.5 / 2.5) ** 2
    beam = traced(Block((4.0, 5.0, 7.0)), [0, 0.3, 0.4], [1, 0, 0], 1.5)
    assert beam is not None
    assert beam.reflected == pytest.approx(share, abs=1e-15)
    assert beam.transmitted == pytest.approx((1 - share) ** 2, abs=1e-15)
    np.testing.assert_allclose(beam.points, [[-2, 0.3, 0.4], [2, 0.3, 0.4]], atol=1e-15)


@pytest.mark.parametrize("ior", [1.33, 1.5, 1.7])
def test_at_the_angle_of_brewster_nothing_is_thrown_back_in_the_plane(ior: float) -> None:
    s, p = fresnel(math.cos(math.atan(ior)), 1.0, ior)
    assert p < 1e-30
    assert s == pytest.approx(((ior**2 - 1) / (ior**2 + 1)) ** 2)
    assert fresnel(math.sin(math.atan(ior)), ior, 1.0) == pytest.approx((s, p)), "from inside the same"


def test_beyond_the_critical_angle_all_is_thrown_back() -> None:
    critical = math.asin(1 / 1.5)
    assert fresnel(math.cos(critical + 1e-9), 1.5, 1.0) == (1.0, 1.0)
    assert max(fresnel(math.cos(critical - 1e-3), 1.5, 1.0)) < 0.9


@pytest.mark.parametrize(("elevation_deg", "focus"), [(0.0, 1.5), (35.0, 1.22)])
def test_a_cylinder_is_a_lens(elevation_deg: float, focus: float) -> None:
    """Beams at the axis meet behind it where the lens has its focus: n / (2 (n - 1)) radii, n of the level part."""
    e = math.radians(elevation_deg)
    level = math.sqrt(1.5**2 - math.sin(e) ** 2) / math.cos(e)
    assert level / (2 * (level - 1)) == pytest.approx(focus, abs=0.005)
    beam = traced(Cylinder(2.0), [-9, 1e-5, 9 * math.tan(e)], light(elevation_deg), 1.5)
    assert beam is not None
    met = beam.exit + beam.exit[1] / -beam.outgoing[1] * beam.outgoing
    assert met[0] == pytest.approx(2.0 * level / (2 * (level - 1)), rel=1e-6)
    assert beam.outgoing[2] == pytest.approx(-math.sin(e), abs=1e-15), "no steeper and no flatter"


def test_a_ball_turns_light_by_twice_what_each_face_does() -> None:
    beam = traced(Sphere(2.0), [-9, 1.2, 0], [1, 0, 0], 1.5)
    assert beam is not None
    turned = 2 * (math.asin(0.6) - math.asin(0.6 / 1.5))
    np.testing.assert_allclose(beam.outgoing, [math.cos(turned), -math.sin(turned), 0], atol=1e-12)
    polar = 2 * math.asin(0.4) - math.asin(0.6)
    np.testing.assert_allclose(beam.exit, [2 * math.cos(polar), 2 * math.sin(polar), 0], atol=1e-12)


def test_a_lens_spreads_light_and_a_block_does_not() -> None:
    """Behind the focus a picture of a level cylinder is D / f - 1 times as wide, so that much darker."""
    wall = [6.0, 0, 0], [1.0, 0, 0]
    window = (1 - 0.04) ** 2
    assert irradiance(Cylinder(2.0), [-9, 1e-4, 0], [1, 0, 0], 1.5, *wall) == pytest.approx(
        window / (6 / 3 - 1), rel=1e-5
    )
    flat = traced(Block((4.0, 5.0, 7.0)), [0.2, 0.1, 0.3], light(35, 20), 1.5)
    assert flat is not None
    shown = irradiance(Block((4.0, 5.0, 7.0)), [0.2, 0.1, 0.3], light(35, 20), 1.5, *wall)
    assert shown == pytest.approx(flat.transmitted, rel=1e-8)


def test_what_lies_in_a_block_in_a_bath_is_cut_out() -> None:
    block, bath = Block((2.0, 3.0, 4.0)), Cylinder(4.0)
    beam = traced(bath, [-9, 0.5, 0.2], [1, 0, 0], 1.5)
    assert beam is not None
    ((first, last),) = within(block, beam.points)
    assert (first[0], last[0]) == pytest.approx((-1, 1))
    np.testing.assert_allclose(np.cross(last - first, beam.inner), 0, atol=1e-12)
    beside = traced(bath, [-9, 3.5, 0.2], [1, 0, 0], 1.5)
    assert beside is not None
    assert within(block, beside.points) == []


def test_the_absorbance_of_even_stuff_is_its_way_and_of_voxels_their_own() -> None:
    beam = traced(Block((4.0, 5.0, 7.0)), [0.2, 0.1, 0.3], light(35, 20), 1.5)
    assert beam is not None
    way = float(np.linalg.norm(beam.exit - beam.entry))
    assert absorbance(beam.points, np.full((7, 10, 4), 0.3), (1, 0.5, 1)) == pytest.approx(0.3 * way)
    inside = [np.array([-3.0, 0.1, 0]), np.array([0.5, 0.1, 0])]
    assert absorbance(inside, np.array([[[1.0, 2.0, 4.0, 8.0]]]), (1, 2, 2)) == pytest.approx(1 + 2 + 4 / 2)
