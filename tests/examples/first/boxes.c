/* Boxes in the program's own columns: pairs that begin and end from frame to frame. */

#include <math.h>
#include <stdio.h>
#include <winnow/c/winnow.h>

enum { kBoxes = 10000 };

static float low[3][kBoxes], high[3][kBoxes];
static winnow_key keys[kBoxes];

static void move_to(float time) {
  for (int i = 0; i < kBoxes; ++i) {
    low[0][i] = 100.0F * sinf(0.7F * (float)i + time);
    low[1][i] = 100.0F * cosf(1.3F * (float)i + 0.5F * time);
    for (int k = 0; k < 3; ++k) high[k][i] = low[k][i] + 1.0F;
  }
}

int main(void) {
  winnow_partition* partition = NULL;
  winnow_pair_buffer* pairs = NULL;
  winnow_pair_events* events = NULL;
  const winnow_structure_kind structure = {.structure = WINNOW_LINEAR_BVH};
  const winnow_box_view boxes = {.min = {low[0], low[1], low[2]},
                                 .max = {high[0], high[1], high[2]},
                                 .count = kBoxes,
                                 .number = WINNOW_FLOAT};
  move_to(0.0F);
  if (winnow_partition_create(structure, NULL, &partition) != WINNOW_OK ||
      winnow_partition_insert(partition, &boxes, NULL, keys) != WINNOW_OK ||
      winnow_pair_buffer_create(NULL, &pairs) != WINNOW_OK ||
      winnow_pair_events_create(NULL, &events) != WINNOW_OK) {
    return 1;
  }
  size_t count = 0, begun = 0, ended = 0, changed = 0;
  const winnow_pair* all = NULL;
  const winnow_key_pair* some = NULL;
  for (int frame = 1; frame <= 10; ++frame) {
    move_to(0.01F * (float)frame);
    if (winnow_partition_update(partition, keys, kBoxes, &boxes, NULL) != WINNOW_OK ||
        winnow_partition_self_pairs(partition, pairs, events, NULL) != WINNOW_OK ||
        winnow_pair_buffer_pairs(pairs, &all, &count) != WINNOW_OK ||
        winnow_pair_events_begun(events, &some, &changed) != WINNOW_OK) {
      return 1;
    }
    begun += changed;
    if (winnow_pair_events_ended(events, &some, &changed) != WINNOW_OK) return 1;
    ended += changed;
  }
  printf("%zu pairs; %zu began, %zu ended\n", count, begun, ended);
  winnow_pair_events_destroy(events);
  winnow_pair_buffer_destroy(pairs);
  winnow_partition_destroy(partition);
  return begun - ended == count && ended > 0 ? 0 : 1;
}
