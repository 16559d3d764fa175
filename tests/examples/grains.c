/* Spheres fall onto a floor and come to rest, in C. */

#include <stdio.h>
#include <winnow/c/winnow.h>

enum { kGrains = 100 };

int main(void) {
  const double step = 0.005;
  double height[kGrains], speed[kGrains] = {0}, x[kGrains], y[kGrains];
  winnow_key keys[kGrains + 1];
  winnow_body_definition bodies[kGrains + 1];
  winnow_shape_pool* shapes = NULL;
  winnow_scene* scene = NULL;
  winnow_contacts* contacts = NULL;
  winnow_shape_id grain, floor;
  const winnow_shape ball = {WINNOW_SHAPE_SPHERE, {.sphere = {0.25}}};
  const winnow_shape ground = {WINNOW_SHAPE_HALF_SPACE, {.half_space = {{0, 0, 1}, 0}}};
  winnow_shape_pool_create(NULL, &shapes);
  winnow_shape_pool_add(shapes, &ball, &grain);
  winnow_shape_pool_add(shapes, &ground, &floor);
  winnow_scene_create(shapes, NULL, &scene);  // NULL: as C++ has it by default
  winnow_contacts_create(NULL, &contacts);
  const winnow_body_definition none = WINNOW_BODY_DEFINITION;
  for (int i = 0; i <= kGrains; ++i) {
    bodies[i] = none;
    bodies[i].shape = i < kGrains ? grain : floor;
    if (i == kGrains) {
      bodies[i].state = WINNOW_BODY_STATE_FIXED;
    } else {
      x[i] = bodies[i].pose.position[0] = i % 10;
      y[i] = bodies[i].pose.position[1] = i / 10;
      height[i] = bodies[i].pose.position[2] = 1.0 + 0.01 * i;
    }
    bodies[i].data = (uint64_t)i;
  }
  if (winnow_scene_add(scene, bodies, kGrains + 1, keys) != WINNOW_OK) return 1;

  const winnow_pose_view poses = {
      {x, y, height}, {NULL, NULL, NULL, NULL}, 0, 0, kGrains, WINNOW_DOUBLE, WINNOW_DOUBLE};
  size_t resting = 0;
  for (int frame = 0; frame < 1000; ++frame) {
    // [in c]
    winnow_contact_columns c = {.size = sizeof c};
    winnow_scene_collide(scene, WINNOW_LEVEL_MANIFOLD, contacts);
    winnow_contacts_columns(contacts, &c);  // no copies: valid until the next collide
    for (size_t i = 0; i < c.pairs; ++i) {
      for (size_t m = c.manifold_first[i]; m < c.manifold_first[i + 1]; ++m) {
        const uint64_t body = c.data_a[i];  // a has the smaller ShapeKind: the sphere
        const double push = -1000.0 * c.distance[m] - 20.0 * speed[body];
        if (push > 0.0) speed[body] += push * step;
      }
    }
    // [end]
    for (int i = 0; i < kGrains; ++i) {
      speed[i] -= 9.81 * step;
      height[i] += speed[i] * step;
    }
    if (winnow_scene_move(scene, keys, kGrains, &poses) != WINNOW_OK) return 1;
    resting = c.pairs;
  }
  printf("%zu grains rest at %.2f\n", resting, height[0]);
  winnow_contacts_destroy(contacts);
  winnow_scene_destroy(scene);
  winnow_shape_pool_destroy(shapes);
  return 0;
}
