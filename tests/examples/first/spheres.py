"""20,000 spheres fall onto a floor; a penalty force pushes apart those that touch."""

import numpy as np
import winnow

SPHERES, STEP = 20000, 0.002

i = np.arange(SPHERES)
position = 0.9 * np.stack([i % 50, i // 50 % 50, 0.5 + i // 2500], axis=1).astype(float)
velocity = np.zeros((SPHERES, 3))

shapes = winnow.Shapes()
scene = winnow.Scene(shapes)
keys = scene.add(shapes.add_spheres(0.5), position, data=i)
scene.add(shapes.add_half_spaces([0, 0, 1]), [0, 0, 0], "fixed", data=SPHERES)

contacts = winnow.Contacts()
for _ in range(20):
    scene.collide(contacts)
    push = 5000 * contacts.distance[:, None] * contacts.normal
    force = np.full((SPHERES + 1, 3), [0, 0, -9.81])
    np.add.at(force, contacts.data_a.astype(int), push)
    np.subtract.at(force, contacts.data_b.astype(int), push)
    velocity += STEP * force[:-1]
    position += STEP * velocity
    scene.move(keys, position)

print(len(contacts), "pairs touch")
assert len(contacts) > SPHERES
