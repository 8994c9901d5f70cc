"""Laws of keyframes, loops, easing and parents."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lightcube.scene.description import Group, Motion
from lightcube.scene.motion import eased, placement, pose, rotation_matrix

EASINGS = ["linear", "ease-in", "ease-out", "ease-in-out", "smooth", "step"]
number = st.floats(-5, 5)
triple = st.tuples(number, number, number)
degrees = st.tuples(*[st.floats(-720, 720)] * 3)


def group(keys: list[dict[str, object]], **motion: object) -> Group:
    return Group(motion=Motion.model_validate({"keys": keys, **motion}))


@given(
    places=st.lists(triple, min_size=2, max_size=5),
    turns=degrees,
    easing=st.sampled_from(EASINGS),
    loop=st.booleans(),
)
@settings(max_examples=60)
def test_keyframes_are_hit_exactly(
    places: list[tuple[float, float, float]], turns: tuple[float, float, float], easing: str, loop: bool
) -> None:
    times = [0.1 + 0.8 * i / len(places) for i in range(len(places))]
    keys = [
        {"time": t, "position": p, "rotation_deg": turns, "scale": [abs(x) for x in p]}
        for t, p in zip(times, places, strict=True)
    ]
    thing = group(keys, easing=easing, loop=loop)
    for t, p in zip(times, places, strict=True):
        position, rotation_deg, scale = pose(thing, t)
        np.testing.assert_allclose(position, p, atol=1e-12)
        np.testing.assert_allclose(rotation_deg, turns, atol=1e-12)
        np.testing.assert_allclose(scale, np.abs(p), atol=1e-12)


@given(places=st.lists(triple, min_size=1, max_size=5), easing=st.sampled_from(EASINGS[:-1]), phase=st.floats(0, 1))
@settings(max_examples=60)
def test_closed_loops_join_up(places: list[tuple[float, float, float]], easing: str, phase: float) -> None:
    keys = [{"time": 0.07 + 0.9 * i / len(places), "position": p} for i, p in enumerate(places)]
    thing = group(keys, easing=easing, loop=True, phase=phase)
    np.testing.assert_allclose(pose(thing, 0.0)[0], pose(thing, 1.0)[0], atol=1e-9)
    steps = np.array([pose(thing, t)[0] for t in np.linspace(0, 1, 401)])
    # No jump anywhere: at most the fastest piece, which smooth and quadratic easing drive about three times as fast.
    fastest = 6 * 20 * len(places) / 0.9 / 400
    assert np.max(np.abs(np.diff(steps, axis=0))) < fastest


def test_a_step_holds_until_the_next_key() -> None:
    thing = group([{"time": 0.2, "position": [1, 2, 3]}, {"time": 0.7, "position": [4, 5, 6]}], easing="step")
    assert pose(thing, 0.6999)[0] == (1, 2, 3)
    assert pose(thing, 0.7)[0] == (4, 5, 6)


def test_without_a_loop_the_ends_hold() -> None:
    thing = group([{"time": 0.2, "position": [1, 2, 3]}, {"time": 0.7, "position": [4, 5, 6]}])
    assert pose(thing, 0.0)[0] == (1, 2, 3)
    assert pose(thing, 1.0)[0] == (4, 5, 6)
    np.testing.assert_allclose(pose(thing, 0.45)[0], (2.5, 3.5, 4.5))


@pytest.mark.parametrize("easing", EASINGS[:4])
def test_easing_runs_from_zero_to_one_and_never_back(easing: str) -> None:
    u = np.linspace(0, 1, 101)
    w = np.array([eased(x, easing) for x in u])
    assert (w[0], w[-1]) == (0, 1)
    assert np.all(np.diff(w) > 0)


def test_easing_speeds() -> None:
    def speed(easing: str, u: float) -> float:
        return (eased(u + 1e-6, easing) - eased(u - 1e-6, easing)) / 2e-6

    assert speed("ease-in", 0.0) == pytest.approx(0, abs=1e-9)
    assert speed("ease-in", 1.0) == pytest.approx(2)
    assert speed("ease-out", 0.0) == pytest.approx(2)
    assert speed("ease-in-out", 0.0) == pytest.approx(0, abs=1e-5)
    assert speed("ease-in-out", 0.5) == pytest.approx(1.5)


def test_ease_out_then_in_is_a_thrown_ball() -> None:
    keys = [
        {"time": 0, "position": [0, 0, 0], "easing": "ease-out"},
        {"time": 0.5, "position": [0, 0, 1], "easing": "ease-in"},
        {"time": 1, "position": [0, 0, 0]},
    ]
    thing = group(keys, loop=True)
    for t in np.linspace(0, 1, 17):
        assert pose(thing, float(t))[0][2] == pytest.approx(4 * t * (1 - t))


def test_a_smooth_motion_has_no_corners() -> None:
    keys = [{"time": t, "position": [x, 0, 0]} for t, x in ((0.0, 0.0), (0.3, 1.0), (0.5, -1.0), (0.8, 2.0))]
    for loop in (True, False):
        thing = group(keys, easing="smooth", loop=loop)
        for t in (0.3, 0.5, 0.8) if loop else (0.3, 0.5):
            left = (pose(thing, t)[0][0] - pose(thing, t - 1e-6)[0][0]) / 1e-6
            right = (pose(thing, t + 1e-6)[0][0] - pose(thing, t)[0][0]) / 1e-6
            assert left == pytest.approx(right, abs=1e-3)
    start = (pose(group(keys, easing="smooth", loop=True), 1e-6)[0][0]) / 1e-6
    end = (0 - pose(group(keys, easing="smooth", loop=True), 1 - 1e-6)[0][0]) / 1e-6
    assert start == pytest.approx(end, abs=1e-3)


def test_a_smooth_scale_never_swings_below_zero() -> None:
    keys: list[dict[str, object]] = [{"time": t, "scale": s} for t, s in ((0.0, 1), (0.3, 0), (0.6, 0), (1.0, 1))]
    sizes = [min(pose(group(keys, easing="smooth"), float(t))[2]) for t in np.linspace(0, 1, 101)]
    assert min(sizes) == 0
    assert max(sizes) == 1


def test_a_loop_turns_on_or_back_by_the_shorter_way() -> None:
    def end(last: float) -> float:
        thing = group([{"time": 0, "rotation_deg": [0, 0, 0]}, {"time": 0.5, "rotation_deg": [0, 0, last]}], loop=True)
        return pose(thing, 0.999999999)[1][2]

    assert end(120) == pytest.approx(0, abs=1e-5)
    assert end(180) == pytest.approx(360, abs=1e-5)
    assert end(300) == pytest.approx(360, abs=1e-5)
    assert end(-300) == pytest.approx(-360, abs=1e-5)
    assert end(720) == pytest.approx(720, abs=1e-5)


def test_a_whole_turn_is_a_loop() -> None:
    thing = group([{"time": 0, "rotation_deg": [0, 0, 0]}, {"time": 1, "rotation_deg": [0, 0, 360]}], loop=True)
    for t in (0.0, 0.25, 0.9):
        assert pose(thing, t)[1] == pytest.approx((0, 0, 360 * t))


def test_phase_shifts_time_and_channels_go_their_own_way() -> None:
    keys: list[dict[str, object]] = [
        {"time": 0.0, "position": [0, 0, 0]},
        {"time": 0.25, "scale": 2},
        {"time": 0.5, "position": [4, 0, 0]},
        {"time": 0.75, "scale": 1},
    ]
    early, late = group(keys, loop=True), group(keys, loop=True, phase=0.3)
    for t in (0.0, 0.2, 0.6):
        np.testing.assert_allclose(pose(early, (t + 0.3) % 1), pose(late, t))
    assert pose(early, 0.25)[0][0] == pytest.approx(2)
    assert pose(early, 0.5)[2][0] == pytest.approx(1.5)
    assert pose(Group(rotation_deg=(1, 2, 3), motion=early.motion), 0.1)[1] == (1, 2, 3)


@given(angles_deg=degrees, point=triple)
@settings(max_examples=60)
def test_rotations_keep_lengths_and_handedness(
    angles_deg: tuple[float, float, float], point: tuple[float, float, float]
) -> None:
    matrix = rotation_matrix(angles_deg)
    assert np.linalg.norm(matrix @ point) == pytest.approx(np.linalg.norm(point))
    assert np.linalg.det(matrix) == pytest.approx(1)


def test_rotation_is_about_x_then_y_then_z() -> None:
    np.testing.assert_allclose(rotation_matrix((90, 0, 0)) @ [0, 1, 0], [0, 0, 1], atol=1e-15)
    np.testing.assert_allclose(rotation_matrix((0, 90, 0)) @ [0, 0, 1], [1, 0, 0], atol=1e-15)
    np.testing.assert_allclose(rotation_matrix((0, 0, 90)) @ [1, 0, 0], [0, 1, 0], atol=1e-15)
    np.testing.assert_allclose(rotation_matrix((90, 0, 90)) @ [0, 1, 0], [0, 0, 1], atol=1e-15)
    np.testing.assert_allclose(rotation_matrix((90, 90, 0)) @ [0, 1, 0], [1, 0, 0], atol=1e-15)


@given(inner=st.tuples(triple, degrees), outer=st.tuples(triple, degrees), point=triple)
@settings(max_examples=40)
def test_parents_are_applied_after_the_child(
    inner: tuple[tuple[float, float, float], tuple[float, float, float]],
    outer: tuple[tuple[float, float, float], tuple[float, float, float]],
    point: tuple[float, float, float],
) -> None:
    groups = {"out": Group(position=outer[0], rotation_deg=outer[1], scale=(2.0, 0.5, 3.0))}
    child = Group(position=inner[0], rotation_deg=inner[1], scale=(1.5, 1.0, 0.7), parent="out")
    place = placement(child, groups, 0.0)
    middle = rotation_matrix(inner[1]) @ (np.array([1.5, 1.0, 0.7]) * point) + inner[0]
    wanted = rotation_matrix(outer[1]) @ (np.array([2.0, 0.5, 3.0]) * middle) + outer[0]
    np.testing.assert_allclose(place[:, :3] @ point + place[:, 3], wanted, atol=1e-9)
