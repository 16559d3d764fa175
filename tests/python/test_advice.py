"""winnow.advise: which structure is fastest on the frames of the caller."""

import numpy as np
import winnow
from test_hostile import refused
from worlds import random_boxes, reference_pairs


def frames(count=6, objects=200):
    lower, upper = random_boxes(61, objects)
    for i in range(count):
        moved = np.float32(0.05 * i) * (np.arange(objects)[:, None] % 2)
        yield lower + moved, upper + moved


def test_structures_are_ranked_by_median_time():
    names = ["LinearBvh", "UniformGrid", "AutoPartition"]
    known = [name for name in names if name in winnow.structures()]
    advice = winnow.advise(frames(), known)
    assert sorted(a.structure for a in advice.ranking) == sorted(known)
    medians = [a.median_ms for a in advice.ranking]
    assert medians == sorted(medians) and min(medians) > 0
    assert advice.best == advice.ranking[0].structure
    assert advice.objects == 200 and advice.frames == 6
    assert advice.pairs == np.mean([len(reference_pairs(*boxes)) for boxes in frames()])
    assert advice.chosen in winnow.structures() and advice.reason
    for one in advice.ranking:
        assert one.worst_ms >= one.median_ms and one.first_ms > 0 and one.bytes > 0


def test_all_suitable_structures_are_raced_by_default():
    advice = winnow.advise(frames(2, 50))
    assert {a.structure for a in advice.ranking} == set(winnow.structures())
    assert winnow.advise(frames(1, 10), ["LinearBvh"]).frames == 1


def test_invalid_races_are_refused():
    boxes = random_boxes(62, 10)
    refused("invalid_argument", winnow.advise, [])
    refused("invalid_argument", winnow.advise, [boxes], [])
    refused("invalid_argument", winnow.advise, [boxes], ["Heap"])
    refused("size_mismatch", winnow.advise, [boxes, random_boxes(62, 11)])
    refused("invalid_bounds", winnow.advise, [boxes[::-1]])
