"""Lidar: the points that a rotating sensor measures above hills with boxes on them."""

import numpy as np
import winnow


def scan(columns=180, rows=16, seed=3):
    """Returns hit points (n, 3) and the client data of the bodies: 0 the ground, 1 a box."""
    random = np.random.default_rng(seed)
    x, y = np.meshgrid(np.arange(128), np.arange(128))
    heights = (np.sin(x / 9) + np.cos(y / 7)).astype(np.float32)
    shapes = winnow.Shapes()
    world = winnow.Scene(shapes)
    world.add(shapes.add_height_field(heights), [[-64, -64, 0]], "fixed", data=[0])
    boxes = np.column_stack([random.uniform(-40, 40, (60, 2)), np.full(60, 2.0)])
    world.add(shapes.add_boxes([1.0, 1.0, 2.0]), boxes, "fixed", data=np.ones(60, np.uint64))
    turn, tilt = np.meshgrid(
        np.linspace(-np.pi, np.pi, columns, endpoint=False), np.linspace(-0.4, 0.1, rows)
    )
    rays = np.stack(
        [np.cos(turn) * np.cos(tilt), np.sin(turn) * np.cos(tilt), np.sin(tilt)], axis=-1
    )
    directions = rays.reshape(-1, 3)
    hits = world.cast_rays(np.broadcast_to([0.0, 0.0, 6.0], directions.shape), directions, max_t=60)
    is_hit = hits.key != winnow.NULL_KEY
    return hits.point[is_hit], hits.data[is_hit]


if __name__ == "__main__":
    points, kinds = scan()
    print("%d points, %d of them on boxes" % (len(points), int(kinds.sum())))
