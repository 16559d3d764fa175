"""Two meshes from OBJ files: rays, closest points, and their distance from each other."""

import sys

import numpy as np
import winnow

PYRAMID = """v 1 1 0\nv -1 1 0\nv -1 -1 0\nv 1 -1 0\nv 0 0 2
f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 1 3 2\nf 1 4 3\n"""


def read_obj(text):
    """Returns the vertices and the triangles of a Wavefront OBJ file."""
    lines = [line.split() for line in text.splitlines() if line]
    points = [line[1:4] for line in lines if line[0] == "v"]
    corners = [[word.split("/")[0] for word in line[1:4]] for line in lines if line[0] == "f"]
    return np.array(points, np.float32), np.array(corners, np.uint32) - 1


points, corners = read_obj(open(sys.argv[1]).read() if len(sys.argv) > 1 else PYRAMID)
shapes = winnow.Shapes()
mesh = shapes.add_mesh(points, corners)
shapes.set_solid(mesh)
scene = winnow.Scene(shapes)
near, far = scene.add(mesh, [[0, 0, 0], [5, 0, 0]])

hit = scene.cast_rays([0.1, 0.2, 9], [0, 0, -1])
print("the ray hits triangle %d at height %.3f" % (hit.part[0], hit.point[0, 2]))
closest = scene.nearest([0, 0, 0.5], radius=10.0)
print("the point is %.3f from a surface" % closest.distance[0])
apart = scene.distance([near], [far], rules="none")
print("the meshes are %.3f apart" % apart.distance[0])
assert apart.distance[0] == winnow.mesh_distance(points, corners, points, corners, [0, 0, 0], [5, 0, 0]).distance[0]
