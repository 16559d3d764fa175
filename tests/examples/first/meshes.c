/* Two meshes from OBJ files: rays, closest points, and their distance from each other. */

#include <stdio.h>
#include <stdlib.h>
#include <winnow/c/winnow.h>

enum { kMax = 100000 };

static float points[kMax][3];
static uint32_t corners[kMax][3];

static const char kPyramid[] =
    "v 1 1 0\nv -1 1 0\nv -1 -1 0\nv 1 -1 0\nv 0 0 2\n"
    "f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 1 3 2\nf 1 4 3\n";

/* Reads the vertices and the triangles of a Wavefront OBJ file. */
static void read_obj(FILE* file, size_t* vertices, size_t* triangles) {
  char line[256];
  while (fgets(line, sizeof line, file) != NULL && *vertices < kMax && *triangles < kMax) {
    float* const p = points[*vertices];
    uint32_t* const t = corners[*triangles];
    if (sscanf(line, "v %f %f %f", &p[0], &p[1], &p[2]) == 3) ++*vertices;
    if (sscanf(line, "f %u%*[^ ] %u%*[^ ] %u", &t[0], &t[1], &t[2]) == 3 ||
        sscanf(line, "f %u %u %u", &t[0], &t[1], &t[2]) == 3) {
      for (int k = 0; k < 3; ++k) --t[k];
      ++*triangles;
    }
  }
}

int main(int count, char** files) {
  FILE* file = count > 1 ? fopen(files[1], "r") : tmpfile();
  if (file == NULL) return 1;
  if (count <= 1) {
    fputs(kPyramid, file);
    rewind(file);
  }
  size_t vertices = 0, triangles = 0;
  read_obj(file, &vertices, &triangles);
  fclose(file);

  winnow_shape_pool* convex = NULL;
  winnow_composite_pool* meshes = NULL;
  winnow_scene* scene = NULL;
  winnow_scene_queries* queries = NULL;
  winnow_shape_id shape;
  winnow_key keys[2];
  const winnow_point_view vertex_view = {
      {&points[0][0], &points[0][1], &points[0][2]}, sizeof points[0], vertices, WINNOW_FLOAT};
  const winnow_index_view triangle_view = {corners, 0, triangles, WINNOW_UINT32};
  if (winnow_shape_pool_create(NULL, &convex) != WINNOW_OK ||
      winnow_composite_pool_create(convex, NULL, &meshes) != WINNOW_OK ||
      winnow_composite_pool_add_mesh(meshes, &vertex_view, &triangle_view, NULL, NULL, &shape) !=
          WINNOW_OK ||
      winnow_composite_pool_set_solid(meshes, shape, true) != WINNOW_OK) {
    return 1;
  }
  winnow_scene_options options = {.size = sizeof options, .composites = meshes};
  winnow_body_definition bodies[2] = {WINNOW_BODY_DEFINITION, WINNOW_BODY_DEFINITION};
  bodies[0].shape = bodies[1].shape = shape;
  bodies[1].pose.position[0] = 5.0;
  if (winnow_scene_create(convex, &options, &scene) != WINNOW_OK ||
      winnow_scene_add(scene, bodies, 2, keys) != WINNOW_OK ||
      winnow_scene_refresh(scene) != WINNOW_OK ||
      winnow_scene_queries_create(scene, NULL, &queries) != WINNOW_OK) {
    return 1;
  }

  winnow_shape_ray ray = WINNOW_SHAPE_RAY;
  ray.origin[0] = 0.1;
  ray.origin[1] = 0.2;
  ray.origin[2] = 9.0;
  ray.direction[0] = 0.0;
  ray.direction[2] = -1.0;
  const double point[3] = {0.0, 0.0, 0.5};
  winnow_scene_hit hit;
  winnow_scene_distance apart;
  const winnow_scene_distance* near = NULL;
  size_t found = 0;
  if (winnow_scene_queries_closest(queries, &ray, NULL, &hit) != WINNOW_OK) return 1;
  printf("the ray hits triangle %u at height %.3f\n", hit.part, hit.point[2]);
  if (winnow_scene_queries_nearest(queries, point, 1, 10.0, NULL, &near, &found) != WINNOW_OK)
    return 1;
  if (found > 0) printf("the point is %.3f from a surface\n", near[0].distance);
  if (winnow_scene_queries_distance(queries, keys[0], keys[1], 100.0, WINNOW_PAIR_RULES_NONE,
                                    &apart) != WINNOW_OK) {
    return 1;
  }
  printf("the meshes are %.3f apart\n", apart.distance);
  winnow_scene_queries_destroy(queries);
  winnow_scene_destroy(scene);
  winnow_composite_pool_destroy(meshes);
  winnow_shape_pool_destroy(convex);
  return found == 1 ? EXIT_SUCCESS : EXIT_FAILURE;
}
