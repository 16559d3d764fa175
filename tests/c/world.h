#pragma once

/* Objects that both languages put into their worlds. */

#include <stddef.h>
#include <stdint.h>

enum { kObjects = 200, kSpheres = 60, kBodies = 40 };

/* Writes the lower corner, then the upper corner. */
static inline void box_of(size_t i, size_t frame, double box[6]) {
  const size_t place[3] = {i * 37 % 31, i * 17 % 29, i * 11 % 23};
  for (size_t axis = 0; axis < 3; ++axis) {
    box[axis] = 0.7 * (double)place[axis] + 0.1 * (double)(frame * (i % 3));
    box[3 + axis] = box[axis] + 1.0 + 0.3 * (double)(i % 5);
  }
}

static inline uint64_t data_of(size_t i) {
  return 1000 + 3 * (uint64_t)i;
}

/* Writes a position above the ground and an orientation. */
static inline void pose_of(size_t i, size_t frame, double position[3], double orientation[4]) {
  position[0] = 1.1 * (double)(i % 8);
  position[1] = 1.1 * (double)(i / 8);
  position[2] = 0.45 + 0.1 * (double)(i % 4) - 0.05 * (double)frame;
  orientation[0] = 1.0;
  orientation[1] = 0.1 * (double)(i % 3);
  orientation[2] = 0.05 * (double)(i % 5);
  orientation[3] = 0.2 * (double)(i % 7);
}
