"""Programs are recorded, and replayed with equal results."""

import os
import pathlib

import numpy as np
import pytest
import winnow
from hypothesis import given, settings
from hypothesis import strategies as st
from test_hostile import any_array, refused
from test_narrow import CUBE, poses_at
from worlds import REFUSALS, at_once, pair_set, random_boxes, reference_pairs


@pytest.fixture
def file(tmp_path):
    return str(tmp_path / "run.winnow")


def read(file):
    with open(file, "rb") as recording:
        return recording.read()


def played(file):
    counts = winnow.replay(read(file))
    assert counts == winnow.replay(bytearray(read(file)), parallel=False)
    assert counts["differences"] == 0 and counts["is_whole"]
    return counts


def test_partitions_are_recorded_and_replayed(file):
    lower, upper = random_boxes(101, 300)
    recorder = winnow.Recorder(file)
    partition = winnow.Partition("HierarchicalGrid", recorder=recorder)
    other = winnow.Partition(recorder=recorder)
    other.insert(lower[:50], upper[:50])
    keys = partition.insert(lower, upper, np.arange(300))
    events = winnow.PairEvents()
    for step in range(4):
        moved = np.float32(0.1 * step)
        partition.update(keys, lower + moved, upper + moved)
        partition.set_filter(keys[:5], layers=step + 1)
        partition.self_pairs()
        partition.self_pairs(events)
        partition.pair_changes(events)
        partition.pairs_with(other)
        for find in ("closest", "any", "all"):
            partition.cast_rays(lower, upper - lower + 1, find)
            partition.cast_spheres(lower[:9], 0.5, upper[:9], find)
        partition.overlap_boxes(lower[:20], upper[:20])
        partition.overlap_spheres(lower[:20], 0.5)
        partition.nearest(lower[:20], 3)
        recorder.end_frame()
    partition.remove(keys[250:])
    partition.set_structure("LinearBvh")
    assert len(partition) == 250 and partition.structure == "LinearBvh"
    assert partition.contains(keys).sum() == 250
    assert len(partition.save()) > 0
    partition.reserve(1000, pairs=100)
    found = partition.self_pairs()
    plain = winnow.Partition()
    plain.insert(lower, upper)
    assert pair_set(plain.self_pairs()) == reference_pairs(lower, upper)
    assert len(found) > 0
    recorder.close()
    assert recorder.status == "ok" and recorder.bytes == len(read(file))
    counts = played(file)
    assert counts["frames"] == 4 and counts["worlds"] == 2 and counts["calls"] == recorder.calls
    assert counts["questions"] == 4 * (4 + 3 * 10 + 1 + 20 + 20) + 1


@pytest.mark.parametrize("call", ["load", "with_unrecorded", "of_unrecorded"])
def test_call_that_cannot_be_recorded_ends_the_recording(file, call):
    recorder = winnow.Recorder(file)
    lower, upper = random_boxes(106, 100)
    partition, plain = winnow.Partition(recorder=recorder), winnow.Partition()
    for each in (partition, plain):
        each.insert(lower, upper)
    assert recorder.status == "ok"
    if call == "load":
        partition.load(plain.save())
        assert len(partition) == 100
    else:
        first, second = (partition, plain) if call == "with_unrecorded" else (plain, partition)
        assert len(first.pairs_with(second)) >= 100
    assert recorder.status == "unsupported"


def test_scenes_are_recorded_and_replayed(file):
    random = np.random.default_rng(102)
    shapes = winnow.Shapes()
    ids = np.concatenate([shapes.add_spheres([0.5, 0.3]), shapes.add_boxes([[0.4, 0.3, 0.5]])])
    mesh = shapes.add_mesh(CUBE * 3, [[0, 1, 2], [1, 3, 2], [4, 6, 5], [5, 6, 7]])
    recorder = winnow.Recorder(file)
    scene = winnow.Scene(shapes, contact_margin=0.02, cache_tolerance=0.01, warm_start=True, recorder=recorder)
    scene.reserve(dynamic=60, pairs=100)
    scene.add(mesh, [[0, 0, 0]], "fixed")
    keys = scene.add(
        ids[np.arange(60) % 3], random.uniform(-2, 2, (60, 3)), contact=0.01, layer=np.arange(60) % 4
    )
    scene.set_layers_collide([[1, 2]], False)
    scene.set_ignored([[keys[0], keys[1]]])
    contacts = winnow.Contacts()
    touching = []
    for step in range(5):
        scene.move(keys, random.uniform(-2, 2, (len(keys), 3)))
        if step == 2:
            shapes.refit_mesh(mesh, CUBE * 2)
            scene.set_body_state(keys[:4], "sleeping")
            scene.set_shape(keys[5:8], ids[0])
            scene.set_filter(keys[8:9], mask=0)
            scene.set_offsets(keys[9:12], 0.0)
            scene.set_layer(keys[:3], 1)
            scene.remove(keys[59:])
            keys = keys[:59]
        rays = random.uniform(-3, 3, (40, 3)), random.uniform(-3, 3, (40, 3))
        for find in ("closest", "any", "all"):
            scene.cast_rays(*rays, find)
        poses = poses_at(*random.uniform(-2, 2, (6, 3)))
        scene.cast_shapes(ids[0], poses, [0, 0, -3])
        scene.cast_motions(mesh, winnow.motions_between(poses, poses[::-1]), "all")
        scene.overlap(ids[np.arange(6) % 3], poses)
        scene.distance(keys[:9], keys[9:18])
        scene.least_distance(keys[:9], keys[9:])
        scene.overlaps(keys[:9], keys[9:])
        for rules in ("scene", "none"):
            scene.any_contact(keys[:9], keys[9:], contact_margin=0.1, rules=rules)
            scene.any_contact(rules=rules)
        scene.nearest(rays[0][:5], 3)
        scene.collide(contacts)
        touching.append(len(contacts))
        recorder.end_frame()
    assert min(touching) > 5
    assert len(scene.islands(contacts).group) == len(contacts)
    recorder.close()
    assert recorder.status == "ok"
    counts = played(file)
    assert counts["frames"] == 5 and counts["worlds"] == 1


def test_impacts_sensors_and_predicates_are_replayed(file):
    recorder = winnow.Recorder(file)
    shapes = winnow.Shapes()
    ball = shapes.add_spheres([0.6])
    scene = winnow.Scene(shapes, recorder=recorder, warm_start=True)
    places = np.array([[i, 0, 0] for i in range(9)], float)
    keys = scene.add(ball, places)
    contacts = winnow.Contacts()
    scene.set_predicate(lambda first, second: (first + second) % 4 == 1)
    scene.collide(contacts)
    assert len(contacts) == 4
    saved, touching = scene.save(), scene.save_contacts(contacts)
    scene.find_impacts(keys, places + [0, 0, 1], touching=False)
    motions = winnow.motions_between(places, places[::-1])
    assert scene.find_impacts_of_motions(keys, motions, first_only=True).a.size > 0
    sensors = winnow.Sensors(scene)
    goal = sensors.add(ball, [[0.5, 0, 0]])
    assert len(sensors.sense().body) == 2
    sensors.move(goal, [[50, 0, 0]])
    assert len(sensors.sense().body) == 0
    scene.remove(keys[:3])
    scene.load(saved)
    scene.load_contacts(touching, contacts)
    scene.collide(contacts)
    assert len(contacts) == 4 and (contacts.event == 1).all()
    del sensors
    recorder.close()
    assert recorder.status == "ok"
    assert played(file)["questions"] >= 7


def test_recorded_scene_cannot_return_to_earlier_contacts(file):
    recorder = winnow.Recorder(file)
    shapes = winnow.Shapes()
    scene = winnow.Scene(shapes, recorder=recorder)
    scene.add(shapes.add_spheres([0.6]), [[i, 0, 0] for i in range(9)])
    one, other = winnow.Contacts(), winnow.Contacts()
    for contacts in (one, one, other):
        scene.collide(contacts)
    assert recorder.status == "ok"
    scene.collide(one)
    assert recorder.status == "unsupported" and len(one) == 8


def test_recording_outlives_the_recorder(file):
    recorder = winnow.Recorder(file)
    partition = winnow.Partition(recorder=recorder)
    partition.insert(*random_boxes(103, 20))
    del recorder
    partition.self_pairs()
    del partition
    counts = played(file)
    assert counts["worlds"] == counts["questions"] == 1


def test_recording_accepts_any_kind_of_path(tmp_path):
    plain = tmp_path / "one.winnow"
    for path in (plain, str(plain), os.fsencode(plain), tmp_path / "zwölf.winnow"):
        winnow.Recorder(path).close()
        assert winnow.replay(pathlib.Path(os.fsdecode(path)).read_bytes())["is_whole"]
        os.remove(path)
    for path in (f"{plain}\0.old", os.fsencode(plain) + b"\0", "\0"):
        refused("invalid_argument", winnow.Recorder, path)
    for path in (None, 3, ["one"]):
        with pytest.raises(TypeError):
            winnow.Recorder(path)
    with pytest.raises(ValueError):
        winnow.Recorder("\ud800")
    assert str(tmp_path) in refused("invalid_argument", winnow.Recorder, tmp_path)
    assert not list(tmp_path.iterdir())


def test_refused_call_is_not_recorded(file):
    recorder = winnow.Recorder(file)
    partition = winnow.Partition(recorder=recorder)
    before = recorder.calls
    refused("invalid_bounds", partition.insert, [[1, 0, 0]], [[0, 0, 0]])
    refused("invalid_key", partition.remove, [5])
    assert recorder.calls == before
    recorder.close()
    partition.insert([[0, 0, 0]], [[1, 1, 1]])
    assert recorder.calls == before and len(partition) == 1


def test_invalid_recording_is_refused(file):
    with pytest.raises(winnow.StatusError):
        winnow.Recorder("/no/such/folder/run.winnow")
    recorder = winnow.Recorder(file)
    partition = winnow.Partition(recorder=recorder)
    partition.insert(*random_boxes(104, 20))
    partition.self_pairs()
    recorder.close()
    good = read(file)
    refused("invalid_argument", winnow.replay, b"")
    refused("invalid_argument", winnow.replay, good[:-20] + bytes([good[-20] ^ 1]) + good[-19:])
    refused("invalid_argument", winnow.replay, np.frombuffer(good, np.uint8)[::2])
    assert not winnow.replay(good[:-16])["is_whole"]
    with pytest.raises(TypeError):
        winnow.replay("text")


@given(any_array(), st.binary(max_size=200))
@settings(max_examples=100)
def test_any_bytes_are_replayed_or_refused(array, more):
    head = b"WINNOWRC" + bytes([2, 0, 0, 0, 0, 0, 0, 0])
    for data in (array, more, head + more):
        try:
            assert winnow.replay(data)["calls"] == 0
        except (*REFUSALS, BufferError):
            pass


def test_calls_of_several_threads_are_recorded(file):
    recorder = winnow.Recorder(file)
    lower, upper = random_boxes(105, 200)
    partition = winnow.Partition(recorder=recorder)
    keys = partition.insert(lower, upper)
    shapes = winnow.Shapes()
    ids = shapes.add_spheres(np.linspace(0.1, 0.5, 40))
    scene = winnow.Scene(shapes, recorder=recorder)
    scene.add(ids[0], lower)

    def query(i):
        partition.self_pairs()
        partition.cast_rays(lower, upper, ("closest", "all")[i % 2])
        scene.overlap(ids[(3 * i + np.arange(20)) % 40], lower[:20])
        scene.cast_rays(lower, upper, ("closest", "all")[i % 2])

    def change(i):
        partition.update(keys, lower + np.float32(i), upper + np.float32(i))

    at_once(query, change, query, query, times=10)
    recorder.close()
    played(file)
