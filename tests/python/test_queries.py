"""Rays, swept volumes, regions and nearest objects, in batches."""

import numpy as np
import pytest
import winnow
from worlds import overlapping, pair_set, random_boxes, ray_entry


@pytest.fixture
def world():
    lower, upper = random_boxes(21, 300)
    partition = winnow.Partition()
    keys = partition.insert(lower, upper, data=1000 + np.arange(300))
    return partition, lower, upper, keys


def random_rays(seed, count):
    random = np.random.default_rng(seed)
    origins = random.uniform(-2, 9, (count, 3)).astype(np.float32)
    directions = random.normal(size=(count, 3)).astype(np.float32)
    return origins, directions


def entries(lower, upper, origins, directions):
    """Returns the entry of each ray into each box, as an array (rays, boxes)."""
    return np.array(
        [
            [ray_entry(low, high, o.astype(float), d.astype(float)) for low, high in zip(lower, upper)]
            for o, d in zip(origins, directions)
        ]
    )


def test_ray_hits_the_nearer_of_two_boxes():
    partition = winnow.Partition()
    keys = partition.insert([[2, 0, 0], [5, 0, 0]], [[3, 1, 1], [6, 1, 1]], data=[7, 8])
    hits = partition.cast_rays([[0, 0.5, 0.5]], [[1, 0, 0]])
    assert hits.key[0] == keys[0] and hits.data[0] == 7 and hits.t[0] == 2
    every = partition.cast_rays([[0, 0.5, 0.5], [0, 9, 9]], [[1, 0, 0], [1, 0, 0]], "all")
    assert every.first.tolist() == [0, 2, 2] and every.t.tolist() == [2, 5]
    late = partition.cast_rays([[0, 0.5, 0.5]], [[1, 0, 0]], min_t=4)
    assert late.key[0] == keys[1]
    none = partition.cast_rays([[0, 0.5, 0.5]], [[1, 0, 0]], max_t=[1.0])
    assert none.key[0] == winnow.NULL_KEY and none.t[0] == np.inf


def test_rays_agree_with_a_reference(world):
    partition, lower, upper, keys = world
    origins, directions = random_rays(22, 600)  # more than one task processes
    truth = entries(lower, upper, origins, directions)
    closest = partition.cast_rays(origins, directions)
    assert np.allclose(closest.t, truth.min(axis=1), rtol=1e-6)
    hit = np.isfinite(closest.t)
    assert np.array_equal(closest.data[hit], 1000 + winnow.ids_of(closest.key)[hit])
    anyone = partition.cast_rays(origins, directions, "any")
    assert np.array_equal(anyone.key != winnow.NULL_KEY, np.isfinite(truth).any(axis=1))
    every = partition.cast_rays(origins, directions, find="all")
    assert every.first[-1] == np.isfinite(truth).sum()
    for i in (0, 17, 599):
        mine = slice(int(every.first[i]), int(every.first[i + 1]))
        assert set(winnow.ids_of(every.key)[mine]) == set(np.nonzero(np.isfinite(truth[i]))[0])
        assert (np.diff(every.t[mine]) >= 0).all()


def test_rays_of_any_layout_give_equal_results(world):
    partition, _, _, _ = world
    origins, directions = random_rays(23, 50)
    records = np.hstack([origins, directions])
    answer = partition.cast_rays(origins, directions).t
    for o, d in [
        (records[:, :3], records[:, 3:]),
        (origins.astype(float), directions),
        (np.asfortranarray(origins), np.asfortranarray(directions)),
    ]:
        assert np.array_equal(partition.cast_rays(o, d).t, answer)
    assert np.array_equal(partition.cast_rays(origins[::-1], directions[::-1]).t[::-1], answer)
    assert np.array_equal(partition.cast_rays(origins, directions, max_t=1e30).t, answer)


def test_swept_volumes_of_zero_size_equal_rays(world):
    partition, _, _, _ = world
    origins, directions = random_rays(24, 300)
    for find in ("closest", "all"):
        rays = partition.cast_rays(origins, directions, find)
        for casts in (
            partition.cast_boxes(origins, origins, directions, find),
            partition.cast_spheres(origins, 0.0, directions, find),
            partition.cast_capsules(origins, origins, np.zeros(300), directions, find),
        ):
            assert np.allclose(casts.t, rays.t, rtol=1e-5)
            assert np.array_equal(casts.key, rays.key)
    larger = partition.cast_spheres(origins, 0.5, directions)
    assert (larger.t <= partition.cast_rays(origins, directions).t).all()


def test_box_overlaps_agree_with_a_reference(world):
    partition, lower, upper, _ = world
    low, high = random_boxes(25, 80)
    truth = set(zip(*(x.tolist() for x in np.nonzero(overlapping(low, high, lower, upper)))))
    assert pair_set(partition.overlap_boxes(low, high)) == truth
    assert pair_set(partition.overlap_boxes(low.astype(float), high, order="canonical")) == truth


def lists(overlaps):
    first = overlaps.first.astype(int)
    return [set(overlaps.ids[a:b].tolist()) for a, b in zip(first[:-1], first[1:])]


def test_region_overlaps_agree_with_a_reference(world):
    partition, lower, upper, _ = world
    random = np.random.default_rng(26)
    centers = random.uniform(0, 7, (300, 3)).astype(np.float32)
    gap = np.maximum(np.maximum(lower[None] - centers[:, None], centers[:, None] - upper[None]), 0)
    distance = np.linalg.norm(gap.astype(float), axis=2)
    for radius in (0.0, 0.75):
        truth = [set(np.nonzero(row <= radius)[0].tolist()) for row in distance]
        assert lists(partition.overlap_spheres(centers, radius)) == truth
        assert lists(partition.overlap_capsules(centers, centers, radius)) == truth
    assert lists(partition.overlap_points(centers)) == lists(partition.overlap_spheres(centers, 0))
    half = np.float32(0.5)
    boxes = [set() for _ in centers]
    for box, id in partition.overlap_boxes(centers - half, centers + half):
        boxes[box].add(int(id))
    assert lists(partition.overlap_oriented_boxes(centers, [half] * 3, np.eye(3))) == boxes


def test_regions_that_touch_in_double_are_found():
    random = np.random.default_rng(27)
    count, radius = 4000, 0.0625
    centers = random.uniform(0, 1, (count, 3))
    # The largest x of each box is the least float that is not below the least x of its ball. Each
    # box and its ball have their own environment.
    side = (centers[:, 0] - radius).astype(np.float32)
    beyond = np.nextafter(side, np.float32(np.inf))
    side = np.where(side.astype(float) < centers[:, 0] - radius, beyond, side)
    upper = np.stack([side, *(centers[:, 1:] + 0.01).astype(np.float32).T], axis=1)
    lower = np.stack([side - 1, *(centers[:, 1:] - 0.01).astype(np.float32).T], axis=1)
    partition = winnow.Partition()
    keys = partition.insert(lower, upper)
    half = [radius] * 3
    found = [
        partition.overlap_spheres(centers, radius),
        partition.overlap_capsules(centers, centers, radius),
        partition.overlap_oriented_boxes(centers, half, np.eye(3)),
    ]
    ids = np.arange(count)
    for overlaps in found:
        assert all(i in ids for i, ids in zip(ids, lists(overlaps)))
    away = np.tile([0.0, 2.0, 0.0], (count, 1))
    for hits in (
        partition.cast_spheres(centers, radius, away, "all", max_t=0.0),
        partition.cast_capsules(centers, centers, radius, away, "all", max_t=0.0),
    ):
        first = hits.first.astype(int)
        assert all(key in hits.key[a:b] for key, a, b in zip(keys, first[:-1], first[1:]))


def test_inside_and_crossing_objects_are_separated():
    partition = winnow.Partition()
    partition.insert([[0, 0, 0], [3, 0, 0], [9, 9, 9]], [[1, 1, 1], [4, 1, 1], [10, 10, 10]])
    found = partition.overlap_spheres([[0.5, 0.5, 0.5]], [2.8])
    assert found.ids.tolist() == [0, 1]
    assert found.crossing.tolist() == [1] and found.first.tolist() == [0, 2]


def test_cameras_see_the_objects_in_front():
    partition = winnow.Partition()
    partition.insert([[-1, -1, -6], [-1, -1, 5], [40, 0, -9]], [[1, 1, -5], [1, 1, 6], [41, 1, -8]])
    frusta = winnow.perspective(np.zeros((2, 3)), [[0, 0, -1], [0, 0, 1]], [0, 1, 0], 1.0, 1.6, 0.1, 50)
    assert frusta.shape == (2, 30)
    assert lists(partition.overlap_frusta(frusta)) == [{0}, {1}]
    assert lists(partition.overlap_planes([[[0, 0, -1, 0]], [[1, 0, 0, -10]]])) == [{0, 2}, {2}]
    near, far = 0.1, 50.0
    clip = np.array(
        [
            [1, 0, 0, 0],
            [0, 1, 0, 0],
            [0, 0, -far / (far - near), -near * far / (far - near)],
            [0, 0, -1, 0],
        ]
    )
    assert lists(partition.overlap_frusta(winnow.frusta_of([clip]))) == [{0}]
    with pytest.raises(winnow.StatusError):
        winnow.perspective([[0, 0, 0]], [0, 0, 0], [0, 1, 0], 1.0, 1.6, 0.1, 50)


def test_nearest_agrees_with_a_reference(world):
    partition, lower, upper, keys = world
    points = np.random.default_rng(27).uniform(-1, 8, (400, 3)).astype(np.float32)
    gap = np.maximum(np.maximum(lower[None] - points[:, None], points[:, None] - upper[None]), 0)
    distance = np.sort(np.linalg.norm(gap.astype(float), axis=2), axis=1)
    hits = partition.nearest(points, 5)
    assert hits.t.shape == (400, 5)
    assert np.allclose(hits.t, distance[:, :5], rtol=1e-6)
    close = partition.nearest(points, 5, radius=0.5)
    within = hits.t <= 0.5
    assert np.array_equal(close.key, np.where(within, hits.key, winnow.NULL_KEY))
    assert np.isinf(close.t[~within]).all()
    boxes = partition.nearest(lower, 1, upper=upper)
    assert (boxes.t == 0).all()
    assert partition.nearest(points, 0).t.shape == (400, 0)


def test_filters_separate_queries_from_objects(world):
    partition, _, _, keys = world
    partition.set_filter(keys[:150], layers=2)
    origins, directions = random_rays(28, 200)
    hits = partition.cast_rays(origins, directions, filter=winnow.Filter(mask=1))
    ids = winnow.ids_of(hits.key)
    assert (ids[hits.key != winnow.NULL_KEY] >= 150).all() and (ids != winnow.NO_OBJECT).any()
    assert "layers" in repr(winnow.Filter())


def test_results_outlive_the_partition():
    partition = winnow.Partition()
    partition.insert([[0, 0, 0]], [[1, 1, 1]])
    rays = partition.cast_rays([[-1, 0, 0]], [[1, 0, 0]], "all")
    spheres = partition.overlap_spheres([[0, 0, 0]], 1)
    again = partition.cast_rays([[9, 9, 9]], [[1, 0, 0]], "all")
    t, ids = rays.t, spheres.ids
    del partition, rays, spheres, again
    assert t.tolist() == [1] and ids.tolist() == [0]
