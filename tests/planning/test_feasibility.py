"""What cannot be on a stage, and its figures: stages with one thing wrong, and the same stage said in two ways."""

import json
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lightcube.optics.grid import Grid
from lightcube.optics.stage import Lamp, Screen, Shot, Stage
from lightcube.planning.feasibility import doubtful, facts, impossible
from lightcube.projection.projector import Projector

SHAPES = [(3, 5, 7), (6, 4, 5)]
SIDE = 2.0
WAY = (1.0, 0.2, -0.4)


def stage(shape: tuple[int, int, int] = SHAPES[0], **changes: Any) -> Stage:
    """A raised lamp, a screen of a voxel's pitch well inside the shadow, and a picture at each of three stops."""
    wall = Screen("wall", (30.0, 6.0, -12.0), (6.0, 4.0), SIDE)
    given: dict[str, Any] = {
        "lamps": (Lamp("sun", direction=WAY),),
        "screens": (wall,),
        "shots": tuple(Shot(name, "wall", ("sun",), stop) for stop, name in enumerate(("ann", "bob", "cat"))),
        "stops_deg": (10.0, 95.0, 220.0),
    }
    return Stage(Grid(shape, SIDE), **(given | changes))


def with_screen(shape: tuple[int, int, int] = SHAPES[0], **changes: Any) -> Stage:
    plain = stage(shape)
    return replace(plain, screens=(replace(plain.screens[0], **changes),))


def with_point(x: float, y: float, z: float) -> Stage:
    return stage(lamps=(Lamp("sun", position_mm=(x, y, z)),))


@pytest.mark.parametrize("rear", [False, True])
@pytest.mark.parametrize("shape", SHAPES)
def test_nothing_is_wrong_with_a_plain_stage(shape: tuple[int, int, int], rear: bool) -> None:
    assert impossible(with_screen(shape, rear=rear)) == []
    assert doubtful(with_screen(shape, rear=rear)) == []


@pytest.mark.parametrize("rear", [False, True])
@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (with_point(1.0, 0.5, 2.0), ["lamp 'sun' stands inside the cube"]),
        (with_screen(normal=(-0.2, 1.0, 0.0)), ["screen 'wall' is edge-on to lamp 'sun'"]),
        (with_screen(normal=(1.0, 0.0, 0.0)), ["lamp 'sun' lights the back of screen 'wall'"]),
        (with_screen(centre_mm=(-30.0, -6.0, 12.0)), ["screen 'wall' stands between lamp 'sun' and the cube"]),
        (
            with_screen(centre_mm=(-30.0, -6.0, 12.0), normal=(-1.0, 0.0, 0.0)),
            ["screen 'wall' stands between lamp 'sun' and the cube"],
        ),
        (with_screen(centre_mm=(1.0, 1.0, 0.0), normal=(-1.0, 0.0, 0.0)), ["screen 'wall' cuts through the cube"]),
        (
            with_screen(centre_mm=(30.0, 40.0, -12.0), normal=(-1.0, 0.0, 0.0)),
            ["miss screen 'wall'", "(30, 6, -12) mm"],
        ),
        (with_point(20.0, 4.0, -8.0), ["lamp 'sun' stands between the cube and screen 'wall'"]),
    ],
)
def test_one_wrong_thing_is_one_sentence(wrong: Stage, words: list[str], rear: bool) -> None:
    (said,) = impossible(replace(wrong, screens=(replace(wrong.screens[0], rear=rear),)))
    assert all(word in said for word in [*words, "at stops 1 to 3:"])
    json.dumps(facts(wrong), allow_nan=False)
    doubtful(wrong)


def test_a_screen_beside_the_cube_does_not_cut_it_though_its_plane_does() -> None:
    beside = with_screen(centre_mm=(0.0, 40.0, 0.0), normal=(-1.0, 0.0, 0.0))
    assert "miss" in impossible(beside)[0]
    # against the very face it is as near as can be
    touching = stage(
        lamps=(Lamp("sun", direction=(1.0, 0.0, 0.0)),),
        screens=(Screen("wall", (7.0, 0.0, 0.0), (6.0, 4.0), SIDE),),
        cube_turns=False,
        shots=(Shot("ann", "wall", ("sun",)),),
    )
    assert impossible(touching) == []


def test_stops_where_it_is_wrong_are_told_from_those_where_it_is_not() -> None:
    # 3 x 5 x 7 voxels of 2 mm: at a quarter turn a point 6 mm along x is beside the cube
    turned = replace(with_point(-6.0, 0.0, 0.0), stops_deg=(0.0, 90.0, 180.0))
    assert ["inside the cube at stops 1 and 3:" in said for said in impossible(turned)] == [True]


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("axis", [(0.0, 0.0, 1.0), (0.3, -1.0, 0.5)])
def test_turning_the_cube_is_turning_the_room_the_other_way(shape: tuple[int, int, int], axis: Any) -> None:
    cube_turns = replace(stage(shape, axis=axis), stops_deg=(10.0, 95.0, 155.0))
    room_turns = replace(
        cube_turns,
        lamps=tuple(replace(lamp, turns=True) for lamp in cube_turns.lamps),
        screens=tuple(replace(screen, turns=True) for screen in cube_turns.screens),
        stops_deg=tuple(-angle_deg for angle_deg in cube_turns.stops_deg),
        cube_turns=False,
    )
    for one, other in zip(facts(cube_turns)["per_picture"], facts(room_turns)["per_picture"], strict=True):
        assert one["beams_in_cube"] == other["beams_in_cube"]
        assert one["pixel_in_voxels"] == pytest.approx(other["pixel_in_voxels"])
    assert impossible(cube_turns) == impossible(room_turns)


def test_a_screen_that_goes_round_with_the_cube_under_a_fixed_lamp_is_wrong_at_most_stops() -> None:
    carried = replace(with_screen(turns=True), stops_deg=(0.0, 90.0, 180.0))
    missed, behind = impossible(carried)
    assert "miss screen 'wall' at stop 2:" in missed
    assert "lamp 'sun' lights the back of screen 'wall' at stop 3:" in behind


def half_turn(tilt: float, **changes: Any) -> Stage:
    wall = Screen("wall", (30.0, 0.0, 30.0 * tilt), (6.0, 4.0), SIDE)
    shots = (Shot("ann", "wall", ("sun",)), Shot("bob", "wall", ("sun",), 1))
    lamps = (Lamp("sun", direction=(1.0, 0.0, tilt)),)
    return stage(**({"lamps": lamps, "screens": (wall,), "shots": shots, "stops_deg": (20.0, 200.0)} | changes))


def test_level_light_shows_the_same_beams_half_a_turn_on_and_raised_light_does_not() -> None:
    (said,) = impossible(half_turn(0.0))
    assert all(word in said for word in ("'ann' (stop 1)", "'bob' (stop 2)", "same beams", "100%"))
    assert impossible(half_turn(-0.1)) == []


def test_lamps_that_share_no_colour_share_no_beams() -> None:
    red, blue = (
        Lamp(name, direction=(1.0, 0.0, 0.0), colour=colour)
        for name, colour in (("red", (1.0, 0.2, 0.0)), ("blue", (0.0, 0.0, 1.0)))
    )
    shots = (Shot("ann", "wall", ("red",)), Shot("bob", "wall", ("blue",), 1))
    assert impossible(half_turn(0.0, lamps=(red, blue), shots=shots)) == []
    assert len(impossible(half_turn(0.0, lamps=(red, replace(blue, colour=(0.0, 0.1, 1.0))), shots=shots))) == 1


@pytest.mark.parametrize("shots", [("left", "right"), ("right", "left")])
@pytest.mark.parametrize(("apart", "share"), [(4.0, None), (2.0, "50%"), (0.0, "100%")])
@pytest.mark.parametrize("lamp", [Lamp("sun", direction=(0.0, 1.0, 0.0)), Lamp("sun", position_mm=(0.0, -30.0, 0.0))])
def test_screens_side_by_side_share_beams_as_far_as_they_overlap(
    lamp: Lamp, apart: float, share: str | None, shots: tuple[str, str]
) -> None:
    # the second screen is twice as far from the point lamp and twice as large
    far, grow = (130.0, 2.0) if lamp.position_mm else (90.0, 1.0)
    left = Screen("left", (-2.0, 50.0, 0.0), (4.0, 4.0), 1.0, normal=(0.0, -1.0, 0.0))
    centre_mm = ((-2.0 + apart) * grow, far, 0.0)
    right = replace(left, name="right", centre_mm=centre_mm, size_mm=(4.0 * grow, 4.0 * grow), pitch_mm=grow)
    wanted = tuple(Shot(name, name, ("sun",)) for name in shots)
    said = impossible(stage(lamps=(lamp,), screens=(left, right), shots=wanted, stops_deg=(0.0,)))
    assert len(said) == (share is not None)
    assert all(f", {share} of them" in each for each in said)


@pytest.mark.parametrize(
    ("left", "wide", "high", "pitch"),
    [(0.0, 14.0, 4.0, 1.0), (-9.0, 30.0, 4.0, 10.0)],
    ids=["half of it bare", "pixels that hold a whole picture"],
)
def test_shared_beams_are_those_through_the_cube_of_the_picture_that_shares_more(
    left: float, wide: float, high: float, pitch: float
) -> None:
    # the cube is 14 mm wide; the other screen is its left half, or lies between middles of pixels
    large = Screen("large", (left + wide / 2, 50.0, 0.0), (wide, high), pitch, normal=(0.0, -1.0, 0.0))
    other = Screen("other", (0.0, 60.0, 0.0), (14.0 if pitch == 1 else 2.0, 4.0), 1.0, normal=(0.0, -1.0, 0.0))
    shots = (Shot("ann", "large", ("sun",)), Shot("bob", "other", ("sun",)))
    lamps = (Lamp("sun", direction=(0.0, 1.0, 0.0)),)
    (said,) = impossible(stage(lamps=lamps, screens=(large, other), shots=shots, stops_deg=(0.0,)))
    assert "'ann' (stop 1) and 'bob' (stop 1) are cast by the same beams through the cube, 100%" in said


def test_a_screen_shows_one_picture_at_a_stop() -> None:
    shots = (Shot("ann", "wall", ("sun",)), Shot("bob", "wall", ("sun",), 1), Shot("cat", "wall", ("sun",), 2))
    (said,) = impossible(stage(shots=shots, stops_deg=(10.0, 95.0, 370.0)))
    assert "'ann' (stop 1) and 'cat' (stop 3)" in said
    assert "'wall'" in said


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(
    "lamp",
    [
        Lamp("sun", direction=WAY),
        Lamp("sun", position_mm=(-20.0, -3.0, 9.0)),
        Lamp("sun", position_mm=(-8.5, 3.0, 2.0)),
    ],
)
def test_the_beams_that_meet_the_cube_are_those_of_the_matrix(shape: tuple[int, int, int], lamp: Lamp) -> None:
    wide = stage(shape, lamps=(lamp,), screens=(Screen("wall", (30.0, 6.0, -12.0), (38.0, 27.0), 1.9),))
    rig = wide.rig()
    matrix = Projector(wide.grid, rig)
    met = (np.diff(matrix.to_sparse().tocsr().indptr) > 0).reshape(3, -1).mean(axis=1)
    assert 0 < met.min() < 1
    assert [each["beams_in_cube"] for each in facts(wide)["per_picture"]] == pytest.approx(met.tolist())


def test_no_beam_meets_a_cube_beyond_the_screen_or_behind_the_lamp() -> None:
    for wrong in (with_screen(centre_mm=(-30.0, -6.0, 12.0)), with_point(20.0, 4.0, -8.0)):
        assert {each["beams_in_cube"] for each in facts(wrong)["per_picture"]} == {0.0}


def test_figures_of_a_small_screen_do_not_depend_on_a_larger_one() -> None:
    small = Screen("wall", (30.0, 10.0, -12.0), (6.0, 10.0), 1.9)
    large = Screen("east", (35.0, 7.0, -14.0), (38.0, 27.0), 1.9)
    together = stage(screens=(large, small), shots=(*stage().shots, Shot("dot", "east", ("sun",), 1)))
    assert facts(together)["per_picture"][:3] == facts(stage(screens=(small,)))["per_picture"]
    assert 0 < facts(together)["per_picture"][0]["beams_in_cube"] < 1


def test_a_pixel_is_as_wide_at_the_cube_as_the_lamp_throws_it() -> None:
    straight = Screen("wall", (30.0, 0.0, 0.0), (6.0, 4.0), 1.5)
    shots = (Shot("ann", "wall", ("sun",)),)
    pixels = {}
    for key, lamp in {
        "parallel": Lamp("sun", direction=(1.0, 0.0, 0.0)),
        "point": Lamp("sun", position_mm=(-20.0, 0.0, 0.0)),
        "aslant": Lamp("sun", direction=(1.0, 0.0, -math.sqrt(3))),
    }.items():
        (figures,) = facts(stage(lamps=(lamp,), screens=(straight,), shots=shots))["per_picture"]
        pixels[key] = figures["pixel_in_voxels"]
    assert pixels["parallel"] == pytest.approx(1.5 / SIDE)
    assert pixels["point"] == pytest.approx(1.5 / SIDE * 20 / 50)
    assert pixels["aslant"] == pytest.approx(1.5 / SIDE * math.sqrt(0.5))


def test_facts_count_and_go_into_json() -> None:
    two = stage(lamps=(Lamp("sun", direction=WAY), Lamp("moon", position_mm=(-30.0, -6.0, 14.0))))
    both = replace(two, shots=(Shot("ann", "wall", ("sun", "moon"), 2), Shot("bob", "wall", ("moon",), 0)))
    found = json.loads(json.dumps(facts(both), allow_nan=False))
    assert [found[key] for key in ("lamps", "screens", "stops", "pictures", "views")] == [2, 1, 3, 2, 3]
    first = found["per_picture"][0]
    assert (first["name"], first["screen"], first["lamps"]) == ("ann", "wall", ["sun", "moon"])
    assert (first["stop"], first["angle_deg"], first["rows"], first["columns"]) == (3, 220.0, 2, 3)
    assert first["distance_mm"] == pytest.approx(math.sqrt(30**2 + 6**2 + 12**2))


def test_what_no_picture_names_is_doubtful() -> None:
    spare = stage(
        lamps=(Lamp("sun", direction=WAY), Lamp("moon", direction=(0.0, 1.0, 0.0))),
        screens=(stage().screens[0], Screen("loft", (0.0, 0.0, 99.0), (6.0, 4.0), SIDE)),
    )
    assert ["'moon'" in doubtful(spare)[0], "'loft'" in doubtful(spare)[1], len(doubtful(spare))] == [True, True, 2]


def test_light_of_other_pictures_is_doubtful_where_it_throws_a_shadow_on_this_one() -> None:
    lamps = (Lamp("sun", direction=WAY), Lamp("dawn", direction=(1.0, 0.25, -0.4)), Lamp("moon", direction=(0, 1, 0)))
    walls = (
        stage().screens[0],
        replace(stage().screens[0], name="east", centre_mm=(40.0, 10.0, -16.0), size_mm=(2.0, 2.0)),
        Screen("north", (0.0, 40.0, 0.0), (6.0, 4.0), SIDE),
    )
    shots = tuple(
        Shot(name, name, (lamp,), stop)
        for stop in (0, 1)
        for name, lamp in (("wall", "sun"), ("east", "dawn"), ("north", "moon"))
    )
    strays = [said for said in doubtful(stage(lamps=lamps, screens=walls, shots=shots)) if "also catches" in said]
    assert len(strays) == 2
    assert all(word in strays[0] for word in ("screen 'wall'", "lamp 'dawn'", "stops 1 and 2"))
    assert all(word in strays[1] for word in ("screen 'east'", "lamp 'sun'"))


def test_screens_in_the_way_small_shadows_and_fine_pixels_are_doubtful() -> None:
    before = Screen("card", (20.0, 4.0, -8.0), (2.0, 2.0), SIDE)
    blocked = stage(screens=(stage().screens[0], before), shots=(*stage().shots, Shot("dot", "card", ("sun",), 0)))
    assert any(
        "'card' stands in the beams of lamp 'sun' to screen 'wall' at stops 1 to 3" in s for s in doubtful(blocked)
    )
    assert not any("screen 'wall' stands" in said for said in doubtful(blocked))
    carried = replace(blocked, screens=(stage().screens[0], replace(before, turns=True)), stops_deg=(0.0, 95.0, 220.0))
    assert any(
        "'card' stands in the beams of lamp 'sun' to screen 'wall' at stop 1:" in said for said in doubtful(carried)
    )
    # half a turn on it would be in the way of the beams of the stop before
    round_the_back = replace(before, centre_mm=(-20.0, -4.0, -8.0))
    half = stage(screens=(stage().screens[0], round_the_back), stops_deg=(0.0, 180.0), shots=stage().shots[:2])
    assert not any("stands in" in said for said in doubtful(half))
    behind = replace(before, centre_mm=(-40.0, -8.0, 16.0))
    past = stage(lamps=(Lamp("sun", position_mm=(-25.0, -5.0, 10.0)),), screens=(stage().screens[0], behind))
    assert ["no picture names screen 'card'" in said for said in doubtful(past) if "card" in said] == [True]
    (bare,) = doubtful(with_screen(size_mm=(60.0, 60.0)))
    assert all(word in bare for word in ("less than half of screen 'wall'", "lamp 'sun'", "stops 1 to 3"))
    (fine,) = doubtful(with_screen(pitch_mm=0.5))
    assert all(word in fine for word in ("pixels of screen 'wall'", "stops 1 to 3", "make pitch_mm about 2"))
