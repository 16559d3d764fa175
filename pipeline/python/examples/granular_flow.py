"""Granular flow: grains fall through a funnel of triangles, pushed apart by springs and dampers."""

import numpy as np
import winnow

RADIUS, STIFF, DAMP, STEP = 0.1, 2000.0, 10.0, 0.002


def funnel(sides=24):
    """Returns vertices and triangles of a cone that is open at both ends."""
    angle = np.linspace(0, 2 * np.pi, sides, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    low = np.column_stack([0.35 * ring, np.zeros(sides)])
    high = np.column_stack([2.5 * ring, np.full(sides, 2.0)])
    i = np.arange(sides)
    j = (i + 1) % sides
    corners = np.concatenate(
        [np.stack([i, j, i + sides], axis=1), np.stack([j, j + sides, i + sides], axis=1)]
    )
    return np.concatenate([low, high]), corners


def flow(grains=500, steps=300, seed=5):
    """Returns the number of grains that left the funnel and the last step's deepest contact."""
    random = np.random.default_rng(seed)
    shapes = winnow.Shapes()
    world = winnow.Scene(shapes)
    wall = world.add(shapes.add_mesh(*funnel()), [[0, 0, 0]], "fixed")
    place = np.column_stack([random.uniform(-1, 1, (grains, 2)), random.uniform(1.6, 4, grains)])
    speed = np.zeros((grains, 3))
    keys = world.add(shapes.add_spheres(RADIUS), place)
    number = np.full(max(winnow.ids_of(keys).max(), winnow.ids_of(wall).max()) + 1, grains)
    number[winnow.ids_of(keys)] = np.arange(grains)
    contacts = winnow.Contacts()
    depth = 0.0
    for _ in range(steps):
        world.collide(contacts, "distance")
        pairs = np.repeat(np.arange(len(contacts)), np.diff(contacts.manifold_first))
        a, b = (number[winnow.ids_of(keys)][pairs] for keys in (contacts.a, contacts.b))
        # The wall is one more grain, at rest.
        moving = np.vstack([speed, np.zeros(3)])
        closing = np.einsum("ij,ij->i", moving[a] - moving[b], contacts.normal)
        push = np.maximum(0, DAMP * closing - STIFF * contacts.distance)[:, None] * contacts.normal
        force = np.zeros_like(moving)
        np.add.at(force, a, -push)
        np.add.at(force, b, push)
        speed += STEP * (force[:-1] + [0, 0, -9.81])
        place = place + STEP * speed
        depth = -min(contacts.distance, default=0.0)
        world.move(keys, place)
    return int((place[:, 2] < 0).sum()), float(depth)


if __name__ == "__main__":
    print("%d grains have left the funnel; the deepest contact is %.3f" % flow(steps=1500))
