"""Bad input raises an exception that names the status, and changes nothing."""


import numpy as np
import pytest
import winnow
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as numbers
from worlds import REFUSALS, answered_or_refused, at_once, pair_set, random_boxes, reference_pairs

DTYPES = st.sampled_from(["f4", "f8", "f2", "i4", "u1", "i8", "?", "c8", "O", "S3", ">f4", "g"])
SHAPES = numbers.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=5)


@st.composite
def any_array(draw):
    """Draws an array of any type, shape, layout and content."""
    dtype = np.dtype(draw(DTYPES))
    shape = draw(st.one_of(st.tuples(st.integers(0, 6), st.just(3)), SHAPES))
    if dtype.kind == "f":
        values = draw(
            numbers.arrays(
                dtype, shape, elements=st.floats(width=16 if dtype.itemsize == 2 else 32)
            )
        )
    else:
        values = np.full(shape, draw(st.integers(0, 3)), dtype)
    layout = draw(st.sampled_from(["as it is", "fortran", "backward", "spread", "read-only"]))
    if layout == "fortran":
        values = np.asfortranarray(values)
    elif layout == "backward" and values.ndim:
        values = values[::-1]
    elif layout == "spread" and values.ndim:
        values = np.repeat(values, 2, axis=0)[::2]
    elif layout == "read-only":
        values.flags.writeable = False
    return values


def small_world():
    lower, upper = random_boxes(31, 20)
    partition = winnow.Partition()
    return partition, partition.insert(lower, upper), reference_pairs(lower, upper)


@given(any_array(), any_array(), any_array())
@settings(max_examples=300)
def test_any_arrays_are_accepted_or_refused_whole(first, second, third):
    partition, keys, truth = small_world()
    calls = [
        lambda: partition.insert(first, second, third),
        lambda: partition.insert(first, second),
        lambda: partition.update(third, first, second),
        lambda: partition.update(keys[: len(first)] if first.ndim else keys, first, second, third),
        lambda: partition.remove(third),
        lambda: partition.set_filter(keys, first, second, third),
        lambda: partition.insert_spheres(first, second),
        lambda: partition.insert_kdops(first, second),
    ]
    for call in calls:
        before = len(partition)
        was = [column.copy() for column in partition.bounds(keys)] if partition.contains(keys).all() else []
        try:
            call()
        except REFUSALS as error:
            assert len(partition) == before
            if was:
                assert all(np.array_equal(a, b) for a, b in zip(was, partition.bounds(keys)))
            if isinstance(error, winnow.StatusError):
                assert error.status and str(error).startswith(error.status + ": ")
        else:
            truth = None
    pairs = partition.self_pairs()
    if truth is not None:
        assert pair_set(pairs) == truth


@given(any_array(), any_array(), any_array(), st.sampled_from(["closest", "any", "all", "some"]))
@settings(max_examples=300)
def test_any_queries_are_answered_or_refused(first, second, third, find):
    partition, keys, _ = small_world()
    answered_or_refused([
        lambda: partition.cast_rays(first, second, find, min_t=third),
        lambda: partition.cast_boxes(first, second, third, find),
        lambda: partition.cast_spheres(first, second, third, find),
        lambda: partition.cast_capsules(first, second, 1.0, third, find),
        lambda: partition.overlap_boxes(first, second),
        lambda: partition.overlap_points(first),
        lambda: partition.overlap_spheres(first, second),
        lambda: partition.overlap_capsules(first, second, third),
        lambda: partition.overlap_oriented_boxes(first, second, third),
        lambda: partition.overlap_frusta(first),
        lambda: partition.overlap_planes(first),
        lambda: partition.nearest(first, 3, upper=second, radius=third),
        lambda: partition.nearest(first, 3),
        lambda: partition.contains(first),
        lambda: partition.bounds(first),
        lambda: partition.client_data(first),
        lambda: partition.keys_of(first),
        lambda: partition.filters(first),
        lambda: winnow.outward(first, second, third),
        lambda: winnow.frusta_of(first),
        lambda: winnow.perspective(first, second, third, 1.0, 1.0, 0.1, 9.0),
    ])
    assert len(partition) == 20


def refused(status, call, *arguments, **named):
    with pytest.raises(winnow.StatusError) as caught:
        call(*arguments, **named)
    assert caught.value.status == status and isinstance(caught.value, ValueError)
    return str(caught.value)


def test_exceptions_name_their_status():
    partition, keys, truth = small_world()
    zero, one = np.zeros((1, 3)), np.ones((1, 3))
    refused("size_mismatch", partition.insert, zero, np.ones((2, 3)))
    refused("invalid_key", partition.remove, [winnow.NULL_KEY])
    refused("invalid_argument", partition.overlap_spheres, zero, -1.0)
    refused("invalid_argument", winnow.kdop_directions, 15)
    refused("invalid_argument", winnow.Partition, "LinearBvh", loose=2.0)
    for bad in (None, "boxes", [[1, 2, "3"]], np.zeros((1, 3), complex), [[1], [2, 3]]):
        with pytest.raises(TypeError):
            partition.insert(bad, one)
    with pytest.raises(TypeError):
        partition.remove(np.zeros(1))
    assert pair_set(partition.self_pairs()) == truth


def test_stale_and_foreign_keys_change_nothing():
    partition, keys, truth = small_world()
    other, foreign, _ = small_world()
    extra = partition.insert([[99, 99, 99]], [[100, 100, 100]])
    partition.remove(extra)
    for bad in (extra, foreign[:1], [winnow.NULL_KEY], [0], [2**64 - 1], [2**63 - 1]):
        mixed = np.concatenate([keys[:3], np.asarray(bad, np.uint64)])
        box = np.zeros((4, 3))
        refused("invalid_key", partition.update, mixed, box, box)
        refused("invalid_key", partition.remove, mixed)
        refused("invalid_key", partition.bounds, mixed)
        refused("invalid_key", partition.set_filter, mixed, layers=2)
        assert not partition.contains(np.asarray(bad, np.uint64)).any()
    assert pair_set(partition.self_pairs()) == truth


def test_empty_arrays_give_empty_results():
    partition, keys, _ = small_world()
    none = np.empty((0, 3))
    assert len(partition.insert(none, none)) == 0
    partition.update([], none, none)
    partition.remove([])
    for find in ("closest", "any", "all"):
        assert len(partition.cast_rays(none, none, find).t) == 0
        assert len(partition.cast_spheres(none, 1.0, none, find).t) == 0
    assert len(partition.overlap_boxes(none, none)) == 0
    assert partition.overlap_points(none).first.tolist() == [0]
    assert partition.nearest(none, 4).key.shape == (0, 4)
    assert len(winnow.Partition().self_pairs()) == 0


def test_too_large_request_is_a_memory_error():
    partition, _, _ = small_world()
    with pytest.raises(MemoryError):
        partition.nearest(np.zeros((2, 3)), 2**60)
    with pytest.raises((MemoryError, winnow.StatusError)):
        partition.reserve(2**40)
    with pytest.raises(MemoryError):
        partition.reserve(10, pairs=2**60)
    assert len(partition) == 20


def test_uninitialised_objects_are_refused():
    for kind in (winnow.Partition, winnow.PairEvents):
        with pytest.raises(TypeError):
            kind.__new__(kind).clear()
    with pytest.raises(TypeError):
        winnow.Hits()


def callables_of(module):
    for value in vars(module).values():
        if isinstance(value, type):
            yield value
            for name, member in list(vars(value).items()):
                if isinstance(member, property):
                    yield member.fget
                elif callable(member) and not isinstance(member, type):
                    yield getattr(value, name)
        elif callable(value):
            yield value


def test_none_as_any_argument_is_accepted_or_refused():
    for kind in (winnow.Scene, winnow.Sensors):
        with pytest.raises(TypeError):
            kind(None)
    calls = list(callables_of(winnow._core))
    assert len(calls) > 200
    for call in calls:
        for count in range(6):
            try:
                call(*[None] * count)
            except Exception:
                pass


def test_threads_may_query_and_change_at_once():
    lower, upper = random_boxes(32, 400)
    partition, other = winnow.Partition(), winnow.Partition("AutoPartition")
    keys = partition.insert(lower, upper)
    other.insert(lower, upper)
    events = winnow.PairEvents()
    held = []

    def query(i):
        held.append(partition.self_pairs()[:5])
        partition.pairs_with(other)
        other.pairs_with(partition)
        partition.cast_rays(lower, upper - lower + 1, ("closest", "all")[i % 2])
        partition.overlap_spheres(lower, 0.5)
        partition.nearest(lower[:50], 3)

    def change(i):
        step = np.float32(0.01 * i)
        partition.update(keys, lower + step, upper + step)
        extra = partition.insert(lower[:9], upper[:9])
        partition.self_pairs(events)
        len(events.begun)
        partition.remove(extra)
        other.set_structure(winnow.structures()[1 + i % 9])

    at_once(query, change, query, change)
    partition.update(keys, lower, upper)
    assert pair_set(partition.self_pairs()) == reference_pairs(lower, upper)
