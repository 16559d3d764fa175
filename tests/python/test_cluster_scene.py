"""Clusters of scenes: the contacts of one scene, on virtual ranks and on threads that communicate like MPI
processes."""

import gc

import numpy as np
import pytest
import winnow
from test_cluster import Threads, run_on_threads
from test_hostile import refused

COUNT = 150


def shapes_of_all():
    shapes = winnow.Shapes()
    return shapes, shapes.add_spheres([0.3, 0.5]), shapes.add_boxes([20, 20, 0.5])


def bodies_of_all():
    random = np.random.default_rng(71)
    names = random.permutation(5 * COUNT)[:COUNT].astype(np.uint64) + 10
    return names, random.integers(0, 2, COUNT), random.uniform(0, 6, (COUNT, 3))


def of_one_scene(steps=1, step=0.0):
    """Returns the pairs of one scene, by names, in each step."""
    shapes, balls, ground = shapes_of_all()
    names, kind, places = bodies_of_all()
    scene = winnow.Scene(shapes)
    scene.add(ground, [[0, 0, -0.5]], "fixed", data=[0])
    keys = scene.add(balls[kind], places, data=names)
    found = []
    for _ in range(steps):
        contacts = winnow.Contacts()
        scene.collide(contacts)
        found.append(pairs_of(contacts))
        places = places + [step, 0, 0]
        scene.move(keys, places)
    return found


def pairs_of(contacts):
    return {frozenset(pair) for pair in zip(contacts.data_a.tolist(), contacts.data_b.tolist())}


def together(cluster):
    found = []
    for rank in range(*cluster.hosted):
        found += list(pairs_of(cluster.contacts(rank)))
    assert len(found) == len(set(found))
    return set(found)


@pytest.mark.parametrize("ranks", [1, 2, 5])
def test_virtual_ranks_find_the_contacts_of_one_scene(ranks):
    shapes, balls, ground = shapes_of_all()
    names, kind, places = bodies_of_all()
    cluster = winnow.ClusterScene(shapes, ranks=ranks)
    assert cluster.ranks == ranks and cluster.hosted == (0, ranks)
    cluster.replicate([0], ground, [[0, 0, -0.5]])
    cluster.add(names, balls[kind], places, rank=ranks - 1)
    for expected in of_one_scene(3, 0.7):
        cluster.collide()
        assert together(cluster) == expected
        came = sum(len(cluster.migrated(rank)[0]) for rank in range(ranks))
        went = sum(len(cluster.migrated(rank)[1]) for rank in range(ranks))
        assert came >= went
        seen = 0
        for rank in range(ranks):
            own = cluster.bodies(rank)
            seen += len(own["name"])
            moved = own["pose"][:, :3] + [0.7, 0, 0]
            cluster.move(own["name"], moved, rank=rank)
        assert seen == COUNT == cluster.statistics["bodies"]
    gone = cluster.bodies(0)["name"][:3]
    cluster.remove(gone, rank=0)
    cluster.collide("boolean")
    assert not any(set(gone.tolist()) & pair for pair in together(cluster))


def test_digest_does_not_depend_on_the_rank_count():
    digests = set()
    for ranks in (1, 3):
        shapes, balls, ground = shapes_of_all()
        names, kind, places = bodies_of_all()
        cluster = winnow.ClusterScene(shapes, ranks=ranks)
        cluster.replicate([0], ground, [[0, 0, -0.5]])
        cluster.add(names, balls[kind], places)
        cluster.collide()
        digests.add(cluster.digest())
        assert len(cluster.digest()) == 32
    assert len(digests) == 1


def test_threads_as_ranks_find_the_same_contacts():
    expected = of_one_scene()[0]

    def work(comm):
        shapes, balls, ground = shapes_of_all()
        names, kind, places = bodies_of_all()
        own = slice(comm.rank, None, comm.size)
        cluster = winnow.ClusterScene(shapes, comm)
        cluster.replicate([0], ground, [[0, 0, -0.5]])
        cluster.add(names[own], balls[kind[own]], places[own])
        cluster.collide()
        return pairs_of(cluster.contacts()), cluster.digest()

    results = run_on_threads(Threads(3), work)
    for result in results:
        assert not isinstance(result, Exception), result
    assert set().union(*(result[0] for result in results)) == expected
    assert sum(len(result[0]) for result in results) == len(expected)
    assert len({result[1] for result in results}) == 1


def test_saved_cluster_continues_on_other_ranks():
    def made(ranks):
        shapes, balls, ground = shapes_of_all()
        cluster = winnow.ClusterScene(shapes, ranks=ranks)
        cluster.replicate([0], ground, [[0, 0, -0.5]])
        return cluster, balls

    cluster, balls = made(3)
    names, kind, places = bodies_of_all()
    cluster.add(names, balls[kind], places)
    cluster.collide()
    saved = [cluster.save(rank) for rank in range(3)]
    other, _ = made(2)
    other.restore([saved[0], saved[1]])
    other.restore([saved[2], b""])
    other.collide()
    assert together(other) == together(cluster)
    assert all((other.contacts(rank).event == 1).all() for rank in range(2))
    refused("invalid_argument", other.restore, [b"nonsense", b""])
    refused("size_mismatch", other.restore, [b""] * 3)


def test_invalid_calls_are_refused():
    shapes, balls, ground = shapes_of_all()
    cluster = winnow.ClusterScene(shapes, ranks=2)
    places = np.arange(9.0).reshape(3, 3)
    cluster.add([1, 2, 3], balls[0], places)
    refused("invalid_key", cluster.add, [3, 4, 5], balls[0], places, rank=1)
    refused("invalid_key", cluster.add, [7], 12345, places[:1])
    refused("size_mismatch", cluster.add, [7], balls[0], places)
    refused("unsupported", cluster.add, [7], balls[0], places[:1], "sleeping")
    refused("invalid_argument", cluster.add, [7], balls[0], places[:1], rank=2)
    refused("invalid_pose", cluster.add, [7], balls[0], places[:1] * np.nan)
    refused("invalid_key", cluster.move, [9], places[:1])
    refused("invalid_key", cluster.remove, [9])
    refused("invalid_key", cluster.move_replicated, [1], places[:1])
    refused("invalid_argument", cluster.collide, "sorted")
    refused("invalid_argument", winnow.ClusterScene, shapes, contact_margin=-1.0)
    refused("invalid_argument", winnow.ClusterScene, shapes, imbalance=0.5)
    refused("invalid_key", shapes.remove, ground)
    with pytest.raises(TypeError):
        winnow.ClusterScene(None)
    with pytest.raises(TypeError):
        winnow.ClusterScene.__new__(winnow.ClusterScene).collide()
    with pytest.raises(AttributeError):
        winnow.ClusterScene(shapes, 7)
    del cluster
    gc.collect()
    shapes.remove(ground)


def test_contact_arrays_are_constant_and_outlive_the_cluster():
    shapes, balls, ground = shapes_of_all()
    names, kind, places = bodies_of_all()
    cluster = winnow.ClusterScene(shapes)
    cluster.add(names, balls[kind], places)
    cluster.collide()
    contacts = cluster.contacts()
    refused("unsupported", contacts.clear)
    refused("unsupported", winnow.Scene(shapes).collide, contacts)
    depth = contacts.contact_depth
    before = depth.copy()
    cluster.collide()
    del contacts, cluster
    assert len(depth) and np.array_equal(depth, before)


def test_exception_of_a_support_function_is_raised():
    shapes = winnow.Shapes()
    fails = [False]

    def function(direction):
        if fails[0]:
            raise KeyError("later")
        return 0.5 * direction

    own = shapes.add_support(function, 0.5)
    cluster = winnow.ClusterScene(shapes, ranks=2)
    cluster.add([1, 2], own, [[0, 0, 0], [0.8, 0, 0]])
    fails[0] = True
    with pytest.raises(KeyError):
        cluster.collide()
    fails[0] = False
    cluster.collide()
    assert together(cluster) == {frozenset([1, 2])}
