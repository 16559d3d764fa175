"""Python functions that winnow calls: predicates, support functions and hooks. Their exceptions are raised
from the call, and they can neither crash nor block the interpreter."""

import subprocess
import sys
import textwrap

import numpy as np
import pytest
import winnow
from test_hostile import refused
from test_narrow import poses_at
from worlds import at_once, pair_set, random_boxes, reference_pairs


class Odd(Exception):
    """Raised only by the functions of these tests."""


def raises(*_):
    raise Odd("on purpose")


class Untrue:
    def __bool__(self):
        raise Odd("neither true nor false")


def box_world(count=300):
    lower, upper = random_boxes(51, count)
    partition = winnow.Partition()
    return partition, partition.insert(lower, upper), reference_pairs(lower, upper), lower, upper


def test_predicate_selects_pairs():
    partition, _, truth, _, _ = box_world()

    def odd_sum(first, second):
        return (first + second) % 2

    expected = {pair for pair in truth if sum(pair) % 2}
    assert expected and expected != truth
    assert pair_set(partition.self_pairs(predicate=odd_sum)) == expected
    assert pair_set(partition.self_pairs()) == truth
    assert pair_set(partition.self_pairs(predicate=lambda *_: False)) == set()
    assert pair_set(partition.self_pairs(predicate=odd_sum, order="canonical")) == expected
    assert pair_set(partition.self_pairs()) == truth
    events = winnow.PairEvents()
    partition.pair_changes(events, predicate=odd_sum)
    assert len(events.begun) == len(expected)
    partition.pair_changes(events)
    assert len(events.begun) == len(truth) - len(expected) and not len(events.ended)
    partition.pair_changes(events, predicate=odd_sum)
    assert len(events.ended) == len(truth) - len(expected) and not len(events.begun)
    refused("unsupported", partition.self_pairs, events, predicate=odd_sum)
    other, _, _, _, _ = box_world()
    both = pair_set(partition.pairs_with(other))
    passing = pair_set(partition.pairs_with(other, predicate=odd_sum))
    assert passing == {pair for pair in both if sum(pair) % 2}
    assert pair_set(partition.pairs_with(other)) == both


def test_filter_function_selects_objects():
    partition, keys, _, lower, upper = box_world()
    data = np.arange(len(keys), dtype=np.uint64)
    partition.remove(keys)
    keys = partition.insert(lower, upper, data)
    tested = []

    def third(key, number):
        tested.append((key, number))
        return number % 3 == 0

    filter = winnow.Filter(accept=third)
    assert filter.accept is third and "accept=" in repr(filter)
    found = partition.overlap_boxes(lower, upper, filter=filter)
    ids = winnow.ids_of(keys)
    allowed = set(ids[::3].tolist())
    everything = pair_set(partition.overlap_boxes(lower, upper))
    assert pair_set(found) == {pair for pair in everything if pair[1] in allowed}
    assert all(int(keys[number]) == key for key, number in tested)
    nearest = partition.nearest(lower, 1, filter=filter)
    assert (nearest.data % 3 == 0).all()
    hits = partition.cast_rays(lower - 1, np.ones_like(lower), "all", filter=filter)
    assert len(hits.data) and (hits.data % 3 == 0).all()


def ball_world(count=40):
    shapes = winnow.Shapes()
    ball = int(shapes.add_spheres(0.5)[0])
    scene = winnow.Scene(shapes)
    places = np.random.default_rng(52).uniform(0, 3, (count, 3))
    keys = scene.add(ball, places, data=np.arange(count))
    return shapes, scene, keys, places


def pairs_of(scene, contacts=None):
    contacts = contacts or winnow.Contacts()
    scene.collide(contacts, "boolean")
    return {frozenset(pair) for pair in zip(contacts.data_a.tolist(), contacts.data_b.tolist())}


def test_predicate_selects_pairs_of_bodies():
    _, scene, keys, _ = ball_world()
    number = {int(i): n for n, i in enumerate(winnow.ids_of(keys))}
    truth = pairs_of(scene)

    def even_sum(first, second):
        return (number[first] + number[second]) % 2 == 0

    scene.set_predicate(even_sum)
    assert scene.predicate is even_sum
    assert pairs_of(scene) == {pair for pair in truth if sum(pair) % 2 == 0}
    scene.set_predicate(lambda *_: 0)
    assert pairs_of(scene) == set()
    scene.set_predicate(None)
    assert scene.predicate is None and pairs_of(scene) == truth


def test_query_layer_selects_bodies():
    _, scene, keys, places = ball_world()
    scene.set_layer(keys[::2], 100)
    scene.set_layers_collide([[7, 100]], False)
    hits = scene.nearest(places, 3, filter=winnow.Filter(layer=7))
    assert len(hits.data) and (hits.data % 2 == 1).all()
    both = winnow.Filter(layer=7, accept=lambda key, data: data > 9)
    hits = scene.nearest(places, 3, filter=both)
    assert len(hits.data) and ((hits.data % 2 == 1) & (hits.data > 9)).all()
    refused("invalid_argument", winnow.Filter, layer=4096)
    partition, *_ = box_world()
    refused("unsupported", partition.nearest, places, filter=winnow.Filter(layer=7))


@pytest.mark.parametrize("bad", [raises, lambda: 1, lambda a, b: Untrue(), lambda a, b: 1 / 0])
def test_exception_of_a_predicate_changes_nothing(bad):
    partition, keys, truth, lower, upper = box_world()
    expected = (Odd, TypeError, ZeroDivisionError)
    events = winnow.PairEvents()
    partition.self_pairs(events)
    for call in [
        lambda: partition.self_pairs(predicate=bad),
        lambda: partition.pair_changes(events, predicate=bad),
        lambda: partition.pairs_with(partition, predicate=bad),
        lambda: partition.overlap_boxes(lower, upper, filter=winnow.Filter(accept=bad)),
        lambda: partition.nearest(lower, 2, filter=winnow.Filter(accept=bad)),
        lambda: partition.cast_rays(lower - 1, upper, filter=winnow.Filter(accept=bad)),
        lambda: partition.cast_spheres(lower, 1, upper, filter=winnow.Filter(accept=bad)),
    ]:
        with pytest.raises(expected):
            call()
    assert pair_set(partition.self_pairs(events)) == truth
    assert len(events.begun) == len(truth)

    _, scene, _, places = ball_world()
    truth = pairs_of(scene)
    contacts = winnow.Contacts()
    pairs_of(scene, contacts)
    scene.set_predicate(bad)
    for _ in range(2):
        with pytest.raises(expected):
            scene.collide(contacts)
        assert len(contacts) == 0
    with pytest.raises(expected):
        scene.nearest(places, 2, filter=winnow.Filter(accept=bad))
    scene.set_predicate(None)
    assert pairs_of(scene, contacts) == truth


def test_predicate_after_an_exception_gets_all_pairs():
    _, scene, _, _ = ball_world()
    truth = pairs_of(scene)
    calls = []

    def fails_once(first, second):
        calls.append(1)
        if len(calls) == 3:
            raise Odd("once")
        return True

    scene.set_predicate(fails_once)
    with pytest.raises(Odd):
        pairs_of(scene)
    assert pairs_of(scene) == truth


def test_non_callable_is_a_type_error():
    partition, *_ = box_world()
    shapes, scene, *_ = ball_world()
    for call in [
        lambda: partition.self_pairs(predicate=7),
        lambda: partition.pairs_with(partition, predicate="f"),
        lambda: winnow.Filter(accept=[]),
        lambda: scene.set_predicate(1.5),
        lambda: shapes.add_support("f", 1.0),
        lambda: shapes.add_support(None, 1.0),
        lambda: winnow.set_stage_hook(3),
        lambda: winnow.set_log_hook({}),
    ]:
        with pytest.raises(TypeError):
            call()


def ball(direction):
    return 0.5 * direction


def test_support_function_defines_a_shape():
    shapes = winnow.Shapes()
    own = shapes.add_support(ball, 0.5)
    core = shapes.add_support(lambda direction: [0, 0, 0], 0.0, 0.5)
    true = int(shapes.add_spheres(0.5)[0])
    poses = poses_at([0, 0, 0], [0.8, 0, 0], [3, 4, 0])
    narrow = winnow.NarrowPhase()
    pairs = [[0, 1], [0, 2], [1, 2]]
    expected = narrow.collide(shapes, true, poses, pairs, level="distance")
    order = np.argsort(expected.pair)
    for shape in (own, core):
        found = narrow.collide(shapes, shape, poses, pairs, level="distance")
        assert found.distance[np.argsort(found.pair)] == pytest.approx(expected.distance[order], abs=1e-6)
    lower, upper = shapes.bounds([own], [[1, 2, 3]])
    assert lower[0] == pytest.approx([0.5, 1.5, 2.5]) and upper[0] == pytest.approx([1.5, 2.5, 3.5])
    scene = winnow.Scene(shapes)
    scene.add([own, own, true], poses, data=[1, 2, 3])
    assert pairs_of(scene) == {frozenset([1, 2])}
    hits = scene.cast_rays([[3, 4, 9], [0, 0, 9]], [[0, 0, -1], [0, 0, -1]])
    assert hits.t == pytest.approx([8.5, 8.5]) and hits.data.tolist() == [3, 1]
    motions = winnow.motions_between(poses_at([0, 0, 0], [3, 0, 0]), poses_at([0, 0, 0], [0, 0, 0]))
    impacts = winnow.time_of_impact(shapes, own, motions, [[0, 1]])
    assert impacts.time[0] == pytest.approx(2 / 3, abs=1e-5)
    refused("unsupported", shapes.save)
    refused("invalid_key", shapes.remove, [own])
    shapes.remove([core])
    assert not shapes.contains([core])[0]


@pytest.mark.parametrize(
    "function",
    [
        lambda d: d * np.nan,
        lambda d: 2 * d,
        lambda d: -d / 2,
    ],
)
def test_function_of_no_convex_shape_is_refused(function):
    refused("invalid_shape", winnow.Shapes().add_support, function, 0.5)


@pytest.mark.parametrize("answer", [None, "here", 7, [1, 2], [[1, 2, 3]], [1, 2, "z"], object()])
def test_support_point_of_wrong_type_raises(answer):
    shapes = winnow.Shapes()
    with pytest.raises((TypeError, ValueError)):
        shapes.add_support(lambda direction: answer, 1.0)
    refused("invalid_shape", shapes.add_support, ball, -1.0)
    refused("invalid_shape", shapes.add_support, ball, np.nan)
    refused("invalid_shape", shapes.add_support, ball, 0.5, -1.0)


def test_later_exception_of_a_support_function_is_raised():
    shapes = winnow.Shapes()
    fails = [False]

    def function(direction):
        if fails[0]:
            raise Odd("later")
        return 0.5 * direction

    own = shapes.add_support(function, 0.5)
    scene = winnow.Scene(shapes)
    poses = poses_at([0, 0, 0], [0.8, 0, 0])
    keys = scene.add(own, poses, data=[1, 2])
    assert pairs_of(scene) == {frozenset([1, 2])}
    fails[0] = True
    contacts = winnow.Contacts()
    motions = winnow.motions_between(poses, poses_at([0, 0, 0], [0.9, 0, 0]))
    for call in [
        lambda: scene.collide(contacts),
        lambda: scene.nearest([[9, 9, 9]]),
        lambda: scene.cast_rays([[0, 0, 9]], [[0, 0, -1]]),
        lambda: scene.distance(keys[:1], keys[1:]),
        lambda: winnow.NarrowPhase().collide(shapes, own, poses, [[0, 1]], level="distance"),
        lambda: winnow.time_of_impact(shapes, own, motions, [[0, 1]]),
        lambda: shapes.bounds([own], [[0, 0, 0]]),
        lambda: shapes.cast_rays([own], [[0, 0, 0]], [0, 0, 9], [0, 0, -1]),
    ]:
        with pytest.raises(Odd):
            call()
    fails[0] = False
    assert pairs_of(scene, contacts) == {frozenset([1, 2])}
    scene.move(keys[1:], [[5, 0, 0]])
    fails[0] = True
    with pytest.raises(Odd):
        scene.collide(contacts)
    fails[0] = False
    assert pairs_of(scene, contacts) == set()
    scene.move(keys[1:], [[0.9, 0, 0]])
    assert pairs_of(scene, contacts) == {frozenset([1, 2])}


def test_callbacks_that_call_winnow_raise_without_deadlock():
    partition, keys, _, lower, upper = box_world(60)
    shapes, scene, bodies, places = ball_world(20)
    contacts, events, narrow = winnow.Contacts(), winnow.PairEvents(), winnow.NarrowPhase()
    cluster = winnow.Cluster(ranks=2)
    nested_calls = [
        lambda: partition.self_pairs(),
        lambda: partition.insert(lower, upper),
        lambda: partition.nearest(lower),
        lambda: partition.clear(),
        lambda: len(partition),
        lambda: events.clear(),
        lambda: scene.collide(contacts),
        lambda: scene.nearest(places),
        lambda: scene.set_predicate(None),
        lambda: scene.predicate,
        lambda: contacts.clear(),
        lambda: shapes.add_spheres(1.0),
        lambda: shapes.remove([0]),
        lambda: narrow.collide(shapes, 0, places, [[0, 1]]),
        lambda: cluster.self_pairs(),
        lambda: winnow.Partition().insert(lower, upper),
    ]
    for nested in nested_calls:
        def nosy(*_, nested=nested):
            nested()

        for call in [
            lambda: partition.self_pairs(predicate=nosy),
            lambda: partition.pair_changes(events, predicate=nosy),
            lambda: partition.nearest(lower, filter=winnow.Filter(accept=nosy)),
            lambda: shapes.add_support(nosy, 1.0),
        ]:
            refused("unsupported", call)
        scene.set_predicate(nosy)
        refused("unsupported", scene.collide, contacts)
        scene.set_predicate(None)
    assert len(partition) == 60 and len(pairs_of(scene)) > 0


def test_callbacks_on_several_threads_are_safe():
    partition, _, truth, lower, upper = box_world()
    shapes = winnow.Shapes()
    own = shapes.add_support(ball, 0.5)
    scene = winnow.Scene(shapes)
    places = np.random.default_rng(53).uniform(0, 3, (30, 3))
    scene.add(own, places, data=np.arange(30))
    expected = pairs_of(scene)
    bad = winnow.Filter(accept=raises)

    def right(_):
        assert pair_set(partition.self_pairs(predicate=lambda a, b: True)) == truth
        assert pairs_of(scene) == expected

    def wrong(_):
        with pytest.raises(Odd):
            partition.nearest(lower, filter=bad)
        with pytest.raises(Odd):
            partition.self_pairs(predicate=raises)

    at_once(right, wrong, right, wrong, times=5)


def test_hooks_receive_stages_and_refusals():
    stages, entries = [], []
    assert winnow.set_stage_hook(lambda stage, begins: stages.append((stage, begins))) is None
    assert winnow.set_log_hook(entries.append) is None
    try:
        _, scene, _, _ = ball_world()
        scene.collide(winnow.Contacts())
        with pytest.raises(winnow.StatusError):
            winnow.Partition().remove([1])
    finally:
        assert callable(winnow.set_stage_hook(None))
        assert winnow.set_log_hook(None).__self__ is entries
    names = {"refresh", "build", "pairs", "mid_phase", "narrow_phase", "contacts"}
    assert {"pairs", "narrow_phase"} <= {stage for stage, _ in stages} <= names
    open_ones = []
    for stage, begins in stages:
        open_ones.append(stage) if begins else None
        assert begins or open_ones.pop() == stage
    assert not open_ones
    assert any(e["kind"] == "refusal" and e["status"] == "invalid_key" for e in entries)
    stage_count = len(stages)
    scene.collide(winnow.Contacts())
    assert len(stages) == stage_count


def test_exception_of_a_hook_is_unraisable():
    caught = []
    before, sys.unraisablehook = sys.unraisablehook, lambda info: caught.append(info.exc_type)
    try:
        winnow.set_stage_hook(raises)
        partition, _, truth, _, _ = box_world()
        assert pair_set(partition.self_pairs()) == truth
        winnow.set_stage_hook(lambda *_: partition.self_pairs())
        assert pair_set(partition.self_pairs()) == truth
    finally:
        winnow.set_stage_hook(None)
        sys.unraisablehook = before
    assert Odd in caught and winnow.StatusError in caught


@pytest.mark.parametrize("predicate", ["None", "lambda a, b: True"])
def test_interpreter_exits_cleanly_with_threads_at_work(predicate):
    program = """
        import threading, time, numpy, winnow
        lower = numpy.random.default_rng(1).uniform(0, 12, (3000, 3))
        partition = winnow.Partition()
        partition.insert(lower, lower + 1)
        winnow.set_stage_hook(lambda stage, begins: None)
        def work():
            while True:
                partition.self_pairs(predicate=%s, incremental=False)
        for _ in range(4):
            threading.Thread(target=work, daemon=True).start()
        time.sleep(0.3)
        print("over", flush=True)
    """ % predicate
    for _ in range(3):
        ended = subprocess.run(
            [sys.executable, "-c", textwrap.dedent(program)],
            capture_output=True, text=True, timeout=900,
        )
        assert ended.stdout == "over\n" and ended.returncode == 0, ended
