"""Objects of a partition and their pairs."""

import gc

import numpy as np
import pytest
import winnow
from worlds import pair_set, random_boxes, reference_pairs


def filled(lower, upper, structure="LinearBvh", **options):
    partition = winnow.Partition(structure, **options)
    return partition, partition.insert(lower, upper)


def test_two_boxes_that_touch_are_a_pair():
    partition = winnow.Partition("LinearBvh")
    keys = partition.insert([[0, 0, 0], [1, 1, 1], [5, 5, 5]], [[1, 1, 1], [2, 2, 2], [6, 6, 6]])
    assert partition.self_pairs().tolist() == [[0, 1]]
    partition.update(keys[2:], [[2, 2, 2]], [[3, 3, 3]])
    assert pair_set(partition.self_pairs()) == {(0, 1), (1, 2)}
    partition.remove(keys[:1])
    assert partition.self_pairs().tolist() == [[1, 2]]
    assert len(partition) == 2


@pytest.mark.parametrize("structure", winnow.structures())
@pytest.mark.parametrize("volume", ["aabb", "sphere", "kdop14", "kdop18", "kdop26"])
def test_every_structure_and_volume_finds_all_pairs(structure, volume):
    lower, upper = random_boxes(1, 200)
    partition, _ = filled(lower, upper, structure, volume=volume)
    found = pair_set(partition.self_pairs())
    truth = reference_pairs(lower, upper)
    assert found >= truth
    assert partition.volume == volume and partition.structure == structure
    if partition.is_exact:
        assert found == truth


def test_pairs_follow_moves_on_fresh_and_held_arrays():
    random = np.random.default_rng(2)
    lower, upper = random_boxes(2, 400)
    partition, keys = filled(lower, upper)
    held = []
    for frame in range(12):
        if frame % 3 == 2:
            held.clear()
        pairs = partition.self_pairs()
        assert pair_set(pairs) == reference_pairs(lower, upper)
        held.append((pairs, pairs.copy()))
        for shown, as_it_was in held:
            assert np.array_equal(shown, as_it_was)
        moved = random.choice(400, size=(4, 300)[frame % 2], replace=False)
        step = random.uniform(-0.5, 0.5, (len(moved), 3)).astype(np.float32)
        lower[moved] += step
        upper[moved] += step
        if frame % 4 == 0:
            partition.update(keys, lower, upper, entries=moved)
        elif frame % 4 == 1:
            partition.update(keys, lower, upper, entries=np.isin(np.arange(400), moved))
        else:
            partition.update(keys[moved], lower[moved], upper[moved])


def test_array_without_references_is_filled_in_place():
    partition, _ = filled(*random_boxes(3, 300))
    address = partition.self_pairs().ctypes.data
    for _ in range(3):
        assert partition.self_pairs().ctypes.data == address
    held = partition.self_pairs()
    assert held.ctypes.data == address
    assert partition.self_pairs().ctypes.data != address
    assert partition.statistics()["incremental_queries"] >= 4


def test_arrays_outlive_the_partition_and_are_read_only():
    lower, upper = random_boxes(4, 100)
    partition, _ = filled(lower, upper)
    pairs = partition.self_pairs()
    part = pairs[3:9, 1]
    del partition, pairs
    gc.collect()
    assert part.base is not None and part.shape == (6,)
    with pytest.raises(ValueError):
        part[0] = 7
    with pytest.raises(ValueError):
        part.flags.writeable = True


def test_floats_of_any_stride_are_read_in_place():
    lower, upper = random_boxes(5, 50)
    records = np.zeros((50, 9), np.float32)
    records[:, 1:4], records[:, 5:8] = lower, upper
    columns = np.asfortranarray(np.hstack([lower, upper]))
    cases = [
        (lower, upper),
        (records[:, 1:4], records[:, 5:8]),
        (columns[:, :3], columns[:, 3:]),
        (lower[::-1], upper[::-1]),
        (lower[::7], upper[::7]),
        (records[::-3, 3:0:-1], records[::-3, 7:4:-1]),
    ]
    for low, high in cases:
        assert winnow.boxes_address(low, high) == low.ctypes.data
        partition, _ = filled(low, high)
        assert pair_set(partition.self_pairs()) == reference_pairs(low, high)


def test_unsuitable_arrays_are_copied():
    lower, upper = random_boxes(6, 50)
    odd = np.zeros(50 * 12 + 1, np.uint8)[1:].view(np.float32).reshape(50, 3)
    odd[:] = lower
    wide = np.zeros((50, 6), np.float32)
    wide[:, :3] = upper
    for low, high in [
        (lower.astype(float), upper.astype(float)),
        (lower.astype(">f4"), upper.astype(">f8")),
        (odd, upper),
        (lower, wide[:, :3]),
        (lower.tolist(), upper.tolist()),
    ]:
        partition, _ = filled(low, high)
        assert pair_set(partition.self_pairs()) == reference_pairs(lower, upper)


def test_doubles_are_rounded_outward():
    low = np.array([[0.1, 1e-50, -1e300]])
    high = np.array([[0.1, 1.0 + 1e-12, 1e300]])
    partition, keys = filled(low, high)
    lower, upper = partition.bounds(keys)
    assert (lower.astype(float) <= low).all() and (upper.astype(float) >= high).all()
    assert np.nextafter(lower[0, 0], np.float32(1)) > low[0, 0]


def test_keys_are_valid_until_removal():
    lower, upper = random_boxes(7, 10)
    partition = winnow.Partition()
    keys = partition.insert(lower, upper, data=np.arange(10) * 3)
    assert winnow.ids_of(keys).tolist() == list(range(10))
    assert winnow.ids_of(keys).base is not None
    assert partition.client_data(keys).tolist() == list(range(0, 30, 3))
    partition.remove(keys[4:5])
    assert partition.contains(keys).tolist() == [True] * 4 + [False] + [True] * 5
    found = partition.keys_of([3, 4, 99])
    assert found.tolist() == [int(keys[3]), winnow.NULL_KEY, winnow.NULL_KEY]
    assert partition.client_data_of([3, 4]).tolist() == [9, 0]
    low, high = partition.bounds(keys[5:7])
    assert np.array_equal(low, lower[5:7]) and np.array_equal(high, upper[5:7])


def test_spheres_and_kdops_are_tested_exactly():
    balls = winnow.Partition(volume="sphere")
    keys = balls.insert_spheres([[0, 0, 0], [1.5, 1.5, 0]], 1.0)
    assert len(balls.self_pairs()) == 0
    balls.update_spheres(keys[:1], [[0.5, 0.5, 0]], [1.0])
    assert balls.self_pairs().tolist() == [[0, 1]]
    points = np.array([[[0, 0, 0], [1, 1, 0]], [[1, 0, 0], [1, 0, 0]]], float)
    for faces in (14, 18, 26):
        directions = winnow.kdop_directions(faces)
        along = points @ directions.T
        solids = winnow.Partition(volume=f"kdop{faces}")
        keys = solids.insert_kdops(along.min(axis=1), along.max(axis=1))
        # A diagonal and a point beside the diagonal: their boxes touch.
        assert len(solids.self_pairs()) == 0
        solids.update_kdops(keys, along.min(axis=1), along.max(axis=1) + 9)
        assert len(solids.self_pairs()) == 1
    with pytest.raises(winnow.StatusError, match="unsupported_volume"):
        balls.insert_kdops(np.zeros((1, 7)), np.ones((1, 7)))
    with pytest.raises(winnow.StatusError, match="unsupported_volume"):
        winnow.Partition().insert_spheres(np.zeros((1, 3)), 1.0)


def test_events_report_begun_and_ended_pairs():
    lower, upper = random_boxes(8, 300)
    partition, keys = filled(lower, upper)
    events, events_only = winnow.PairEvents(), winnow.PairEvents()
    before = set()
    for frame in range(8):
        held = partition.self_pairs(events)  # kept over the next call in every second frame
        partition.pair_changes(events_only)
        now = pair_set(held)
        for found in (events, events_only):
            assert pair_set(winnow.ids_of(found.begun)) == now - before
            assert pair_set(winnow.ids_of(found.ended)) == before - now
            assert found.persisting == len(now & before)
        before = now
        if frame % 2:
            del held
        some = slice(10 * frame, 10 * frame + (200 if frame == 5 else 5))
        lower[some] += 0.3
        upper[some] += 0.3
        partition.update(keys[some], lower[some], upper[some])


def test_ended_pairs_have_the_client_data():
    lower, upper = random_boxes(12, 200)
    partition = winnow.Partition()
    keys = partition.insert(lower, upper, np.arange(200) + 2**40)
    data_of = dict(zip(keys.tolist(), range(2**40, 2**40 + 200)))
    events = winnow.PairEvents(client_data=True)
    partition.self_pairs(events)
    partition.remove(keys[:50])
    # New objects get their ids.
    fresh = partition.insert(lower[:50] + 0.4, upper[:50] + 0.4, np.arange(50))
    data_of.update(zip(fresh.tolist(), range(50)))
    partition.self_pairs(events)
    for pairs, data in ((events.begun, events.begun_data), (events.ended, events.ended_data)):
        assert len(pairs) > 0 and data.dtype == np.uint64
        assert data.tolist() == [[data_of[a], data_of[b]] for a, b in pairs.tolist()]
    without = winnow.PairEvents()
    partition.self_pairs(without)
    assert len(without.begun) > 0
    assert without.begun_data.shape == without.ended_data.shape == (0, 2)


def test_pairs_of_boxes_are_found_in_one_call():
    lower, upper = random_boxes(11, 200)
    partition, _ = filled(lower, upper)
    assert np.array_equal(winnow.pairs(lower, upper), partition.self_pairs(order="canonical"))
    assert winnow.pairs([[0, 0, 0], [1, 1, 1]], [[1, 1, 1], [2, 2, 2]]).tolist() == [[0, 1]]


def test_version_is_that_of_the_project():
    assert winnow.__version__.count(".") == 2


def test_arrays_of_events_stay_when_filled_again():
    partition, _ = filled(*random_boxes(9, 50))
    events = winnow.PairEvents()
    partition.self_pairs(events)
    begun = events.begun
    before = begun.copy()
    partition.self_pairs(events)
    events.clear()
    assert len(begun) > 0 and np.array_equal(begun, before)


def test_pairs_with_another_partition_and_itself_are_right():
    lower, upper = random_boxes(10, 150)
    one, _ = filled(lower[:100], upper[:100])
    other, _ = filled(lower[100:], upper[100:], "SweepAndPrune")
    truth = {(a, b - 100) for a, b in reference_pairs(lower, upper) if a < 100 <= b}
    assert pair_set(one.pairs_with(other)) == truth
    assert pair_set(other.pairs_with(one)) == {(b, a) for a, b in truth}
    assert len(one.pairs_with(one)) >= 100


def test_filters_separate_layers_and_environments():
    partition = winnow.Partition()
    keys = partition.insert(np.zeros((4, 3)), np.ones((4, 3)))
    partition.set_filter(keys, environment=[0, 0, 1, winnow.EVERY_ENVIRONMENT])
    assert pair_set(partition.self_pairs()) == {(0, 1), (0, 3), (1, 3), (2, 3)}
    partition.set_filter(keys[:2], layers=2, mask=1)
    assert pair_set(partition.self_pairs()) == {(0, 3), (1, 3), (2, 3)}
    layers, mask, environment = partition.filters(keys)
    assert layers.tolist() == [2, 2, 1, 1] and mask[0] == 1 and environment[2] == 1


def test_exchanged_structure_keeps_the_objects():
    lower, upper = random_boxes(11, 200)
    partition, keys = filled(lower, upper, "AutoPartition", fat_margin=0.01, fat_margin_share=0.05)
    assert partition.fat_margin == (pytest.approx(0.01), pytest.approx(0.05))
    assert not partition.is_exact
    partition.refresh()
    assert partition.choice()["objects"] == 200
    truth = reference_pairs(lower, upper)
    for name in winnow.structures():
        partition.set_structure(name)
        assert pair_set(partition.self_pairs()) >= truth
    partition.set_structure("LooseOctree", loose=1.5)
    assert partition.contains(keys).all()


def test_memory_is_reported_kept_and_released():
    partition = winnow.Partition()
    partition.reserve(1000, pairs=5000, touch=True)
    lower, upper = random_boxes(12, 1000)
    partition.insert(lower, upper)
    partition.self_pairs()
    footprint = partition.footprint()
    assert footprint["total"][1] == sum(footprint[k][1] for k in footprint if k != "total")
    partition.clear()
    assert len(partition) == 0 and len(partition.self_pairs()) == 0
    partition.release_memory()
    assert partition.footprint()["bounds"] == (0, 0)


def test_drawing_shows_every_object():
    lower, upper = random_boxes(13, 40)
    partition, _ = filled(lower, upper)
    drawing = partition.debug_draw(labels=True)
    assert len(drawing.boxes) >= 40 and len(drawing.boxes) == len(drawing.box_colours)
    assert np.array_equal(drawing.boxes[-40:], np.hstack([lower, upper]))
    assert len(drawing.texts) == len(drawing.text_places)
    assert len(partition.debug_draw(structure=False).boxes) == 40


def test_outward_boxes_far_away_are_tight():
    low = np.array([[1e8, 1e8, 1e8]])
    lower, upper = winnow.outward(low, low + 0.25, [1e8, 1e8, 1e8])
    assert lower.tolist() == [[0, 0, 0]] and upper.tolist() == [[0.25, 0.25, 0.25]]


def test_instruction_sets_can_be_selected():
    usual = winnow.isa_name()
    assert usual in winnow.available_isas()
    lower, upper = random_boxes(14, 300)
    found = []
    for name in winnow.available_isas():
        winnow.set_isa(name)
        partition, _ = filled(lower, upper)
        found.append(partition.self_pairs(order="canonical").tolist())
    winnow.set_isa(usual)
    assert all(pairs == found[0] for pairs in found)
    with pytest.raises(winnow.StatusError):
        winnow.set_isa("abacus")
