"""Usage: race.py [FRAMES]

Times the Python package against scipy's cKDTree, open3d's fixed-radius search, and the same frames in
C++. FRAMES is the C++ program, by default winnow_python_frames in build/ci. Prints the median
milliseconds of a frame.
"""

import os
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np
import winnow

try:
    from scipy.spatial import cKDTree
except ImportError:
    cKDTree = None

try:
    from open3d import core as open3d
except ImportError:
    open3d = None

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")


def median_ms(frame, frames):
    times = []
    for number in frames:
        start = time.perf_counter()
        frame(number)
        times.append(1000 * (time.perf_counter() - start))
    return statistics.median(times)


def row(what, ours, theirs, name):
    print("%-44s winnow %9.3f   %-8s %9.3f   x %.2f" % (what, ours, name, theirs, theirs / ours))


def box_frames(count, frames):
    """Unit boxes that all move, in a volume of two units per box: (frames, n, 6) float32."""
    random = np.random.default_rng(count)
    lower = random.uniform(0, (2 * count) ** (1 / 3), (count, 3))
    steps = random.normal(scale=0.05, size=(frames, count, 3)).cumsum(axis=0)
    return np.concatenate([lower + steps, lower + steps + 1], axis=2).astype(np.float32)


def box_pairs_of_a_tree(boxes):
    """Finds centres no farther apart on any axis than the largest box edge, then tests the boxes."""
    lower, upper = boxes[:, :3], boxes[:, 3:]
    pairs = cKDTree((lower + upper) / 2).query_pairs(
        (upper - lower).max() * 1.000001, p=np.inf, output_type="ndarray"
    )
    a, b = pairs.T
    overlaps = ((lower[a] <= upper[b]) & (lower[b] <= upper[a])).all(axis=1)
    return pairs[overlaps]


def neighbours_by_open3d(points, radius):
    """Returns for each point the points within the radius, itself included."""
    points = open3d.Tensor(points)
    search = open3d.nns.NearestNeighborSearch(points)
    search.fixed_radius_index(radius)
    return search.fixed_radius_search(points, radius)[0]


def race_tree(count=100_000, frames=12):
    boxes = box_frames(count, frames)
    partition = winnow.Partition("LinearBvh")
    keys = partition.insert(boxes[0, :, :3], boxes[0, :, 3:])
    partition.self_pairs()

    def move(number):
        partition.update(keys, boxes[number, :, :3], boxes[number, :, 3:])
        return partition.self_pairs()

    assert len(box_pairs_of_a_tree(boxes[1])) == len(move(1))
    row(
        "box pairs of 100,000 boxes",
        median_ms(move, range(1, frames)),
        median_ms(lambda number: box_pairs_of_a_tree(boxes[number]), range(1, 5)),
        "cKDTree",
    )
    points, radius = np.ascontiguousarray(boxes[:, :, :3]), 0.8
    balls = winnow.Partition("LinearBvh", volume="sphere")
    keys_of_balls = balls.insert_spheres(points[0], radius / 2)
    balls.self_pairs()

    def neighbours(number):
        balls.update_spheres(keys_of_balls, points[number], radius / 2)
        return balls.self_pairs()

    def neighbours_of_a_tree(number):
        return cKDTree(points[number]).query_pairs(radius, output_type="ndarray")

    assert abs(len(neighbours(1)) - len(neighbours_of_a_tree(1))) <= 4
    row(
        "neighbours of 100,000 points",
        median_ms(neighbours, range(1, frames)),
        median_ms(neighbours_of_a_tree, range(1, 5)),
        "cKDTree",
    )
    if open3d is None:
        print("open3d is not here (Debian: python3-open3d)")
    else:
        found = len(neighbours_by_open3d(points[1], radius)) - count
        assert abs(2 * len(neighbours(1)) - found) <= 8
        row(
            "neighbours of 100,000 points",
            median_ms(neighbours, range(1, frames)),
            median_ms(lambda number: neighbours_by_open3d(points[number], radius), range(1, 5)),
            "open3d",
        )
    row(
        "8 nearest of 100,000 points",
        median_ms(lambda number: balls.nearest(points[number], 8), range(1, 4)),
        median_ms(lambda number: cKDTree(points[number]).query(points[number], 8), range(1, 3)),
        "cKDTree",
    )


def in_cpp(program, kind, values, count):
    with tempfile.NamedTemporaryFile() as file:
        values.tofile(file)
        file.flush()
        out = subprocess.run(
            [program, kind, file.name, str(count)], check=True, capture_output=True, text=True
        ).stdout.split()
    return float(out[0]), int(out[1])


def boxes_in_python(values):
    partition = winnow.Partition("LinearBvh")
    keys = partition.insert(values[0, :, :3], values[0, :, 3:])
    partition.self_pairs()
    found = []

    def frame(number):
        found.clear()
        partition.update(keys, values[number, :, :3], values[number, :, 3:])
        found.append(partition.self_pairs())

    return median_ms(frame, range(1, len(values))), len(found[0])


def worlds_in_python(values):
    shapes = winnow.Shapes()
    scene = winnow.Scene(shapes)
    keys = scene.add(
        shapes.add_spheres(0.5), values[0], environment=np.arange(values.shape[1]) // 10
    )
    contacts = winnow.Contacts()
    scene.collide(contacts, "distance")

    def frame(number):
        scene.move(keys, values[number])
        scene.collide(contacts, "distance")

    return median_ms(frame, range(1, len(values))), len(contacts)


def race_cpp(program, rounds=5):
    """Races the Python package and C++ in turns, so that other load on the machine affects both alike."""
    random = np.random.default_rng(7)
    worlds = random.uniform(0, 3, (10_000, 3)) + random.normal(0, 0.02, (60, 10_000, 3))
    cases = [
        ("all of %d boxes move" % n, "boxes", box_frames(n, f), n, boxes_in_python)
        for n, f in ((10_000, 60), (100_000, 12))
    ]
    cases.append(("1,000 worlds of 10 balls", "worlds", worlds, 10_000, worlds_in_python))
    for what, kind, values, count, ours in cases:
        times = []
        for _ in range(rounds):
            python, found = ours(values)
            cpp, truth = in_cpp(program, kind, values, count)
            assert found == truth, (found, truth)
            times.append((python, cpp))
        row(what, *(min(t[k] for t in times) for k in (0, 1)), "C++")


if __name__ == "__main__":
    default = os.path.join(ROOT, "build", "ci", "bench", "python", "winnow_python_frames")
    program = sys.argv[1] if len(sys.argv) > 1 else default
    if cKDTree is None:
        print("scipy's cKDTree is not here (Debian: python3-scipy)")
    else:
        race_tree()
    race_cpp(program)
