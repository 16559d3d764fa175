"""Shapes in rigid motion: times of impact, motion casts and continuous collision of scenes."""

import numpy as np
import pytest
import winnow
from hypothesis import given, settings
from hypothesis import strategies as st
from test_hostile import any_array, refused
from test_narrow import CUBE, poses_at
from worlds import answered_or_refused

RANDOM = np.random.default_rng(71)
CLOSE = 1e-5


def random_poses(count, side):
    turns = RANDOM.normal(size=(count, 4))
    places = RANDOM.uniform(-side, side, (count, 3))
    return np.hstack([places, turns / np.linalg.norm(turns, axis=1, keepdims=True)])


def bounded_distances(shapes, shape_of, poses, pairs):
    """Returns the distances of pairs of convex shapes at rest, and their error bounds."""
    result = winnow.NarrowPhase().collide(shapes, shape_of, poses, pairs, level="distance")
    distance, bound = np.empty(len(pairs)), np.empty(len(pairs))
    distance[result.pair], bound[result.pair] = result.distance, result.error_bound
    return distance, bound


def distances(shapes, shape_of, poses, pairs):
    """Returns the distances of pairs of convex shapes at rest."""
    return bounded_distances(shapes, shape_of, poses, pairs)[0]


def ball_times(radius, start, end, pairs):
    """Returns when moving balls first touch, by the quadratic equation; infinity if they do not."""
    first, second = pairs.T
    gap = start[second] - start[first]
    speed = (end[second] - start[second]) - (end[first] - start[first])
    reach = radius[first] + radius[second]
    a, b = (speed**2).sum(axis=1), (gap * speed).sum(axis=1)
    c = (gap**2).sum(axis=1) - reach**2
    with np.errstate(invalid="ignore", divide="ignore"):
        time = (-b - np.sqrt(b * b - a * c)) / a
    time = np.where(np.isfinite(time) & (time >= 0) & (time <= 1), time, np.inf)
    return np.where(c <= 0, 0.0, time)


@pytest.fixture(scope="module")
def crowd():
    """Returns convex shapes of several kinds, motions of 40 bodies, and all of their pairs."""
    shapes = winnow.Shapes()
    ids = np.concatenate(
        [
            shapes.add_spheres([0.4, 0.7]),
            shapes.add_capsules(0.2, 1.0),
            shapes.add_boxes([[1.0, 0.2, 0.4]]),
            shapes.add_cones(0.5, 0.6),
            [shapes.add_hull(CUBE * [1.2, 0.1, 0.3])],
        ]
    )
    shape_of = ids[np.arange(40) % len(ids)]
    motions = winnow.motions_between(random_poses(40, 4), random_poses(40, 4))
    pairs = np.stack(np.triu_indices(40, 1), axis=1).astype(np.uint32)
    return shapes, shape_of, motions, pairs


def test_motions_begin_and_end_at_the_given_poses():
    start, end = random_poses(30, 9), random_poses(30, 9)
    motions = winnow.motions_between(start, (end[:, :3], end[:, 3:].astype(np.float32)))
    assert motions.shape == (30, 13) and np.array_equal(motions[:, :7], start)
    assert np.allclose(winnow.poses_at(motions, 0.0)[:, :3], start[:, :3])
    last = winnow.poses_at(motions, np.ones(30))
    assert np.allclose(last[:, :3], end[:, :3])
    assert np.abs((last[:, 3:] * end[:, 3:]).sum(axis=1)) == pytest.approx(1, abs=1e-6)
    assert np.linalg.norm(motions[:, 10:], axis=1).max() <= np.pi + 1e-12
    spin = winnow.motions_by_velocities(poses_at([0, 0, 0]), [1, 2, 3], [0, 0, 4 * np.pi], 0.5)
    assert np.allclose(spin[0, 7:], [0.5, 1, 1.5, 0, 0, 2 * np.pi])
    half = winnow.poses_at(spin, 0.25)[0]
    assert np.allclose(half[:3], [0.125, 0.25, 0.375])
    assert np.allclose(half[3:], [np.cos(np.pi / 4), 0, 0, np.sin(np.pi / 4)])


def test_ball_impacts_solve_the_quadratic_equation():
    shapes = winnow.Shapes()
    radius = RANDOM.uniform(0.1, 0.5, 60)
    ids = shapes.add_spheres(radius)
    start, end = RANDOM.uniform(-2, 2, (2, 60, 3))
    pairs = np.stack(np.triu_indices(60, 1), axis=1).astype(np.uint32)
    truth = ball_times(radius, start, end, pairs)
    for parallel in (False, True):
        impacts = winnow.time_of_impact(
            shapes, ids, winnow.motions_between(start, end), pairs, parallel=parallel
        )
        assert len(impacts) == len(pairs) and impacts.hit.sum() > 100
        assert np.array_equal(impacts.hit, np.isfinite(truth))
        hit = impacts.hit
        assert (impacts.time[hit] <= truth[hit] + 1e-12).all() and (impacts.time[~hit] == 1).all()
        assert impacts.time[hit] == pytest.approx(truth[hit], abs=CLOSE)


def test_rotating_shapes_are_apart_before_the_impact(crowd):
    shapes, shape_of, motions, pairs = crowd
    impacts = winnow.time_of_impact(shapes, shape_of, motions, pairs)
    assert 50 < impacts.hit.sum() < len(pairs)
    overlapping = distances(shapes, shape_of, winnow.poses_at(motions, 0.0), pairs) <= 0
    assert (impacts.time[overlapping] == 0).all() and impacts.hit[overlapping].all()
    for share in np.linspace(0, 1, 24, endpoint=False):
        for i in np.nonzero(~overlapping)[0][::7]:
            poses = winnow.poses_at(motions[pairs[i]], share * impacts.time[i])
            assert distances(shapes, shape_of[pairs[i]], poses, [[0, 1]])[0] > 0
    for i in np.nonzero(impacts.hit & ~overlapping)[0]:
        poses = winnow.poses_at(motions[pairs[i]], impacts.time[i])
        there, bound = bounded_distances(shapes, shape_of[pairs[i]], poses, [[0, 1]])
        assert 0 <= there[0] <= 1e-5
        assert abs(there[0] - impacts.gap[i]) <= impacts.error_bound[i] + bound[0] + 1e-12


def test_mesh_impact_names_the_triangle():
    shapes = winnow.Shapes()
    ball = int(shapes.add_spheres(0.5)[0])
    floor = shapes.add_mesh([[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]], [[0, 1, 2], [0, 2, 3]])
    motions = winnow.motions_between(poses_at([0, 3, 2], [0, 0, 0]), poses_at([0, 3, -2], [0, 0, 0]))
    impacts = winnow.time_of_impact(shapes, [ball, floor], motions, [[0, 1], [1, 0]])
    assert impacts.time == pytest.approx(1.5 / 4, abs=CLOSE)
    assert impacts.part_b[0] == impacts.part_a[1] == 1
    assert impacts.part_a[0] == winnow.WHOLE_SHAPE
    assert impacts.normal[:, 2] == pytest.approx([-1, 1])


def test_columns_outlive_the_result(crowd):
    shapes, shape_of, motions, pairs = crowd
    impacts = winnow.time_of_impact(shapes, shape_of, motions, pairs)
    time, x = impacts.time[::-1], impacts.normal[:, 0]
    kept = time.copy(), x.copy()
    del impacts
    winnow.time_of_impact(shapes, shape_of, motions[::-1], pairs)
    assert np.array_equal(time, kept[0]) and np.array_equal(x, kept[1])
    assert not time.flags.writeable


def test_motions_of_any_layout_are_read(crowd):
    shapes, shape_of, motions, pairs = crowd
    truth = winnow.time_of_impact(shapes, shape_of, motions, pairs).time
    spread = np.repeat(motions, 2, axis=0)[::2]
    for same in (np.asfortranarray(motions), spread, motions[::-1][::-1], motions.tolist()):
        assert np.array_equal(winnow.time_of_impact(shapes, shape_of, same, pairs).time, truth)


def standing(shapes, shape_of, poses):
    scene = winnow.Scene(shapes)
    return scene, scene.add(shape_of, poses, data=np.arange(len(poses)))


def test_motion_casts_equal_pairwise_impacts(crowd):
    shapes, shape_of, motions, _ = crowd
    poses = random_poses(40, 4)
    scene, keys = standing(shapes, shape_of, poses)
    still = winnow.motions_between(poses, poses)
    closest = scene.cast_motions(shape_of, motions)
    lists = scene.cast_motions(shape_of, motions, "all")
    for i in range(40):
        both = np.vstack([motions[i : i + 1], still])
        kinds = np.concatenate([shape_of[i : i + 1], shape_of])
        truth = winnow.time_of_impact(shapes, kinds, both, [[0, 1 + k] for k in range(40)])
        hits = set(np.nonzero(truth.hit)[0].tolist())
        row = slice(int(lists.first[i]), int(lists.first[i + 1]))
        found = dict(zip(lists.data[row].tolist(), lists.t[row].tolist()))
        assert set(found) == hits
        for k, t in found.items():
            assert t == pytest.approx(truth.time[k], abs=CLOSE)
        assert (closest.key[i] == winnow.NULL_KEY) == (not hits)
        if hits:
            assert closest.t[i] == min(found.values()) == lists.t[row][0]
            assert keys[closest.data[i]] == closest.key[i]


def test_scene_impacts_equal_pairwise_impacts(crowd):
    shapes, shape_of, motions, pairs = crowd
    scene, keys = standing(shapes, shape_of, motions[:, :7])
    ends = winnow.poses_at(motions, 1.0)
    truth = winnow.time_of_impact(shapes, shape_of, winnow.motions_between(motions[:, :7], ends), pairs)
    expected = {tuple(p): t for p, t, hit in zip(pairs.tolist(), truth.time, truth.hit) if hit}
    impacts = scene.find_impacts(keys, ends)
    found = {(int(a), int(b)): t for a, b, t in zip(impacts.data_a, impacts.data_b, impacts.time)}
    assert set(found) == set(expected) and len(impacts.time) == len(expected)
    for pair, time in found.items():
        assert time == pytest.approx(expected[pair], abs=CLOSE)
    assert (np.diff(impacts.time) >= 0).all()
    assert np.array_equal(keys[impacts.data_a], impacts.a) and np.array_equal(keys[impacts.data_b], impacts.b)
    for body in range(40):
        own = [i for i in range(len(impacts.a)) if body in (impacts.data_a[i], impacts.data_b[i])]
        assert impacts.first[body] == (own[0] if own else winnow.NO_IMPACT)
    again = scene.find_impacts_of_motions(keys, winnow.motions_between(motions[:, :7], ends))
    assert np.array_equal(again.time, impacts.time) and np.array_equal(again.normal, impacts.normal)
    assert np.array_equal(scene.bodies(keys)["pose"], motions[:, :7])
    few = scene.find_impacts(keys, ends, first_only=True)
    first_of_few = few.time[few.first[few.first != winnow.NO_IMPACT]]
    assert first_of_few == pytest.approx(impacts.time[impacts.first[impacts.first != winnow.NO_IMPACT]], abs=CLOSE)


def test_continuous_options_select_pairs():
    shapes = winnow.Shapes()
    ball = int(shapes.add_spheres(0.5)[0])
    scene = winnow.Scene(shapes)
    wall = scene.add(ball, [[5, 0, 0]], "fixed", data=[9])
    keys = scene.add(ball, [[0, 0, 0], [2, 0, 0]], data=[1, 2])
    ends = [[10, 0, 0], [2, 0, 0]]

    def swept_pairs(**options):
        impacts = scene.find_impacts(keys, ends, **options)
        return {frozenset(pair) for pair in zip(impacts.data_a.tolist(), impacts.data_b.tolist())}

    assert swept_pairs() == {frozenset([1, 2]), frozenset([1, 9])}
    assert swept_pairs(pairs="fixed") == {frozenset([1, 9])}
    assert swept_pairs(pairs="bullets") == set()
    assert swept_pairs(pairs="bullets", bullets=[True, False]) == swept_pairs()
    assert swept_pairs(pairs="bullets_and_fixed", bullets=[False, False]) == {frozenset([1, 9])}
    scene.move(keys[1:], [[0.5, 0, 0]])
    assert scene.find_impacts(keys[:1], [[0.1, 0, 0]]).time.tolist() == [0]
    assert len(scene.find_impacts(keys[:1], [[0.1, 0, 0]], touching=False).time) == 0
    scene.remove(wall)
    assert len(scene.find_impacts(keys, ends, touching=False).time) == 0


def test_invalid_motions_are_refused(crowd):
    shapes, shape_of, motions, pairs = crowd
    scene, keys = standing(shapes, shape_of[:2], motions[:2, :7])
    bad = motions[:2].copy()
    bad[1, 8] = np.nan
    assert "end[1] is not finite" in refused(
        "invalid_pose", winnow.motions_between, np.zeros((2, 3)), [[0, 0, 0], [0, np.inf, 0]]
    )
    refused("invalid_pose", winnow.motions_by_velocities, motions[:1, :7], [0, 0, 0], [0, 0, 2e6])
    assert "motions[1] has a NaN" in refused("invalid_pose", winnow.poses_at, bad, 0.5)
    assert "times[1]" in refused("invalid_argument", winnow.poses_at, motions[:2], [0.5, 1.5])
    refused("invalid_argument", winnow.poses_at, motions[:2], np.nan)
    refused("size_mismatch", winnow.poses_at, motions[:, :12], 0.5)
    refused("size_mismatch", winnow.motions_between, motions[:2, :7], motions[:3, :7])
    impacts = winnow.time_of_impact
    assert "motions[1] has a NaN" in refused(
        "invalid_pose", impacts, shapes, shape_of[:2], bad, [[0, 0], [0, 1]]
    )
    refused("invalid_key", impacts, shapes, [shape_of[0], 99], motions[:2], [[0, 1]])
    refused("invalid_argument", impacts, shapes, shape_of[:2], motions[:2], [[0, 2]])
    refused("size_mismatch", impacts, shapes, shape_of[:3], motions[:2], [[0, 1]])
    for tolerance in (0.0, -1.0, np.nan, 2.0):
        refused(
            "invalid_argument", impacts, shapes, shape_of[:2], motions[:2], [[0, 1]],
            tolerance=tolerance,
        )
    refused("invalid_pose", scene.cast_motions, shape_of[:2], bad)
    refused("invalid_argument", scene.cast_motions, shape_of[:2], motions[:2], "any")
    refused("unsupported", scene.cast_motions, shapes.add_half_spaces([0, 0, 1]), motions[:1])
    refused("invalid_pose", scene.find_impacts_of_motions, keys, bad)
    refused("invalid_key", scene.find_impacts, np.repeat(keys[:1], 2), motions[:2, :7])
    refused("size_mismatch", scene.find_impacts, keys, motions[:1, :7])
    refused("size_mismatch", scene.find_impacts, keys, motions[:2, :7], bullets=[True])
    none = np.zeros(0, bool)
    refused("size_mismatch", scene.find_impacts, keys, motions[:2, :7], bullets=none)
    refused("size_mismatch", scene.find_impacts_of_motions, keys, motions[:2], bullets=none)
    assert len(scene.find_impacts(keys[:0], motions[:0, :7], bullets=none).time) == 0
    refused("invalid_argument", scene.find_impacts, keys, motions[:2, :7], pairs="some")
    with pytest.raises(TypeError):
        scene.find_impacts(keys, motions[:2, :7], bullets=[0, 7])
    assert len(impacts(shapes, shape_of[:2], motions[:2], np.empty((0, 2), int))) == 0
    assert len(scene.find_impacts([], np.empty((0, 7))).first) == 0


@given(any_array(), any_array(), any_array(), st.integers(0, 2**32 - 1))
@settings(max_examples=200)
def test_any_arrays_are_accepted_or_refused(first, second, third, number):
    shapes = winnow.Shapes()
    ids = shapes.add_spheres([1.0, 2.0])
    scene, keys = standing(shapes, ids, np.zeros((2, 3)))
    motions = winnow.motions_between(np.zeros((2, 3)), np.ones((2, 3)))
    answered_or_refused([
        lambda: winnow.motions_between(first, second),
        lambda: winnow.motions_between((first, second), third),
        lambda: winnow.motions_by_velocities(first, second, third, number),
        lambda: winnow.motions_by_velocities(np.zeros((2, 3)), first, second, third),
        lambda: winnow.poses_at(first, second),
        lambda: winnow.poses_at(motions, first),
        lambda: winnow.time_of_impact(shapes, first, second, third),
        lambda: winnow.time_of_impact(shapes, ids, motions, first),
        lambda: winnow.time_of_impact(shapes, number, motions, [[0, 1]]),
        lambda: scene.cast_motions(first, second),
        lambda: scene.cast_motions(number, motions, "all"),
        lambda: scene.cast_motions(ids, motions, tolerance=number),
        lambda: scene.find_impacts(first, second, bullets=third),
        lambda: scene.find_impacts(keys, first, bullets=second),
        lambda: scene.find_impacts(keys, (first, second)),
        lambda: scene.find_impacts_of_motions(keys, first),
    ])
    assert np.array_equal(scene.bodies(keys)["pose"][:, :3], np.zeros((2, 3)))
