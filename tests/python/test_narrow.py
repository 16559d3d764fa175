"""Shapes, and the narrow phase on pairs of convex shapes."""

import numpy as np
import pytest
import winnow
from hypothesis import given, settings
from hypothesis import strategies as st
from test_hostile import any_array, refused
from worlds import answered_or_refused

CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)


def poses_at(*positions):
    poses = np.zeros((len(positions), 7))
    poses[:, :3], poses[:, 3] = positions, 1
    return poses


def test_two_balls_touch_as_computed_by_hand():
    shapes = winnow.Shapes()
    ids = shapes.add_spheres([1.0, 0.5])
    narrow = winnow.NarrowPhase()
    result = narrow.collide(shapes, ids, poses_at([0, 0, 0], [1.25, 0, 0]), [[0, 1]])
    assert len(result) == 1 and result.overlaps.tolist() == [True]
    assert result.distance[0] == pytest.approx(-0.25)
    assert np.allclose(result.normal, [[1, 0, 0]])
    assert result.contact_count.tolist() == [1] and result.contact_depth[0] == pytest.approx(0.25)
    assert np.allclose(result.contact_position, [[0.875, 0, 0]])


def test_every_kind_of_shape_has_its_bounds():
    shapes = winnow.Shapes()
    ids = [
        *shapes.add_spheres(1.0),
        *shapes.add_capsules(1.0, 0.0),
        *shapes.add_boxes([1.0, 1.0, 1.0]),
        *shapes.add_cylinders(1.0, 1.0),
        *shapes.add_cones([1.0], 1.0),
        *shapes.add_ellipsoids([1.0, 1.0, 1.0]),
        *shapes.add_tapered_capsules([1.0, 0.5], 0.0),
        *shapes.add_triangles([[[-1, -1, -1], [1, 1, 1], [1, -1, 0]]]),
        shapes.add_hull(CUBE),
        shapes.add_mesh(CUBE, [[0, 1, 2], [5, 6, 7]]),
        shapes.add_compound(shapes.add_boxes([0.5, 1, 1]), poses_at([0.5, 0, 0])),
    ]
    assert shapes.contains(ids).all()
    lower, upper = shapes.bounds(ids, np.zeros((len(ids), 3)))
    assert np.allclose(upper, 1, atol=1e-5)
    assert np.allclose(lower[:-1], -1, atol=1e-5) and np.allclose(lower[-1], [0, -1, -1], atol=1e-5)
    assert shapes.footprint()["convex"][1] > 0


def test_levels_on_balls_agree_with_a_reference():
    random = np.random.default_rng(41)
    radius = random.uniform(0.1, 1.0, 300)
    poses = random.uniform(0, 5, (300, 3))
    shapes = winnow.Shapes()
    ids = shapes.add_spheres(radius)
    pairs = np.stack(np.triu_indices(300, 1), axis=1).astype(np.uint32)
    gap = np.linalg.norm(poses[pairs[:, 0]] - poses[pairs[:, 1]], axis=1)
    gap -= radius[pairs].sum(axis=1)
    narrow = winnow.NarrowPhase()
    for tier in ("robust", "reference"):
        result = narrow.collide(shapes, ids, poses, pairs, level="distance", tier=tier)
        assert np.allclose(result.distance, gap[result.pair], atol=1e-5)
        assert (np.abs(result.distance - gap[result.pair]) <= result.error_bound + 1e-12).all()
    boolean = narrow.collide(shapes, ids, poses, pairs, level="boolean")
    assert np.array_equal(boolean.overlaps, gap[boolean.pair] <= 0)
    assert narrow.statistics()["pairs"] == len(pairs)
    assert narrow.collide(shapes, ids, poses, pairs, contact_margin=0.1).level == "manifold"


def test_poses_of_any_layout_give_equal_results():
    random = np.random.default_rng(42)
    poses = random.normal(size=(60, 7))
    shapes = winnow.Shapes()
    box = int(shapes.add_boxes([0.5, 0.25, 0.75])[0])
    pairs = np.stack(np.triu_indices(60, 1), axis=1).astype(np.uint32)
    narrow = winnow.NarrowPhase(parallel=False)
    answer = narrow.collide(shapes, box, poses, pairs, level="distance").distance
    wide = np.zeros((60, 9))
    wide[:, 1:8] = poses
    for same in (
        np.asfortranarray(poses),
        wide[:, 1:8],
        (poses[:, :3], poses[:, 3:]),
        (poses[:, :3], np.ascontiguousarray(poses[:, 3:])),
    ):
        assert np.array_equal(
            narrow.collide(shapes, [box] * 60, same, pairs, level="distance").distance, answer
        )


def test_results_do_not_change_later():
    shapes = winnow.Shapes()
    ids = shapes.add_spheres([1.0, 1.0])
    narrow = winnow.NarrowPhase()
    poses = poses_at([0, 0, 0], [1, 0, 0])
    first = narrow.collide(shapes, ids, poses, [[0, 1]]).distance
    poses[1, 0] = 1.5
    second = narrow.collide(shapes, ids, poses, [[0, 1]]).distance
    del narrow, shapes
    assert first.tolist() == [-1.0] and second.tolist() == [-0.5]
    with pytest.raises(ValueError):
        first[0] = 3


def test_rays_hit_shapes_at_known_distances():
    shapes = winnow.Shapes()
    ids = [*shapes.add_spheres(1.0), *shapes.add_boxes([1.0, 1, 1]), shapes.add_hull(CUBE)]
    hits = shapes.cast_rays(ids, np.zeros((3, 3)), [-5, 0, 0], [2, 0, 0])
    assert hits.hit.all() and np.allclose(hits.t, 2) and np.allclose(hits.normal, [-1, 0, 0])
    missed = shapes.cast_rays(ids, np.zeros((3, 3)), [-5, 0, 0], [2, 0, 0], max_t=1.0)
    assert not missed.hit.any() and np.isinf(missed.t).all()


def test_shapes_in_use_cannot_be_removed():
    shapes = winnow.Shapes()
    child = shapes.add_boxes([0.5, 0.5, 0.5])
    compound = shapes.add_compound(child, [[0, 0, 0]])
    refused("invalid_key", shapes.remove, child)
    scene = winnow.Scene(shapes)
    keys = scene.add(compound, [[0, 0, 0]])
    refused("invalid_key", shapes.remove, [compound])
    other = shapes.add_spheres(1.0)
    scene.set_shape(keys, other)
    shapes.remove([compound])
    shapes.remove(child)
    refused("invalid_key", shapes.remove, other)
    refused("invalid_key", shapes.remove, child)
    scene.clear()
    shapes.remove(other)
    mesh = shapes.add_mesh(CUBE, [[0, 1, 2]])
    scaled = shapes.add_scaled(mesh, [1, 2, -3])
    scene.add([mesh], [[0, 0, 0]])
    shapes.remove([scaled])
    refused("invalid_key", shapes.remove, [mesh])
    del scene
    shapes.remove([mesh])


def test_exceptions_name_their_status():
    shapes = winnow.Shapes()
    ids = shapes.add_spheres([1.0, 2.0])
    narrow = winnow.NarrowPhase()
    where = np.zeros((2, 3))
    refused("invalid_shape", shapes.add_spheres, [1.0, -1.0])
    assert shapes.contains([2, 3]).tolist() == [False, False]
    refused("invalid_shape", shapes.add_half_spaces, [0, 0, 0])
    refused("invalid_shape", shapes.add_hull, np.empty((0, 3)))
    refused("invalid_shape", shapes.add_mesh, CUBE, [[0, 1, 99]])
    refused("invalid_shape", shapes.add_height_field, np.zeros((1, 1)))
    refused("size_mismatch", shapes.add_height_field, np.zeros(4))
    refused("invalid_key", shapes.add_compound, [2**31], [[0, 0, 0]])
    refused("invalid_key", shapes.add_scaled, int(ids[0]), [1, 1, 1])
    refused("invalid_key", shapes.refit_mesh, 7, CUBE)
    refused("invalid_argument", narrow.collide, shapes, ids, where, [[0, 2]])
    refused("invalid_argument", narrow.collide, shapes, ids, where, [[0, 1]], contact_margin=-1.0)
    refused("invalid_argument", narrow.collide, shapes, ids, where, [[0, 1]], level="pairs")
    refused("invalid_argument", narrow.collide, shapes, ids, where, [[0, 1]], tier="best")
    refused("invalid_pose", narrow.collide, shapes, ids, where + np.nan, [[0, 1]])
    refused("invalid_key", narrow.collide, shapes, [0, 99], where, [[0, 1]])
    refused("size_mismatch", narrow.collide, shapes, ids, where[:1], [[0, 0]])
    mesh = shapes.add_mesh(CUBE, [[0, 1, 2]])
    refused("invalid_key", narrow.collide, shapes, [0, mesh], where, [[0, 1]])
    refused("invalid_key", shapes.cast_rays, [mesh], where[:1], [0, 0, 0], [1, 0, 0])


def test_height_fields_and_meshes_change_in_place():
    shapes = winnow.Shapes()
    field = shapes.add_height_field(np.zeros((3, 4), np.float32), [2.0, 1.0])
    shapes.update_height_field(field, 1, 1, np.full((1, 2), 5.0))
    lower, upper = shapes.bounds([field], [[0, 0, 0]])
    assert np.allclose(upper, [[6, 2, 5]], atol=1e-4)
    mesh = shapes.add_mesh(CUBE.astype(np.float32), np.array([[0, 1, 2]], np.uint16))
    shapes.refit_mesh(mesh, CUBE * 3)
    assert shapes.bounds([mesh], [[0, 0, 0]])[1].max() >= 3
    refused("size_mismatch", shapes.refit_mesh, mesh, CUBE[:3])


def test_compounds_may_contain_meshes():
    shapes = winnow.Shapes()
    ball = int(shapes.add_spheres([0.5])[0])
    mesh = shapes.add_mesh(CUBE, [[0, 1, 2], [5, 6, 7]])
    compound = shapes.add_compound([ball, mesh, ball], poses_at([0, 0, 0], [9, 0, 0], [20, 0, 0]))
    child, part = shapes.compound_parts(compound, [0, 1, 2, 3])
    assert child.tolist() == [0, 1, 1, 2]
    assert part.tolist() == [winnow.WHOLE_SHAPE, 0, 1, winnow.WHOLE_SHAPE]
    refused("invalid_key", shapes.compound_parts, compound, [4])
    refused("invalid_key", shapes.compound_parts, mesh, [0])
    refused("invalid_key", shapes.add_compound, [compound], [[0, 0, 0]])
    refused("invalid_key", shapes.remove, [mesh])
    scene = winnow.Scene(shapes)
    scene.add([compound, ball], [[0, 0, 0], CUBE[0] + [9, 0, 0]])
    contacts = winnow.Contacts()
    scene.collide(contacts, "distance")
    assert len(contacts) == 1
    shapes.refit_mesh(mesh, CUBE + [50, 0, 0])
    assert shapes.bounds([compound], [[0, 0, 0]])[1][0, 0] >= 60


@given(any_array(), any_array(), any_array(), st.integers(0, 2**32 - 1))
@settings(max_examples=200)
def test_any_arrays_are_accepted_or_refused(first, second, third, number):
    shapes = winnow.Shapes()
    ids = shapes.add_spheres([1.0, 2.0])
    scene = winnow.Scene(shapes)
    keys = scene.add(ids, np.zeros((2, 3)))
    narrow = winnow.NarrowPhase()
    contacts = winnow.Contacts()
    answered_or_refused([
        lambda: shapes.add_spheres(first),
        lambda: shapes.add_boxes(first, second),
        lambda: shapes.add_cones(first, second, third),
        lambda: shapes.add_triangles(first),
        lambda: shapes.add_half_spaces(first, second),
        lambda: shapes.add_hull(first),
        lambda: shapes.add_hull(CUBE, 0.0, first, second),
        lambda: shapes.add_mesh(first, second),
        lambda: shapes.add_mesh(CUBE, second),
        lambda: shapes.add_height_field(first),
        lambda: shapes.add_compound(ids[:1], first),
        lambda: shapes.add_compound(first, second),
        lambda: shapes.compound_parts(number, first),
        lambda: shapes.update_height_field(number, 0, 0, first),
        lambda: shapes.refit_mesh(number, first),
        lambda: shapes.add_scaled(number, [1, 2, 3]),
        lambda: shapes.bounds(first, second),
        lambda: shapes.cast_rays(ids[0], first, second, third),
        lambda: narrow.collide(shapes, first, second, third),
        lambda: narrow.collide(shapes, ids[0], first, third),
        lambda: narrow.collide(shapes, number, first, third),
        lambda: scene.add(ids[0], first, third),
        lambda: scene.add(first, second, data=third),
        lambda: scene.add(number, first),
        lambda: scene.move(keys, first),
        lambda: scene.move(keys[:1], (first, second)),
        lambda: scene.move(first, second),
        lambda: scene.set_shape(keys, first),
        lambda: scene.set_shape(keys, number),
        lambda: scene.set_filter(keys, first, second, third),
        lambda: scene.bodies(first),
        lambda: scene.collide(contacts),
        lambda: scene.cast_rays(first, second, ("closest", "all")[number % 2], max_t=third),
        lambda: scene.cast_shapes(ids[0], first, second, ("closest", "all")[number % 2]),
        lambda: scene.cast_shapes(first, second, third),
        lambda: scene.overlap(ids[0], first),
        lambda: scene.overlap(number, first),
        lambda: scene.nearest(first, 3, radius=second),
        lambda: scene.distance(first, second),
        lambda: scene.remove(first),
        lambda: shapes.remove(first),
        lambda: scene.collide(contacts, "distance"),
    ])
