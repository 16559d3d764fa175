"""Arguments: one entry for all, and errors that name the argument and the row."""

import numpy as np
import pytest
import winnow
from test_hostile import refused
from worlds import random_boxes

N = 5
RANDOM = np.random.default_rng(61)
POINTS = RANDOM.uniform(0, 6, (N, 3))
AHEAD = RANDOM.normal(size=(N, 3))
LENGTHS = RANDOM.uniform(0.5, 2, N)
POSES = np.hstack([POINTS, RANDOM.normal(size=(N, 4))])
NUMBERS = np.arange(N, dtype=np.uint64)


class World:
    """Returns objects to call."""

    def __init__(self):
        lower, upper = random_boxes(62, 200)
        self.boxes = winnow.Partition()
        self.keys = self.boxes.insert(lower, upper)[:N]
        self.balls = winnow.Partition(volume="sphere")
        self.shapes = winnow.Shapes()
        self.ids = self.shapes.add_spheres(LENGTHS)
        self.scene = winnow.Scene(self.shapes)
        self.bodies = self.scene.add(self.ids, POSES, data=NUMBERS)

    def inserted(self, lower, upper, data=None):
        keys = self.boxes.insert(lower, upper, data)
        return self.boxes.bounds(keys), self.boxes.client_data(keys)

    def balls_inserted(self, centers, radii):
        return self.balls.bounds(self.balls.insert_spheres(centers, radii))

    def shaped(self, add, *arguments):
        ids = getattr(self.shapes, add)(*arguments)
        return self.shapes.bounds(ids, np.zeros((len(ids), 3)))

    def added(self, shapes, poses, **options):
        return self.scene.bodies(self.scene.add(shapes, poses, **options))

    def moved(self, poses):
        self.scene.move(self.bodies, poses)
        return self.scene.bodies(self.bodies)["pose"]

    def filtered(self, **filters):
        self.scene.set_filter(self.bodies, **filters)
        self.boxes.set_filter(self.keys, **filters)
        return self.scene.bodies(self.bodies), self.boxes.filters(self.keys)

    def offset(self, contact, rest):
        self.scene.set_offsets(self.bodies, contact, rest)
        return self.scene.bodies(self.bodies)["contact"]

    def sensed(self, shapes, poses, **options):
        sensors = winnow.Sensors(self.scene)
        sensors.add(shapes, poses, **options)
        return sensors.sense().body_data


RAYS = {"origins": POINTS, "directions": AHEAD, "max_t": 9 * LENGTHS}
FILTERS = {"layers": NUMBERS + 1, "mask": NUMBERS + 1, "environment": NUMBERS}
TURNS = np.broadcast_to(np.eye(3), (N, 3, 3))
MOTIONS = winnow.motions_between(POSES, POSES + [1, 2, 3, 0, 0, 0, 0])

# Calls with one row for each of N entries.
CALLS = [
    (World.inserted, {"lower": POINTS, "upper": POINTS + 9, "data": NUMBERS}),
    (World.balls_inserted, {"centers": POINTS, "radii": LENGTHS}),
    (lambda w, **a: w.boxes.cast_rays(**a), {**RAYS, "min_t": LENGTHS / 9}),
    (lambda w, **a: w.boxes.cast_rays(find="all", **a), RAYS),
    (lambda w, **a: w.boxes.cast_boxes(**a),
     {"lower": POINTS, "upper": POINTS + 9, "directions": AHEAD, "max_t": LENGTHS}),
    (lambda w, **a: w.boxes.cast_spheres(**a), {"centers": POINTS, "radii": LENGTHS, "directions": AHEAD}),
    (lambda w, **a: w.boxes.cast_capsules(**a),
     {"a": POINTS, "b": POINTS + 1, "radii": LENGTHS, "directions": AHEAD}),
    (lambda w, **a: w.boxes.overlap_boxes(order="canonical", **a), {"lower": POINTS, "upper": POINTS + 9}),
    (lambda w, **a: w.boxes.overlap_points(**a), {"points": POINTS}),
    (lambda w, **a: w.boxes.overlap_spheres(order="canonical", **a), {"centers": POINTS, "radii": LENGTHS}),
    (lambda w, **a: w.boxes.overlap_capsules(order="canonical", **a),
     {"a": POINTS, "b": POINTS + 1, "radii": LENGTHS}),
    (lambda w, **a: w.boxes.overlap_oriented_boxes(order="canonical", **a),
     {"centers": POINTS, "half": POINTS, "axes": TURNS}),
    (lambda w, **a: w.boxes.nearest(count=3, **a), {"lower": POINTS, "radius": LENGTHS}),
    (lambda w, **a: w.boxes.contains(**a), {"keys": NUMBERS}),
    (lambda w, **a: w.boxes.client_data_of(**a), {"ids": NUMBERS}),
    (lambda w, **a: winnow.outward(**a), {"lower": POINTS, "upper": POINTS + 9, "origin": POINTS}),
    (lambda w, **a: winnow.perspective(**a, vertical_fov=1, aspect=1, near=1, far=9),
     {"eye": POINTS, "forward": AHEAD, "up": POINTS}),
    (lambda w, **a: w.shaped("add_spheres", *a.values()), {"radius": LENGTHS}),
    (lambda w, **a: w.shaped("add_capsules", *a.values()), {"radius": LENGTHS, "half": LENGTHS}),
    (lambda w, **a: w.shaped("add_boxes", *a.values()), {"half": POINTS, "rounding": LENGTHS}),
    (lambda w, **a: w.shaped("add_cylinders", *a.values()),
     {"radius": LENGTHS, "half": LENGTHS, "rounding": LENGTHS}),
    (lambda w, **a: w.shapes.cast_rays(w.ids[:1], **a), {"poses": POSES, **RAYS}),
    (World.added, {"shapes": NUMBERS, "poses": POSES, "data": NUMBERS, "contact": LENGTHS,
                   "rest": LENGTHS / 2, "layer": NUMBERS, **FILTERS}),
    (World.moved, {"poses": POSES + 1}),
    (World.filtered, FILTERS),
    (World.offset, {"contact": LENGTHS, "rest": LENGTHS / 2}),
    (World.sensed, {"shapes": NUMBERS, "poses": POSES, "data": NUMBERS}),
    (lambda w, **a: w.scene.cast_rays(**a), RAYS),
    (lambda w, **a: w.scene.cast_shapes(**a),
     {"shapes": NUMBERS, "poses": POSES, "directions": AHEAD, "max_t": LENGTHS}),
    (lambda w, **a: w.scene.cast_motions(**a), {"shapes": NUMBERS, "motions": MOTIONS}),
    (lambda w, **a: w.scene.overlap(**a), {"shapes": NUMBERS, "poses": POSES}),
    (lambda w, **a: w.scene.nearest(count=2, **a), {"points": POINTS, "radius": 9 * LENGTHS}),
    (lambda w, **a: w.scene.distance(w.bodies[NUMBERS[a["a"]]], w.bodies[a["b"]]), {"a": NUMBERS, "b": NUMBERS[::-1]}),
    (lambda w, **a: winnow.motions_between(**a), {"start": POSES, "end": POSES[::-1]}),
    (lambda w, **a: winnow.motions_by_velocities(**a),
     {"poses": POSES, "linear": POINTS, "angular": AHEAD, "duration": LENGTHS}),
    (lambda w, **a: winnow.poses_at(**a), {"motions": MOTIONS, "times": LENGTHS / 9}),
    (lambda w, **a: w.scene.find_impacts(w.bodies, **a), {"ends": POSES, "bullets": NUMBERS > 2}),
]  # fmt: skip


def columns(result):
    """Yields the arrays of a result; keys without their stamps, which differ from world to world."""
    if isinstance(result, np.ndarray):
        yield result & np.uint64(0xFFFFFFFF) if result.dtype == np.uint64 else result
    else:
        fields = result if isinstance(result, (dict, tuple)) else vars(result)
        for value in fields.values() if isinstance(fields, dict) else fields:
            yield from columns(value)


@pytest.mark.parametrize("number", range(len(CALLS)))
def test_one_entry_stands_for_all(number):
    call, arguments = CALLS[number]
    count = 1 if len(arguments) == 1 and call is not World.moved else N
    for name, rows in arguments.items():
        one = call(World(), **{**arguments, name: rows[0]})
        many = call(World(), **{**arguments, name: np.repeat(rows[:1], count, axis=0)})
        compared = list(zip(columns(one), columns(many)))
        assert compared, name
        assert all(np.array_equal(a, b, equal_nan=True) for a, b in compared), name


def bad(rows, row, value):
    """Returns a copy with another value in one row."""
    changed = np.array(rows, float)
    changed[row] = value
    return changed


ZERO_TURN = np.array([0, 0, 0, 0, 0, 0, 0])
TRIANGLES = [[0, 1, 2], [0, 2, 3], [0, 1, 9]]

# Status, text of the message, and a call.
ERRORS = [
    ("invalid_pose", "poses[3] has a NaN", lambda w: w.moved(bad(POSES, 3, np.nan))),
    ("invalid_pose", "poses[2] is not finite", lambda w: w.moved(bad(POSES, 2, np.inf))),
    ("invalid_pose", "poses[4] has a quaternion of zeros", lambda w: w.moved(bad(POSES, 4, ZERO_TURN))),
    ("invalid_pose", "poses has a NaN", lambda w: w.moved([np.nan, 0, 0])),
    ("invalid_pose", "poses[1] has a NaN", lambda w: w.added(w.ids, bad(POSES, 1, np.nan))),
    ("invalid_pose", "poses[1] has a NaN", lambda w: w.sensed(w.ids, bad(POSES, 1, np.nan))),
    ("invalid_pose", "ends[4] has a NaN", lambda w: w.scene.find_impacts(w.bodies, bad(POSES, 4, np.nan))),
    ("invalid_pose", "motions[2] has a NaN", lambda w: winnow.poses_at(bad(MOTIONS, 2, np.nan), 0)),
    ("invalid_bounds", "lower[2] has a NaN", lambda w: w.boxes.insert(bad(POINTS, 2, np.nan), POINTS + 9)),
    ("invalid_bounds", "upper[3] has a NaN", lambda w: w.boxes.insert(POINTS, bad(POINTS, 3, np.nan) + 9)),
    ("invalid_bounds", "lower[1] is above upper[1]", lambda w: w.boxes.insert(POINTS, bad(POINTS, 1, -9))),
    ("invalid_bounds", "radii[2] is negative", lambda w: w.balls.insert_spheres(POINTS, bad(LENGTHS, 2, -1))),
    ("invalid_bounds", "lower[0] is above upper[0]", lambda w: w.boxes.update(w.keys, POINTS, POINTS - 1)),
    ("invalid_argument", "directions[2] is zero", lambda w: w.boxes.cast_rays(POINTS, bad(AHEAD, 2, 0))),
    ("invalid_argument", "directions[1] is zero", lambda w: w.scene.cast_rays(POINTS, bad(AHEAD, 1, 0))),
    ("invalid_argument", "origins[3] has a NaN", lambda w: w.boxes.cast_rays(bad(POINTS, 3, np.nan), AHEAD)),
    ("invalid_argument", "radii[4] is negative", lambda w: w.boxes.overlap_spheres(POINTS, bad(LENGTHS, 4, -1))),
    ("invalid_argument", "times[1] is not in [0, 1]", lambda w: winnow.poses_at(MOTIONS, bad(LENGTHS, 1, 3) / 2)),
    ("invalid_argument", "forward[1] is zero",
     lambda w: winnow.perspective(POINTS, bad(AHEAD, 1, 0), [0, 0, 1], 1, 1, 1, 9)),
    ("invalid_argument", "contact[2] is negative", lambda w: w.offset(bad(LENGTHS, 2, -1), -2)),
    ("invalid_argument", "state[1] is out of range", lambda w: w.added(w.ids, POSES, state=[0, 9, 0, 0, 0])),
    ("invalid_argument", "entries[1] is not below 5",
     lambda w: w.boxes.update(w.keys, POINTS, POINTS + 1, entries=[0, 7])),
    ("invalid_argument", "entries[1] is out of range",
     lambda w: w.boxes.update(w.keys, POINTS, POINTS + 1, entries=[0, -7])),
    ("invalid_argument", "pairs[1] is not below 5",
     lambda w: winnow.NarrowPhase().collide(w.shapes, w.ids, POSES, [[0, 1], [2, 5]])),
    ("invalid_argument", "contact_margin[1] is negative",
     lambda w: winnow.NarrowPhase().collide(w.shapes, w.ids, POSES, [[0, 1], [2, 3]], contact_margin=[0, -1])),
    ("invalid_shape", "radius[3] is negative", lambda w: w.shapes.add_spheres(bad(LENGTHS, 3, -1))),
    ("invalid_shape", "half[1] is not finite", lambda w: w.shapes.add_boxes(bad(POINTS, 1, np.inf))),
    ("invalid_shape", "vertices[2] has a NaN", lambda w: w.shapes.add_mesh(bad(POINTS, 2, np.nan), TRIANGLES[:2])),
    ("invalid_key", "shapes[1] is of no shape: 99", lambda w: w.added([0, 99, 1, 2, 3], POSES)),
    ("invalid_key", "shape_of[1] is of no shape: 99",
     lambda w: winnow.time_of_impact(w.shapes, [0, 99, 1, 2, 3], MOTIONS, [[0, 1]])),
    ("invalid_key", "keys[2] is NULL_KEY", lambda w: w.boxes.remove(np.append(w.keys[:2], np.uint64(winnow.NULL_KEY)))),
    ("invalid_key", "keys[5] is the same as keys[1]", lambda w: w.boxes.remove(np.append(w.keys, w.keys[1]))),
    ("invalid_key", "keys[1] is of no object", lambda w: w.boxes.bounds([w.keys[0], np.uint64(2**63)])),
    ("invalid_key", "keys[0] is of no object", lambda w: w.scene.move(w.keys, POSES)),
    ("invalid_key", "b[0] is of no object", lambda w: w.scene.distance(w.bodies, w.keys)),
    ("size_mismatch", "lower: expected shape (n, 3) or (3,), not (5, 4)",
     lambda w: w.boxes.insert(np.zeros((5, 4)), POINTS)),
    ("size_mismatch", "poses: expected shape (n, 3) or (3,), not (5, 4)", lambda w: w.moved(np.zeros((5, 4)))),
    ("size_mismatch", "radii: expected shape (n,) or (), not (5, 1)",
     lambda w: w.boxes.overlap_spheres(POINTS, LENGTHS[:, None])),
    ("size_mismatch", "pairs: expected shape (n, 2) or (2,), not (1, 3)",
     lambda w: w.scene.set_ignored(np.ones((1, 3), np.uint64))),
    ("size_mismatch", "upper: expected 5 entries, not 4", lambda w: w.boxes.insert(POINTS, POINTS[1:])),
    ("size_mismatch", "lower: expected 5 entries, not 4", lambda w: w.boxes.update(w.keys, POINTS[1:], POINTS[1:])),
    ("size_mismatch", "layers: expected 5 entries, not 4", lambda w: w.filtered(layers=NUMBERS[1:])),
    ("size_mismatch", "data: expected 5 entries, not 2", lambda w: w.inserted(POINTS, POINTS + 1, [1, 2])),
]  # fmt: skip


@pytest.mark.parametrize("status, text, call", ERRORS, ids=lambda x: x if isinstance(x, str) else "")
def test_errors_name_the_argument_and_the_row(status, text, call):
    world = World()
    assert refused(status, call, world).startswith(f"{status}: {text}")
    assert len(world.scene) == N and len(world.boxes) == 200


TYPES = [
    ("lower: expected numbers in float or double, not complex128", np.zeros((N, 3), complex)),
    ("lower: expected numbers in float or double, not <U1", [["a", "b", "c"]]),
    ("lower: not an array of numbers", [[1], [2, 3]]),
]


@pytest.mark.parametrize("text, lower", TYPES, ids=lambda x: x if isinstance(x, str) else "")
def test_wrong_types_are_named_with_the_argument(text, lower):
    with pytest.raises(TypeError) as caught:
        World().boxes.insert(lower, POINTS)
    assert str(caught.value) == text
    with pytest.raises(TypeError, match="keys: expected whole numbers, not float64"):
        World().boxes.remove(LENGTHS)


def test_margins_of_pairs_may_differ():
    shapes = winnow.Shapes()
    balls = shapes.add_spheres([0.5, 0.5, 0.5])
    found = winnow.NarrowPhase().collide(
        shapes, balls, [[0, 0, 0], [1.5, 0, 0], [0, 1.5, 0]], [[0, 1], [0, 2]], contact_margin=[0.1, 1.0]
    )
    assert dict(zip(found.pair.tolist(), found.contact_count.tolist())) == {0: 0, 1: 1}


def test_filter_may_be_none():
    world = World()
    hits = world.boxes.cast_rays(POINTS, AHEAD, filter=None)
    assert np.array_equal(hits.key, world.boxes.cast_rays(POINTS, AHEAD).key.tolist())
