#pragma once

/* Records the results of a scenario in one language, to compare them with the other language. */

#include <stdint.h>
#include <string.h>

typedef struct trace {
  void* context;
  void (*note)(void* context, const char* what, uint64_t value);
} trace;

static inline void note(const trace* t, const char* what, uint64_t value) {
  t->note(t->context, what, value);
}

static inline void note_real(const trace* t, const char* what, double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  note(t, what, bits);
}

static inline void note_reals(const trace* t, const char* what, const double* values, int count) {
  for (int i = 0; i < count; ++i) note_real(t, what, values[i]);
}

#ifdef __cplusplus
extern "C" {
#endif

/* The scenarios in C. A call that fails is noted by its own text. */
void run_partitions_in_c(const trace* t);
void run_volumes_in_c(const trace* t);
void run_shapes_in_c(const trace* t);
void run_narrow_phase_in_c(const trace* t);
void run_scenes_in_c(const trace* t);
void run_watchers_in_c(const trace* t);
void run_impacts_in_c(const trace* t);

#ifdef __cplusplus
}
#endif
