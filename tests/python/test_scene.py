"""Bodies, contacts, and queries of exact shapes."""


import numpy as np
import pytest
import winnow
from test_hostile import refused
from test_narrow import CUBE, poses_at
from worlds import at_once


@pytest.fixture
def world():
    """Returns a floor and three balls: the first two touch the floor, the last two overlap each other."""
    shapes = winnow.Shapes()
    ball = int(shapes.add_spheres(0.5)[0])
    floor = int(shapes.add_half_spaces([0, 0, 1])[0])
    scene = winnow.Scene(shapes)
    ground = scene.add(floor, [[0, 0, 0]], "fixed", data=[100])
    balls = scene.add(
        ball, poses_at([0, 0, 0.4], [9, 0, 0.5], [9, 0.9, 1.0]), data=[1, 2, 3]
    )
    return shapes, scene, ground, balls, ball


def touching(contacts):
    return {frozenset(pair) for pair in zip(contacts.data_a.tolist(), contacts.data_b.tolist())}


def test_bodies_that_touch_are_contacts(world):
    _, scene, ground, balls, _ = world
    contacts = winnow.Contacts()
    scene.collide(contacts)
    assert len(contacts) == 2 and contacts.level == "manifold"
    assert touching(contacts) == {frozenset([100, 1]), frozenset([100, 2])}
    assert sorted(contacts.distance.tolist()) == pytest.approx([-0.1, 0.0])
    assert contacts.manifold_first.tolist() == [0, 1, 2]
    assert np.abs(contacts.normal[:, 2]) == pytest.approx(1)
    assert (contacts.part_a == winnow.WHOLE_SHAPE).all()
    assert contacts.point_first[-1] == len(contacts.contact_depth) == len(contacts.contact_feature)
    assert contacts.contact_depth.max() == pytest.approx(0.1)
    assert set(contacts.a) | set(contacts.b) == {ground[0], balls[0], balls[1]}
    assert sum(run[3] for run in contacts.runs) == 2


def test_contacts_begin_persist_and_end(world):
    _, scene, _, balls, _ = world
    contacts = winnow.Contacts()
    scene.collide(contacts, "boolean")
    assert contacts.event.tolist() == [0, 0]
    scene.move(balls[:1], [[0, 0, 5]])
    scene.collide(contacts, "boolean")
    assert contacts.event.tolist() == [1]
    assert set(contacts.ended[0]) >= {balls[0]} and set(contacts.ended_data[0]) == {100, 1}
    kept = contacts.event
    scene.collide(contacts, "distance")
    assert kept.tolist() == [1]
    assert contacts.point.shape == (1, 3)
    contacts.clear()
    assert len(contacts) == 0


def test_distance_of_two_meshes_takes_one_call():
    points, triangle = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]
    apart = winnow.mesh_distance(points, triangle, points, triangle, pose_b=[0.2, 0.2, 3])
    assert apart.distance.tolist() == pytest.approx([3.0])
    assert np.allclose(apart.normal, [[0, 0, 1]])
    turned = winnow.mesh_distance(points, triangle, points, triangle, [0, 0, -1, 1, 0, 0, 0])
    assert turned.distance.tolist() == pytest.approx([1.0])


def test_arrays_outlive_contacts_and_scene(world):
    _, scene, _, _, _ = world
    contacts = winnow.Contacts()
    scene.collide(contacts)
    distance = contacts.distance[::-1]
    del contacts, scene
    assert sorted(distance.tolist()) == pytest.approx([-0.1, 0.0])


def test_bodies_report_their_state(world):
    shapes, scene, ground, balls, ball = world
    columns = scene.bodies(balls)
    assert columns["shape"].tolist() == [ball] * 3 and columns["data"].tolist() == [1, 2, 3]
    assert np.allclose(columns["pose"][1], [9, 0, 0.5, 1, 0, 0, 0])
    assert columns["state"].tolist() == [winnow.DYNAMIC] * 3
    scene.set_body_state(balls[:1], "sleeping")
    scene.set_filter(balls[1:], layers=2, environment=[3, 4])
    assert scene.bodies(balls)["state"].tolist() == [winnow.SLEEPING] + [winnow.DYNAMIC] * 2
    assert scene.bodies(balls)["environment"].tolist() == [0, 3, 4]
    assert (scene.size("fixed"), scene.size("dynamic"), scene.size("sleeping")) == (1, 2, 1)
    assert np.array_equal(scene.keys_of(winnow.ids_of(balls)), balls)
    scene.remove(balls[1:])
    assert len(scene) == 2 and scene.contains(balls).tolist() == [True, False, False]
    assert len(scene.bodies([])["pose"]) == 0


def test_poses_of_any_layout_are_read(world):
    _, scene, _, balls, _ = world
    poses = np.random.default_rng(51).normal(size=(3, 7))
    for same in (
        poses,
        np.asfortranarray(poses),
        (poses[:, :3], poses[:, 3:]),
        poses[::-1][::-1],
    ):
        scene.move(balls, np.zeros((3, 3)))
        scene.move(balls, same)
        assert np.array_equal(scene.bodies(balls)["pose"], poses)
    scene.move(balls, (poses[:, :3], poses[:, 3:].astype(np.float32)))
    assert np.allclose(scene.bodies(balls)["pose"], poses, rtol=1e-6)
    scene.move(balls, poses.astype(np.float32))
    assert np.array_equal(scene.bodies(balls)["pose"], poses.astype(np.float32))


def test_rays_hit_exact_shapes(world):
    _, scene, ground, balls, _ = world
    hits = scene.cast_rays([[0, 0, 9.0], [9, 0.9, 9.0], [50, 0, 9]], [[0, 0, -1.0]] * 3)
    assert hits.key.tolist() == [balls[0], balls[2], ground[0]]
    assert hits.t.tolist() == pytest.approx([8.1, 7.5, 9]) and hits.data.tolist() == [1, 3, 100]
    assert np.allclose(hits.normal, [[0, 0, 1]] * 3)
    assert np.allclose(hits.point[:, 2], [0.9, 1.5, 0])
    every = scene.cast_rays([[0, 0, 9.0], [0, 0, 9]], [[0, 0, -1.0], [0, 0, 1]], "all")
    assert every.first.tolist() == [0, 2, 2] and every.t.tolist() == pytest.approx([8.1, 9])
    short = scene.cast_rays([[0, 0, 9.0]], [[0, 0, -1.0]], "any", max_t=1.0)
    assert short.key[0] == winnow.NULL_KEY and np.isinf(short.t[0])
    assert len(scene.cast_rays(np.empty((0, 3)), np.empty((0, 3)), "all").t) == 0


def test_rays_enter_and_leave_bodies(world):
    _, scene, ground, balls, _ = world
    down = [[9, 0, 5], [0, 0, 5]]
    found = scene.crossings(down, [0, 0, -1])
    assert found.first.tolist() == [0, 3, 6]
    assert found.key[:3].tolist() == [balls[1], ground[0], balls[1]]
    assert found.t[:3] == pytest.approx([4, 5, 5])
    assert found.exits[:3].tolist() == [False, False, True]
    assert found.normal[:3, 2] == pytest.approx([1, 1, -1])
    assert found.barycentric.shape == (6, 3) and not found.barycentric.any()
    assert scene.crossings(down, [0, 0, -1], min_t=4.5, max_t=5.05).first.tolist() == [0, 2, 3]
    # The same ball from its middle on, and without it.
    hits = scene.cast_rays(down, [0, 0, -1], min_t=4.5)
    assert hits.key[0] == balls[1] and hits.t[0] == 4.5
    without = winnow.Filter(ignored=int(balls[1]))
    assert without.ignored == balls[1] and winnow.Filter().ignored is None
    assert scene.cast_rays(down[0], [0, 0, -1], filter=without).key.tolist() == ground.tolist()


def test_crossings_of_meshes_have_barycentric_weights():
    shapes = winnow.Shapes()
    corners = np.array([[0, 0, 0], [2, 0, 0], [0, 2, 0]], np.float32)
    scene = winnow.Scene(shapes)
    scene.add(shapes.add_mesh(corners, [[0, 1, 2]]), [[0, 0, 1]], "fixed")
    found = scene.crossings([[0.5, 1, 5], [0.5, 1, -5]], [[0, 0, -1], [0, 0, 1]])
    assert found.exits.tolist() == [False, True]
    assert found.barycentric == pytest.approx(np.array([[0.25, 0.25, 0.5]] * 2))
    assert found.barycentric @ corners + [0, 0, 1] == pytest.approx(found.point)


def test_distances_of_a_shape_find_depths(world):
    _, scene, ground, balls, ball = world
    near = scene.distances(ball, poses_at([0, 0, 0.3], [0, 0, 3]), [0.0, 10.0])
    assert near.first[1] == 2
    assert near.key[:2].tolist() == [balls[0], ground[0]]
    assert near.distance[:2] == pytest.approx([-0.9, -0.2])
    refused("invalid_argument", scene.distances, ball, poses_at([0, 0, 0]), np.nan)


def test_sensors_and_queries_skip_layers(world):
    _, scene, ground, balls, ball = world
    scene.set_layer(balls, 300)
    scene.set_layers_collide([[300, 7]], False)
    sensors = winnow.Sensors(scene)
    sensors.add(ball, poses_at([0, 0, 0.4]), layer=7)
    assert sensors.sense().body.tolist() == ground.tolist()
    sensors.add(ball, poses_at([0, 0, 0.4]))
    assert balls[0] in sensors.sense().body
    refused("invalid_argument", sensors.add, ball, poses_at([0, 0, 0]), layer=4096)
    hits = scene.cast_rays([0, 0, 5], [0, 0, -1], filter=winnow.Filter(layer=7))
    assert hits.key.tolist() == ground.tolist()


def test_shapes_are_cast_overlapped_and_measured(world):
    shapes, scene, ground, balls, ball = world
    hits = scene.cast_shapes(ball, poses_at([0, 0, 5], [30, 0, 5]), [0, 0, -10])
    assert hits.t == pytest.approx([0.36, 0.45], abs=1e-5)
    assert hits.key.tolist() == [balls[0], ground[0]]
    lists = scene.cast_shapes(ball, poses_at([0, 0, 5]), [0, 0, -10], "all")
    assert lists.first.tolist() == [0, 2]
    none = scene.cast_shapes(ball, poses_at([0, 0, 5]), [0, 0, 1])
    assert none.key.tolist() == [winnow.NULL_KEY] and np.isinf(none.t).all()
    found = scene.overlap(ball, poses_at([9, 0.4, 1], [0, 50, 50]))
    assert set(found.data.tolist()) == {2, 3} and found.first.tolist() == [0, 2, 2]
    apart = scene.distance(balls[:2], balls[1:])
    assert apart.distance[1] == pytest.approx(np.hypot(0.9, 0.5) - 1)
    assert apart.first.tolist() == [0, 1, 2] and np.allclose(apart.point_a[1, 0], 9)
    far = scene.distance(balls[:2], balls[1:], limit=1.0)
    assert far.first.tolist() == [0, 0, 1] and far.key.tolist() == [balls[2]]
    first, least = scene.least_distance(balls[:2], balls[1:])
    assert first.tolist() == [balls[1]] and least.key.tolist() == [balls[2]]
    assert least.distance[0] == apart.distance[1]
    first, least = scene.least_distance(balls[:1], balls[1:], limit=1.0)
    assert len(first) == 0 and len(least.distance) == 0
    everyone = np.concatenate([ground, balls])
    pairs = scene.overlaps(everyone, everyone)
    assert pairs.shape[1] == 2 and sorted(map(tuple, pairs)) == sorted(
        tuple(pair[::-1]) for pair in pairs
    )
    assert len(scene.overlaps(everyone, everyone, most=1)) == min(1, len(pairs))
    assert scene.any_contact().shape == scene.any_contact(everyone).shape
    assert len(scene.any_contact(balls[:2], balls[1:])) == 0
    gap = apart.distance[1]
    near = scene.any_contact(balls[:2], balls[1:], contact_margin=gap + 0.01)
    assert near.tolist() == [[balls[1], balls[2]]]
    scene.set_ignored([[balls[1], balls[2]]])
    assert len(scene.any_contact(balls[:2], balls[1:], contact_margin=gap + 0.01)) == 0
    assert len(scene.any_contact(balls[:2], balls[1:], contact_margin=gap + 0.01, rules="none")) == 1
    assert len(scene.distance(balls[1:2], balls[2:]).key) == 0
    assert len(scene.distance(balls[1:2], balls[2:], rules="none").key) == 1
    with pytest.raises(winnow.StatusError):
        scene.any_contact(b=balls)
    near = scene.nearest([[0, 0, 2.0], [9, 0, 9]], 2)
    assert near.data.tolist()[:2] == [1, 100] and near.distance[0] == pytest.approx(1.1)
    with pytest.raises(winnow.StatusError, match="unsupported"):
        scene.cast_shapes(shapes.add_half_spaces([0, 0, 1]), poses_at([0, 0, 0]), [1, 0, 0])


def test_mesh_and_field_contacts_name_their_triangles():
    shapes = winnow.Shapes()
    field = shapes.add_height_field(np.zeros((5, 5), np.float32))
    mesh = shapes.add_mesh([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0]], [[0, 1, 2], [1, 3, 2]])
    box = shapes.add_boxes([0.5, 0.5, 0.5])
    contacts = winnow.Contacts()
    for ground in (field, mesh):
        scene = winnow.Scene(shapes, contact_margin=0.01)
        scene.add(ground, [[0, 0, 0]], "fixed")
        scene.add(box, [[2, 2, 0.495]])
        contacts.clear()
        scene.collide(contacts)
        assert len(contacts) == 1
        assert (contacts.part_a != winnow.WHOLE_SHAPE).any() or (
            contacts.part_b != winnow.WHOLE_SHAPE
        ).any()
        assert contacts.contact_depth.max() == pytest.approx(0.005, abs=1e-4)


def test_queries_read_every_change(world):
    shapes, scene, _, balls, ball = world
    down = ([[3, 3, 9.0]], [[0, 0, -1.0]])
    assert scene.cast_rays(*down).t[0] == pytest.approx(9)
    scene.move(balls[:1], [[3, 3, 3]])
    assert scene.cast_rays(*down).t[0] == pytest.approx(5.5)
    mesh = shapes.add_mesh(CUBE, [[1, 3, 5], [3, 7, 5]])
    scene.add(mesh, [[3, 3, 5]])
    assert scene.cast_rays(*down).t[0] == pytest.approx(3, abs=1e-5)
    shapes.refit_mesh(mesh, CUBE * [1, 1, 2])
    assert scene.cast_rays(*down).t[0] == pytest.approx(2, abs=1e-5)


def test_environments_have_no_contacts_with_each_other():
    shapes = winnow.Shapes()
    ball = shapes.add_spheres(0.5)
    scene = winnow.Scene(shapes)
    worlds = np.repeat(np.arange(100), 2)
    positions = np.zeros((200, 3))
    positions[1::2, 0] = np.where(np.arange(100) % 2, 0.5, 2.0)
    keys = scene.add(ball, positions, environment=worlds, data=worlds)
    contacts = winnow.Contacts()
    scene.collide(contacts, "distance")
    assert sorted(contacts.data_a.tolist()) == list(range(1, 100, 2))
    assert np.array_equal(contacts.data_a, contacts.data_b) and len(keys) == 200


def test_contacts_of_resting_bodies_are_cached():
    shapes = winnow.Shapes()
    scene = winnow.Scene(shapes, cache_tolerance=0.1)
    keys = scene.add(shapes.add_spheres([1.0, 1.0]), [[0, 0, 0], [1.5, 0, 0]])
    contacts = winnow.Contacts()
    scene.collide(contacts)
    scene.move(keys, [[0.01, 0, 0], [1.5, 0, 0]])
    scene.collide(contacts)
    assert contacts.cached_pairs == 1 and scene.statistics()["cached_pairs"] == 1
    assert abs(contacts.distance[0] + 0.51) <= contacts.error_bound[0] + 1e-9


def test_exceptions_name_their_status(world):
    shapes, scene, ground, balls, ball = world
    where = np.zeros((1, 3))
    refused("invalid_key", scene.add, 12345, where)
    refused("size_mismatch", scene.add, [ball, ball], where)
    refused("invalid_argument", scene.add, ball, where, "flying")
    refused("invalid_key", scene.set_shape, np.repeat(balls[:1], 2), ball)
    refused("invalid_argument", winnow.Scene, shapes, contact_margin=-1.0)
    refused("invalid_argument", winnow.Scene, shapes, cache_tolerance=np.nan)
    refused("invalid_argument", winnow.Scene, shapes, structures=["LinearBvh"])
    gone = scene.add(ball, where)
    scene.remove(gone)
    mixed = np.concatenate([balls, gone])
    for call in (
        lambda: scene.remove(mixed),
        lambda: scene.move(mixed, np.zeros((4, 3))),
        lambda: scene.set_body_state(mixed, "fixed"),
        lambda: scene.set_shape(mixed, ball),
        lambda: scene.set_filter(mixed, layers=8),
        lambda: scene.bodies(mixed),
        lambda: scene.distance(mixed, mixed),
    ):
        refused("invalid_key", call)
    assert len(scene) == 4 and scene.bodies(balls)["layers"].tolist() == [1, 1, 1]
    assert scene.footprint()["total"][1] > 0 and scene.origin == (0, 0, 0)
    scene.refresh()
    assert len(scene.debug_draw().boxes) >= 4


def test_threads_may_query_and_change_at_once(world):
    shapes, scene, _, balls, ball = world
    contacts = winnow.Contacts()

    def collide(i):
        scene.collide(contacts)
        len(contacts.distance)

    def change(i):
        extra = scene.add(ball, np.random.default_rng(i).uniform(0, 9, (20, 3)))
        scene.move(extra, np.full((20, 3), float(i)))
        shapes.remove(shapes.add_spheres([1.0, 2.0]))
        scene.remove(extra)

    def query(i):
        scene.cast_rays(np.zeros((9, 3)), np.ones((9, 3)), ("closest", "all")[i % 2])
        scene.overlap(ball, np.zeros((9, 3)))
        scene.nearest(np.zeros((9, 3)), 2)
        scene.distance(balls, balls[::-1])

    at_once(collide, collide, change, query, query)
    assert len(scene) == 4
