"""Loaded snapshots continue exactly as the saved objects would have."""

import numpy as np
import pytest
import winnow
from test_hostile import refused
from test_narrow import poses_at

RANDOM = np.random.default_rng(4)


def shown(contacts):
    columns = [contacts.data_a, contacts.data_b, contacts.event, contacts.distance]
    columns += [contacts.contact_depth, contacts.normal]
    return [column.tolist() for column in columns]


def stage():
    shapes = winnow.Shapes()
    ids = np.concatenate([shapes.add_spheres([0.5, 0.3]), shapes.add_boxes([[0.4, 0.3, 0.5]])])
    rock = shapes.add_compound(ids[:2], poses_at([0, 0, 0], [0.4, 0, 0]))
    return shapes, np.append(ids, rock)


def moved(scene, contacts, keys, steps):
    frames = []
    for step in steps:
        poses = scene.bodies(keys)["pose"].copy()
        poses[:, :3] += step
        scene.move(keys, poses)
        scene.collide(contacts)
        frames.append(shown(contacts))
    return frames


def test_partitions_are_saved_and_loaded():
    lower = RANDOM.uniform(0, 5, (200, 3)).astype(np.float32)
    partition = winnow.Partition("LinearBvh")
    keys = partition.insert(lower, lower + 1)
    pairs = {tuple(pair) for pair in partition.self_pairs().tolist()}
    saved = partition.save()
    partition.remove(keys[:100])
    partition.load(np.frombuffer(saved, np.uint8))
    assert partition.contains(keys).all()
    assert {tuple(pair) for pair in partition.self_pairs().tolist()} == pairs
    refused("invalid_argument", partition.load, saved[:-1])
    refused("invalid_argument", partition.load, np.frombuffer(saved, np.uint8)[::2])
    assert len(partition) == 200


def test_loaded_scene_continues_identically():
    shapes, ids = stage()
    scene = winnow.Scene(shapes, contact_margin=0.05, cache_tolerance=0.01)
    places = RANDOM.uniform(0, 4, (60, 3))
    keys = scene.add(ids[np.arange(60) % len(ids)], places, data=np.arange(60))
    contacts = winnow.Contacts()
    scene.collide(contacts)
    saved = shapes.save(), scene.save(), scene.save_contacts(contacts)
    steps = [RANDOM.normal(0, size, (60, 3)) for size in (0.002, 0.1, 0.3)]
    future = moved(scene, contacts, keys, steps)

    scene.load(saved[1])
    scene.load_contacts(saved[2], contacts)
    assert moved(scene, contacts, keys, steps) == future
    refused("invalid_key", shapes.load, saved[0])

    others = winnow.Shapes()
    refused("invalid_argument", winnow.Scene(others).load, saved[1])
    others.load(bytearray(saved[0]))
    assert others.save() == saved[0]
    again = winnow.Scene(others, parallel=False)
    again.load(memoryview(saved[1]))
    held = winnow.Contacts()
    again.load_contacts(saved[2], held)
    assert moved(again, held, again.keys_of(np.arange(60)), steps) == future
    # Loaded bodies keep their shapes in use.
    refused("invalid_key", others.remove, ids[:1])
    again.clear()
    others.load(saved[0])
    with pytest.raises(TypeError):
        others.load("text")


def test_large_results_reuse_unreferenced_memory():
    points = RANDOM.uniform(0, 9, (20_000, 3)).astype(np.float32)
    partition = winnow.Partition("LinearBvh")
    partition.insert(points, points)
    first = partition.nearest(points, 2)
    second = partition.nearest(points, 2)
    assert not np.shares_memory(first.key, second.key)
    assert (first.key == second.key).all() and second.key.flags.writeable
    place = second.key.ctypes.data
    kept = first.key.copy()
    del second
    third = partition.nearest(points[::-1], 2)
    assert place in {column.ctypes.data for column in (third.key, third.data)}
    assert (first.key == kept).all()
