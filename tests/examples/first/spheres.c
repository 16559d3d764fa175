/* 20,000 spheres fall onto a floor; a penalty force pushes apart those that touch. */

#include <stdio.h>
#include <stdlib.h>
#include <winnow/c/winnow.h>

enum { kSpheres = 20000 };

static double position[3][kSpheres], velocity[3][kSpheres], force[3][kSpheres + 1];
static winnow_key keys[kSpheres + 1];
static winnow_body_definition bodies[kSpheres + 1];

static void push_apart(const winnow_contact_columns* c) {
  for (size_t i = 0; i < c->pairs; ++i) {
    for (size_t m = c->manifold_first[i]; m < c->manifold_first[i + 1]; ++m) {
      for (int k = 0; k < 3; ++k) {
        const double push = 5000.0 * c->distance[m] * c->normal[k][m];
        force[k][c->data_a[i]] += push;
        force[k][c->data_b[i]] -= push;
      }
    }
  }
}

int main(void) {
  const double step = 0.002;
  winnow_shape_pool* shapes = NULL;
  winnow_scene* scene = NULL;
  winnow_contacts* contacts = NULL;
  winnow_shape_id sphere, floor;
  const winnow_shape ball = {WINNOW_SHAPE_SPHERE, {.sphere = {0.5}}};
  const winnow_shape ground = {WINNOW_SHAPE_HALF_SPACE, {.half_space = {{0, 0, 1}, 0}}};
  if (winnow_shape_pool_create(NULL, &shapes) != WINNOW_OK ||
      winnow_shape_pool_add(shapes, &ball, &sphere) != WINNOW_OK ||
      winnow_shape_pool_add(shapes, &ground, &floor) != WINNOW_OK ||
      winnow_scene_create(shapes, NULL, &scene) != WINNOW_OK ||
      winnow_contacts_create(NULL, &contacts) != WINNOW_OK) {
    return 1;
  }

  /* The floor is body kSpheres of the arrays. */
  for (int i = 0; i <= kSpheres; ++i) {
    const winnow_body_definition body = WINNOW_BODY_DEFINITION;
    bodies[i] = body;
    bodies[i].shape = i < kSpheres ? sphere : floor;
    bodies[i].data = (uint64_t)i;
    if (i == kSpheres) break;
    position[0][i] = 0.9 * (i % 50);
    position[1][i] = 0.9 * (i / 50 % 50);
    position[2][i] = 0.45 + 0.9 * (i / 2500) + 1e-6 * i;
    for (int k = 0; k < 3; ++k) bodies[i].pose.position[k] = position[k][i];
  }
  bodies[kSpheres].state = WINNOW_BODY_STATE_FIXED;
  if (winnow_scene_add(scene, bodies, kSpheres + 1, keys) != WINNOW_OK) return 1;

  const winnow_pose_view poses = {.position = {position[0], position[1], position[2]},
                                  .count = kSpheres,
                                  .position_number = WINNOW_DOUBLE};
  winnow_contact_columns columns = {.size = sizeof columns};
  for (int frame = 0; frame < 20; ++frame) {
    if (winnow_scene_collide(scene, WINNOW_LEVEL_MANIFOLD, contacts) != WINNOW_OK ||
        winnow_contacts_columns(contacts, &columns) != WINNOW_OK) {
      return 1;
    }
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i <= kSpheres; ++i) force[k][i] = k == 2 ? -9.81 : 0.0;
    }
    push_apart(&columns);
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < kSpheres; ++i) {
        velocity[k][i] += step * force[k][i];
        position[k][i] += step * velocity[k][i];
      }
    }
    if (winnow_scene_move(scene, keys, kSpheres, &poses) != WINNOW_OK) return 1;
  }
  printf("%zu pairs touch\n", columns.pairs);
  const int is_good = columns.pairs > kSpheres;
  winnow_contacts_destroy(contacts);
  winnow_scene_destroy(scene);
  winnow_shape_pool_destroy(shapes);
  return is_good ? EXIT_SUCCESS : EXIT_FAILURE;
}
