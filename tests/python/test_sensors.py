"""Sensors: volumes that report the bodies inside."""

import numpy as np
import pytest
import winnow
from hypothesis import given, settings
from hypothesis import strategies as st
from test_hostile import any_array, refused
from test_narrow import poses_at
from worlds import answered_or_refused


@pytest.fixture
def world():
    """Returns forty random bodies, some of which are fixed, and three shapes for sensors."""
    random = np.random.default_rng(81)
    shapes = winnow.Shapes()
    ids = np.concatenate([shapes.add_spheres([0.4, 0.8]), shapes.add_boxes([[0.5, 1.0, 0.3]])])
    scene = winnow.Scene(shapes)
    poses = poses_at(*random.uniform(-3, 3, (40, 3)))
    keys = scene.add(ids[np.arange(40) % 3], poses, np.arange(40) % 3, data=np.arange(40))
    return shapes, ids, scene, keys, random


def pairs_in(sensed):
    return set(zip(sensed.sensor_data.tolist(), sensed.body_data.tolist()))


def test_sensors_agree_with_overlap_queries(world):
    shapes, ids, scene, keys, random = world
    sensors = winnow.Sensors(scene)
    poses = poses_at(*random.uniform(-3, 3, (12, 3)))
    shape_of = ids[np.arange(12) % 3]
    made = sensors.add(shape_of, poses, data=np.arange(100, 112))
    assert len(sensors) == 12 and sensors.contains(made).all() and not sensors.contains(keys).any()
    before = set()
    for step in (0.0, 0.7, 0.7):
        scene.move(keys, scene.bodies(keys)["pose"] + [step, 0, 0, 0, 0, 0, 0])
        found = scene.overlap(shape_of, poses)
        sensor_data = np.repeat(np.arange(100, 112), np.diff(found.first.astype(int)))
        truth = set(zip(sensor_data.tolist(), found.data.tolist()))
        sensed = sensors.sense()
        assert pairs_in(sensed) == truth and len(sensed.body) == len(truth) > 5
        events = dict(zip(zip(sensed.sensor_data.tolist(), sensed.body_data.tolist()), sensed.event))
        assert {pair for pair, event in events.items() if event == 0} == truth - before
        assert set(map(tuple, sensed.left_data.tolist())) == before - truth
        assert np.array_equal(keys[sensed.body_data], sensed.body)
        assert np.array_equal(made[sensed.sensor_data - 100], sensed.sensor)
        before = truth


def test_sensor_filters_select_bodies(world):
    shapes, ids, scene, keys, _ = world
    big = int(shapes.add_spheres(50.0)[0])
    scene.set_filter(keys[:10], layers=4)
    sensors = winnow.Sensors(scene)
    made = sensors.add(
        big,
        poses_at([0, 0, 0], [0, 0, 0]),
        mask=[4, 0xFFFFFFFF],
        carrier=np.array([winnow.NULL_KEY, keys[3]], np.uint64),
    )
    sensed = sensors.sense()
    own = [set(sensed.body_data[sensed.sensor == key].tolist()) for key in made]
    assert own[0] == set(range(10)) and own[1] == set(range(40)) - {3}
    sensors.move(made[:1], poses_at([500, 0, 0]))
    sensors.set(made[1:], big, poses_at([0, 0, 0]), data=[7])
    sensed = sensors.sense()
    assert set(sensed.body_data.tolist()) == set(range(40)) and set(sensed.sensor_data) == {7}
    assert len(sensed.left) == 10
    sensors.remove(made[:1])
    assert len(sensors) == 1 and sensors.contains(made).tolist() == [False, True]


def test_shapes_of_sensors_cannot_be_removed(world):
    shapes, _, scene, _, _ = world
    own = shapes.add_spheres([1.0, 2.0])
    sensors = winnow.Sensors(scene)
    made = sensors.add(own[:1], poses_at([0, 0, 0]))
    refused("invalid_key", shapes.remove, own[:1])
    sensors.set(made, own[1], poses_at([0, 0, 0]))
    shapes.remove(own[:1])
    refused("invalid_key", shapes.remove, own[1:])
    sensors.remove(made)
    sensors.add(own[1], poses_at([0, 0, 0]))
    refused("invalid_key", shapes.remove, own[1:])
    del sensors
    shapes.remove(own[1:])


def test_sensors_keep_their_scene_alive(world):
    shapes, ids, scene, keys, _ = world
    sensors = winnow.Sensors(scene)
    sensors.add(shapes.add_spheres(50.0), poses_at([0, 0, 0]))
    sensed = sensors.sense()
    scene.clear()
    del scene, shapes
    assert len(sensors.sense().left) == 40
    bodies = sensed.body
    del sensors, sensed
    assert np.array_equal(np.sort(bodies), np.sort(keys))


def test_refused_calls_change_nothing(world):
    shapes, ids, scene, keys, _ = world
    sensors = winnow.Sensors(scene)
    made = sensors.add(ids[0], poses_at([0, 0, 0], [1, 0, 0]))
    bad = poses_at([0, 0, 0], [np.nan, 0, 0])
    refused("invalid_pose", sensors.add, ids[0], bad)
    refused("invalid_key", sensors.add, [ids[0], 999], poses_at([0, 0, 0], [0, 0, 0]))
    refused("size_mismatch", sensors.add, ids[0], bad, carrier=keys[:1])
    refused("size_mismatch", sensors.add, ids[:2], bad[:1])
    refused("invalid_pose", sensors.move, made, bad)
    refused("size_mismatch", sensors.move, made, bad[:1])
    refused("invalid_key", sensors.move, keys[:2], poses_at([0, 0, 0], [0, 0, 0]))
    refused("invalid_key", sensors.remove, np.repeat(made[:1], 2))
    refused("invalid_key", sensors.remove, np.append(made, keys[:1]))
    refused("invalid_pose", sensors.set, made, ids[1], bad)
    refused("invalid_key", sensors.set, np.repeat(made[:1], 2), ids[1], bad * 0 + 1)
    assert len(sensors) == 2 and sensors.contains(made).all()
    again = winnow.Sensors(scene)
    again.add(ids[0], poses_at([0, 0, 0], [1, 0, 0]))
    assert np.array_equal(sensors.sense().body, again.sense().body)


@given(any_array(), any_array(), any_array(), st.integers(0, 2**32 - 1))
@settings(max_examples=100)
def test_any_arrays_are_accepted_or_refused(first, second, third, number):
    shapes = winnow.Shapes()
    ids = shapes.add_spheres([1.0, 2.0])
    scene = winnow.Scene(shapes)
    scene.add(ids, np.zeros((2, 3)))
    sensors = winnow.Sensors(scene)
    made = sensors.add(ids, np.zeros((2, 3)))
    answered_or_refused([
        lambda: sensors.add(first, second, third),
        lambda: sensors.add(number, second, carrier=first),
        lambda: sensors.set(made, ids, (first, second)),
        lambda: sensors.set(first, second, third),
        lambda: sensors.move(made, first),
        lambda: sensors.move(first, second),
        lambda: sensors.contains(first),
        lambda: sensors.remove(first),
        lambda: sensors.sense(),
    ])
