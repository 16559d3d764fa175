#pragma once

/* Helpers of the C scenarios. */

#include "tests/c/trace.h"

#include <stdlib.h>
#include <winnow/c/winnow.h>

/* Notes the status of a call that fails. */
#define OK(call)                                                       \
  do {                                                                 \
    const winnow_status status_ = (call);                              \
    if (status_ != WINNOW_OK) note(t, #call, (uint64_t)status_ << 32); \
  } while (0)

/* Memory that counts the bytes in use. */
static inline void* counted_allocate(void* context, size_t bytes, size_t alignment) {
  unsigned char* const whole = (unsigned char*)malloc(bytes + alignment + sizeof(void*));
  if (whole == NULL) return NULL;
  *(size_t*)context += bytes;
  const uintptr_t least = (uintptr_t)whole + sizeof(void*) + alignment - 1;
  unsigned char* const block = whole + (least / alignment * alignment - (uintptr_t)whole);
  memcpy(block - sizeof(void*), &whole, sizeof(void*));
  return block;
}

static inline void counted_deallocate(void* context, void* block, size_t bytes, size_t alignment) {
  void* whole;
  (void)alignment;
  *(size_t*)context -= bytes;
  memcpy(&whole, (unsigned char*)block - sizeof(void*), sizeof(void*));
  free(whole);
}

static inline winnow_memory counted_in(size_t* outstanding) {
  const winnow_memory memory = {counted_allocate, counted_deallocate, outstanding};
  return memory;
}

static inline size_t reserved_of(const winnow_footprint* f) {
  return f->bounds.reserved + f->keys.reserved + f->client_data.reserved + f->structure.reserved +
         f->scratch.reserved + f->results.reserved;
}
