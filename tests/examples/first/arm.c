/* A robot arm of capsules that checks itself: which links touch, except those that share a joint.
 */

#include <math.h>
#include <stdio.h>
#include <winnow/c/winnow.h>

enum { kLinks = 7 };

static winnow_pose poses[kLinks];

/* Places the links of a configuration; all joints turn about y. */
static void place(int configuration) {
  double x = 0.0, z = 0.0, angle = 0.0;
  for (int i = 0; i < kLinks; ++i) {
    angle += 2.5 * sin(0.37 * configuration * (i + 1));
    poses[i] = (winnow_pose)WINNOW_POSE;
    poses[i].position[0] = x + 0.5 * sin(angle);
    poses[i].position[2] = z + 0.5 * cos(angle);
    poses[i].orientation[0] = cos(0.5 * angle);
    poses[i].orientation[2] = sin(0.5 * angle);
    x += sin(angle);
    z += cos(angle);
  }
}

int main(void) {
  winnow_shape_pool* shapes = NULL;
  winnow_scene* scene = NULL;
  winnow_scene_queries* queries = NULL;
  winnow_shape_id link;
  winnow_key keys[kLinks];
  winnow_body_definition bodies[kLinks];
  const winnow_shape capsule = {WINNOW_SHAPE_CAPSULE, {.capsule = {0.1, 0.5}}};
  if (winnow_shape_pool_create(NULL, &shapes) != WINNOW_OK ||
      winnow_shape_pool_add(shapes, &capsule, &link) != WINNOW_OK ||
      winnow_scene_create(shapes, NULL, &scene) != WINNOW_OK ||
      winnow_scene_queries_create(scene, NULL, &queries) != WINNOW_OK) {
    return 1;
  }
  for (int i = 0; i < kLinks; ++i) {
    bodies[i] = (winnow_body_definition)WINNOW_BODY_DEFINITION;
    bodies[i].shape = link;
  }
  if (winnow_scene_add(scene, bodies, kLinks, keys) != WINNOW_OK) return 1;
  for (int i = 1; i < kLinks; ++i) {
    const winnow_key_pair neighbours = {keys[i - 1], keys[i]};
    if (winnow_scene_set_ignored(scene, &neighbours, 1, true) != WINNOW_OK) return 1;
  }

  const double* const position = poses[0].position;
  const double* const turn = poses[0].orientation;
  const winnow_pose_view view = {.position = {position, position + 1, position + 2},
                                 .orientation = {turn, turn + 1, turn + 2, turn + 3},
                                 .position_stride = sizeof poses[0],
                                 .orientation_stride = sizeof poses[0],
                                 .count = kLinks,
                                 .position_number = WINNOW_DOUBLE,
                                 .orientation_number = WINNOW_DOUBLE};
  int colliding = 0;
  for (int configuration = 0; configuration < 1000; ++configuration) {
    winnow_key_pair contact;
    place(configuration);
    if (winnow_scene_move(scene, keys, kLinks, &view) != WINNOW_OK ||
        winnow_scene_refresh(scene) != WINNOW_OK ||
        winnow_scene_queries_any_contact_in_scene(queries, 0.0, WINNOW_PAIR_RULES_SCENE,
                                                  &contact) != WINNOW_OK) {
      return 1;
    }
    if (contact.first.id != WINNOW_NO_OBJECT) ++colliding;
  }
  printf("%d of 1000 configurations collide\n", colliding);
  winnow_scene_queries_destroy(queries);
  winnow_scene_destroy(scene);
  winnow_shape_pool_destroy(shapes);
  return colliding > 0 && colliding < 1000 ? 0 : 1;
}
