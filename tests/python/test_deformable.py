"""Cloth: features that may touch, touch, or are near each other, compared with brute force."""


import numpy as np
import pytest
import winnow
from hypothesis import given, settings
from hypothesis import strategies as st
from test_hostile import any_array, refused
from test_narrow import poses_at
from worlds import answered_or_refused, at_once

KINDS = ("vertex_face", "edge_edge")


def sheet(side, height=0.0):
    """Returns a square of side x side vertices in the plane z = height, and its triangles."""
    x, y = np.meshgrid(np.arange(side), np.arange(side), indexing="ij")
    places = np.stack([x.ravel(), y.ravel(), np.full(side * side, height)], axis=1).astype(float)
    corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    lower = np.stack([corner, corner + side, corner + 1], axis=1)
    upper = np.stack([corner + 1, corner + side, corner + side + 1], axis=1)
    return places, np.vstack([lower, upper]).astype(np.uint32)


def crumpled(seed, side=7):
    random = np.random.default_rng(seed)
    rest, triangles = sheet(side)
    start = random.uniform(0, 3, rest.shape)
    return rest, triangles, start, start + random.normal(0, 0.6, rest.shape)


def edges_of(triangles):
    ends = np.sort(np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [0, 2]]]), 1)
    return np.unique(ends, axis=0)


def features(kind, triangles, vertices):
    """Returns the corners of the first features and of the second."""
    if kind == "vertex_face":
        return np.arange(vertices)[:, None], triangles
    return edges_of(triangles), edges_of(triangles)


def box_pairs(kind, triangles, start, end, reach):
    """Returns the pairs of features of one mesh that share no vertex and whose boxes overlap."""
    firsts, seconds = features(kind, triangles, len(start))
    points = np.stack([start, end])
    pairs = set()
    for i, first in enumerate(firsts):
        low = points[:, first].min(axis=(0, 1)) - reach
        high = points[:, first].max(axis=(0, 1)) + reach
        for j, second in enumerate(seconds):
            if set(first) & set(second) or (kind == "edge_edge" and j <= i):
                continue
            if (points[:, second].min(axis=(0, 1)) <= high).all() and (
                points[:, second].max(axis=(0, 1)) >= low
            ).all():
                pairs.add((i, j))
    return pairs


def corners(kind, triangles, places, pairs):
    """Returns the four points of each pair, in the order of feature_impacts."""
    firsts, seconds = features(kind, triangles, len(places))
    pairs = np.asarray(pairs, np.int64).reshape(-1, 2)
    return np.concatenate([places[firsts[pairs[:, 0]]], places[seconds[pairs[:, 1]]]], axis=1)


def as_set(pairs):
    return set(map(tuple, pairs.tolist()))


@pytest.mark.parametrize("kind", KINDS)
def test_candidates_are_pairs_of_overlapping_boxes(kind):
    rest, triangles, start, end = crumpled(1)
    mesh = winnow.DeformableMesh()
    mesh.build(rest, triangles)
    mesh.move(start, end)
    assert (mesh.triangles, mesh.vertices) == (len(triangles), len(rest))
    assert np.array_equal(mesh.edges(), edges_of(triangles))
    candidates = mesh.self_candidates(kind)
    found = as_set(candidates)
    assert len(found) == len(candidates) > 50 and candidates.dtype == np.uint32
    assert found >= box_pairs(kind, triangles, start, end, 0)
    assert found <= box_pairs(kind, triangles, start, end, 1e-5)


@pytest.mark.parametrize("kind", KINDS)
def test_mesh_impacts_equal_feature_impacts(kind):
    rest, triangles, start, end = crumpled(2)
    mesh = winnow.DeformableMesh(parallel=False)
    mesh.build(rest.astype(np.float32), triangles.astype(np.int64))
    mesh.move(start, end)
    pairs = sorted(box_pairs(kind, triangles, start, end, 0))
    truth = winnow.feature_impacts(
        kind, corners(kind, triangles, start, pairs), corners(kind, triangles, end, pairs)
    )
    impacts = mesh.self_impacts(kind)
    found = dict(zip(map(tuple, impacts.features.tolist()), impacts.time.tolist()))
    assert len(found) == len(impacts.time) > 5
    assert found == {pair: time for pair, time in zip(pairs, truth) if np.isfinite(time)}


def test_features_touch_at_known_times():
    triangle = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], float)
    falling = np.array([[0.2, 0.2, 1], [0.2, 0.2, 3], [2, 2, 1]], float)
    start = np.stack([np.vstack([p, triangle]) for p in falling])
    end = start.copy()
    end[:, 0, 2] = -1
    times = winnow.feature_impacts("vertex_face", start, end)
    assert times[:2] == pytest.approx([0.5, 0.75]) and np.isinf(times[2])
    assert (times[:2] <= [0.5, 0.75]).all()
    early = winnow.feature_impacts("vertex_face", start.astype(np.float32), end, min_separation=0.5)
    assert early[0] == pytest.approx(0.25, abs=1e-6)
    end[1, 0, 0] = np.nan
    assert np.isnan(winnow.feature_impacts("vertex_face", start, end)[1])
    crossing = np.array([[[-1, 0, 1], [1, 0, 1], [0, -1, 0], [0, 1, 0]]], float)
    after = crossing.copy()
    after[:, :2, 2] = -3
    assert winnow.feature_impacts("edge_edge", crossing, after) == pytest.approx(0.25)
    assert len(winnow.feature_impacts("edge_edge", np.empty((0, 4, 3)), np.empty((0, 4, 3)))) == 0


def segment_distance(points):
    """Returns the distance of edges (0, 1) and (2, 3), by sampling both."""
    share = np.linspace(0, 1, 201)[:, None]
    first = points[0] + share * (points[1] - points[0])
    second = points[2] + share * (points[3] - points[2])
    return np.linalg.norm(first[:, None] - second[None], axis=2).min()


def test_near_edges_have_the_sampled_distance():
    rest, triangles, start, end = crumpled(3, 5)
    mesh = winnow.DeformableMesh()
    mesh.build(rest, triangles)
    mesh.move(end, end, distance=0.2)
    near = mesh.self_proximity("edge_edge", 0.2)
    pairs = sorted(box_pairs("edge_edge", triangles, end, end, 0.21))
    points = corners("edge_edge", triangles, end, pairs)
    slow = np.array([segment_distance(four) for four in points])
    found = dict(zip(map(tuple, near.features.tolist()), near.distance.tolist()))
    for pair, distance in zip(pairs, slow):
        if distance < 0.18:
            assert found[pair] == pytest.approx(distance, abs=0.02)
        assert distance > 0.19 or pair in found
    assert near.distance.max() <= 0.2 and len(found) == len(near.distance) > 5
    gap = np.linalg.norm(near.point_a - near.point_b, axis=1)
    assert near.distance == pytest.approx(gap, abs=1e-12)
    made = corners("edge_edge", triangles, end, near.features)
    first = (near.weight[:, :2, None] * made[:, :2]).sum(axis=1)
    second = (near.weight[:, 2:, None] * made[:, 2:]).sum(axis=1)
    assert np.allclose(first, near.point_a) and np.allclose(second, near.point_b)


@pytest.mark.parametrize("kind", KINDS)
def test_two_sheets_touch_during_the_motion(kind):
    low, triangles = sheet(5)
    high = sheet(5, 1.0)[0] + [0.25, 0.25, 0]
    meshes = winnow.DeformableMesh(), winnow.DeformableMesh()
    for mesh, places in zip(meshes, (low, high)):
        mesh.build(places, triangles)
    meshes[0].move(low, low, distance=0.2)
    meshes[1].move(high, high - [0, 0, 2], distance=0.2)
    impacts = meshes[1].impacts_with(meshes[0], kind)
    assert len(impacts.time) >= 16 and impacts.time == pytest.approx(0.5, abs=1e-9)
    assert as_set(impacts.features) <= as_set(meshes[1].candidates_with(meshes[0], kind))
    assert len(meshes[0].self_impacts(kind).time) == 0
    meshes[1].move(high - [0, 0, 0.95], high - [0, 0, 0.95], distance=0.2)
    near = meshes[1].proximity_with(meshes[0], kind, 0.1)
    assert near.distance == pytest.approx(0.05, abs=1e-6) and len(near.distance) >= 16
    assert len(meshes[1].proximity_with(meshes[0], kind, 0.04).distance) == 0


def test_ball_that_falls_on_cloth_hits():
    shapes = winnow.Shapes()
    ball = int(shapes.add_spheres(0.25)[0])
    cloth = winnow.DeformableMesh()
    places, triangles = sheet(5)
    cloth.build(places, triangles)
    cloth.move(places, places + [0, 0, 1], distance=0.1)
    fall = winnow.motions_between(poses_at([2.3, 2.3, 3]), poses_at([2.3, 2.3, 1]))
    impacts = cloth.impacts_with_shape(shapes, ball, fall)
    first = np.argmin(impacts.time)
    assert impacts.time[first] == pytest.approx(2.75 / 3, abs=1e-5)
    assert impacts.normal[first] == pytest.approx([0, 0, -1], abs=1e-5)
    assert impacts.point[first] == pytest.approx([2.3, 2.3, impacts.time[first]], abs=1e-5)
    assert places[triangles[impacts.face[first]]][:, :2].min() == 2
    assert impacts.part[first] == winnow.WHOLE_SHAPE and impacts.gap[first] >= 0
    early = cloth.impacts_with_shape(shapes, ball, fall, separation=0.05)
    assert early.time.min() == pytest.approx(2.70 / 3, abs=1e-5)


def test_input_arrays_may_change_after_a_step():
    rest, triangles, start, end = crumpled(4)
    mesh = winnow.DeformableMesh()
    mesh.build(rest, triangles)
    mesh.move(start, end)
    truth = mesh.self_impacts("vertex_face")
    kept = truth.time.copy()
    for array in (rest, start, end):
        array[:] = np.nan
    del rest, start, end
    assert np.array_equal(mesh.self_impacts("vertex_face").time, kept)
    mesh.move(*crumpled(5)[2:])
    assert np.array_equal(truth.time, kept)


def test_refused_step_changes_nothing():
    rest, triangles, start, end = crumpled(6)
    mesh = winnow.DeformableMesh()
    refused("invalid_argument", mesh.self_candidates, "edge_edge")
    refused("invalid_argument", mesh.move, rest, rest)
    mesh.build(rest, triangles)
    refused("invalid_argument", mesh.self_impacts, "edge_edge")
    mesh.move(start, end, distance=0.1)
    truth = mesh.self_proximity("edge_edge", 0.1).distance.tolist()
    bad = end.copy()
    bad[3, 1] = np.inf
    refused("invalid_bounds", mesh.move, start, bad)
    refused("size_mismatch", mesh.move, start[1:], end[1:])
    refused("invalid_argument", mesh.move, start, end, distance=-1.0)
    refused("invalid_shape", mesh.build, rest, triangles + 1)
    refused("invalid_bounds", mesh.build, bad, triangles)
    refused("invalid_bounds", winnow.DeformableMesh(origin=(np.nan, 0, 0)).build, start, triangles)
    refused("invalid_argument", mesh.self_proximity, "edge_edge", 0.2)
    refused("invalid_argument", mesh.self_proximity, "edge_edge", np.nan)
    refused("invalid_argument", mesh.self_impacts, "edge_edge", min_separation=0.2)
    refused("invalid_argument", mesh.self_impacts, "edge_edge", tolerance=0.0)
    refused("invalid_argument", mesh.self_impacts, "edge_edge", max_intervals=0)
    refused("invalid_argument", mesh.self_candidates, "vertex_edge")
    other = winnow.DeformableMesh(origin=[5, 0, 0])
    other.build(rest, triangles)
    other.move(start, end)
    refused("invalid_argument", mesh.candidates_with, other, "edge_edge")
    shapes = winnow.Shapes()
    fall = winnow.motions_between(poses_at([0, 0, 0]), poses_at([0, 0, 1]))
    refused("invalid_key", mesh.impacts_with_shape, shapes, 0, fall)
    ball = int(shapes.add_spheres(1.0)[0])
    refused("size_mismatch", mesh.impacts_with_shape, shapes, ball, np.vstack([fall, fall]))
    refused("invalid_pose", mesh.impacts_with_shape, shapes, ball, fall * np.nan)
    refused("invalid_argument", mesh.impacts_with_shape, shapes, ball, fall, separation=1.0)
    assert mesh.self_proximity("edge_edge", 0.1).distance.tolist() == truth
    assert mesh.footprint()[1] > 0


@given(any_array(), any_array(), any_array(), st.integers(0, 2**32 - 1), st.sampled_from(KINDS))
@settings(max_examples=200)
def test_any_arrays_are_accepted_or_refused(first, second, third, number, kind):
    rest, triangles, start, end = crumpled(7, 3)
    shapes = winnow.Shapes()
    ball = int(shapes.add_spheres(1.0)[0])
    mesh = winnow.DeformableMesh()
    mesh.build(rest, triangles)
    answered_or_refused([
        lambda: winnow.feature_impacts(kind, first, second),
        lambda: winnow.feature_impacts(kind, np.zeros((1, 4, 3)), first, max_intervals=number),
        lambda: mesh.move(first, second),
        lambda: mesh.move(start, first, distance=number),
        lambda: mesh.impacts_with_shape(shapes, ball, first),
        lambda: mesh.impacts_with_shape(shapes, number, third),
        lambda: winnow.DeformableMesh(origin=first),
        lambda: mesh.self_proximity(kind, number),
        lambda: mesh.build(first, second),
        lambda: mesh.build(rest, third),
        lambda: mesh.move(first, first),
        lambda: mesh.self_candidates(kind),
    ])


def test_threads_may_query_and_move_at_once():
    meshes = []
    for seed in (8, 9):
        rest, triangles, start, end = crumpled(seed, 5)
        mesh = winnow.DeformableMesh()
        mesh.build(rest, triangles)
        mesh.move(start, end, distance=0.1)
        meshes.append((mesh, start, end))
    (one, start, end), (two, _, _) = meshes

    def query(i):
        one.candidates_with(two, KINDS[i % 2])
        two.impacts_with(one, KINDS[i % 2])
        one.impacts_with(one, KINDS[i % 2])
        one.self_proximity(KINDS[i % 2], 0.1)

    def change(i):
        for mesh in (one, two):
            mesh.move(start + i, end + i, distance=0.1)

    at_once(query, change, query, change)
