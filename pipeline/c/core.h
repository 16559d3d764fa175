#pragma once

/// Types shared by all C headers: status, version, memory, threads, keys and filters.

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define WINNOW_C_API __attribute__((visibility("default")))
#else
#define WINNOW_C_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/// Version of winnow that this header belongs to.
#define WINNOW_VERSION_MAJOR 0
#define WINNOW_VERSION_MINOR 1
#define WINNOW_VERSION_PATCH 0
/// Number of the binary interface, also part of the shared library's name; see README.md here.
#define WINNOW_ABI 1

/// Result of a call. A call that does not return WINNOW_OK has changed nothing, except that it may
/// have emptied its result buffer.
typedef int32_t winnow_status;
enum {
  WINNOW_OK = 0,
  WINNOW_INVALID_BOUNDS = 1,
  WINNOW_INVALID_KEY = 2,
  /// Also for a null pointer that is not allowed, an invalid kind or choice, or a wrong `size`.
  WINNOW_INVALID_ARGUMENT = 3,
  WINNOW_SIZE_MISMATCH = 4,
  WINNOW_OUT_OF_MEMORY = 5,
  WINNOW_TOO_MANY_OBJECTS = 6,
  WINNOW_UNSUPPORTED_VOLUME = 7,
  WINNOW_INVALID_SHAPE = 8,
  WINNOW_INVALID_POSE = 9,
  WINNOW_UNSUPPORTED = 10,
  WINNOW_COMMUNICATION_FAILED = 11
};

/// Returns the name of a status: "ok", "invalid_bounds", ... Never null.
WINNOW_C_API const char* winnow_status_name(winnow_status status);

/// Return the version of the loaded library: major << 16 | minor << 8 | patch, and as text.
WINNOW_C_API uint32_t winnow_version(void);
WINNOW_C_API const char* winnow_version_name(void);
/// Returns WINNOW_ABI of the loaded library. If it differs from the header's WINNOW_ABI, the
/// library cannot be used with this header.
WINNOW_C_API uint32_t winnow_abi(void);

/// Returns the name of the instruction set in use: "sse42", "avx2", "avx512" or "neon64".
WINNOW_C_API const char* winnow_isa_name(void);
/// Returns the name of instruction set i that this machine can run, narrowest first; null if i is
/// out of range.
WINNOW_C_API const char* winnow_available_isa(size_t i);
/// Selects the instruction set for the whole process.
WINNOW_C_API winnow_status winnow_set_isa(const char* name);

/// Source of memory. `allocate` returns null on failure; `deallocate` is called with the bytes and
/// the alignment (a power of two) of the allocation. If a call is given a null pointer to this
/// struct, large blocks use pages of 2 MB where the system has them, and other blocks use `new`.
/// The struct is copied; the context must outlive everything created with it.
typedef struct winnow_memory {
  void* (*allocate)(void* context, size_t bytes, size_t alignment);
  void (*deallocate)(void* context, void* block, size_t bytes, size_t alignment);
  void* context;
} winnow_memory;

/// Whether reserved memory is also written to, so that its pages are present before first use.
typedef int32_t winnow_pages;
enum { WINNOW_PAGES_UNTOUCHED = 0, WINNOW_PAGES_TOUCHED = 1 };

/// Job system of the host program; see JobSystem in <winnow/core/execution.h> for the requirements.
typedef struct winnow_job_system {
  void (*parallel_for)(void* context, size_t count, void (*task)(void* tasks, size_t i),
                       void* tasks);
  void* context;
  size_t threads;
} winnow_job_system;

typedef struct winnow_execution {
  int32_t kind;
  winnow_job_system jobs;  ///< used if `kind` is WINNOW_EXECUTION_ON
} winnow_execution;
enum {
  WINNOW_EXECUTION_DEFAULT = 0,  ///< C++ default: parallel (narrow phase, impacts: serial)
  WINNOW_EXECUTION_SERIAL = 1,
  WINNOW_EXECUTION_ON = 2,       ///< the host's job system `jobs`
  WINNOW_EXECUTION_PARALLEL = 3  ///< all processors, with oneTBB
};

/// A number of oneTBB threads from 1 to 4096, including the calling thread. They are started by the
/// first call that uses them, and shared by everything created with them.
typedef struct winnow_threads winnow_threads;
/// Returns WINNOW_UNSUPPORTED if count > 1 and the library was built without oneTBB.
WINNOW_C_API winnow_status winnow_threads_create(size_t count, winnow_threads** threads);
/// Destroy everything that was created with the threads first.
WINNOW_C_API void winnow_threads_destroy(winnow_threads* threads);
WINNOW_C_API winnow_status winnow_threads_execution(const winnow_threads* threads,
                                                    winnow_execution* execution);

/// Bytes of one purpose: in use, and allocated.
typedef struct winnow_bytes {
  size_t used;
  size_t reserved;
} winnow_bytes;

/// Memory of an object, by purpose. The sum of `reserved` equals the bytes that the object has
/// allocated from its winnow_memory. The object behind a handle such as winnow_partition* counts as
/// `structure`.
typedef struct winnow_footprint {
  size_t size;  ///< set by the caller to sizeof(winnow_footprint)
  winnow_bytes bounds;
  winnow_bytes keys;
  winnow_bytes client_data;
  winnow_bytes structure;
  winnow_bytes scratch;
  winnow_bytes results;
} winnow_footprint;

/// Key of an object of a partition, or of a body of a scene. Calls return WINNOW_INVALID_KEY for
/// the key of a removed object, and for a key of another partition or scene.
typedef struct winnow_key {
  uint32_t id;
  uint32_t stamp;
} winnow_key;
#define WINNOW_NO_OBJECT 0xFFFFFFFFU
#define WINNOW_NULL_KEY \
  { WINNOW_NO_OBJECT, 0 }

#define WINNOW_EVERY_ENVIRONMENT 0xFFFFFFFFU

/// Filter that restricts which other objects an object pairs with.
typedef struct winnow_object_filter {
  uint32_t layers;
  uint32_t mask;
  uint32_t environment;
} winnow_object_filter;
#define WINNOW_OBJECT_FILTER \
  { 1U, 0xFFFFFFFFU, 0U }

/// Filter of a query; a null pointer to it accepts all objects. `accept` may be null. Otherwise it
/// is called for objects that pass the rest of the filter, from any thread, from several at once
/// and in any order, and must return the same value each time for an object.
typedef struct winnow_filter {
  uint32_t layers;
  uint32_t mask;
  uint32_t environment;
  bool (*accept)(void* context, winnow_key key, uint64_t data);
  void* context;
} winnow_filter;
#define WINNOW_FILTER \
  { 0xFFFFFFFFU, 0xFFFFFFFFU, WINNOW_EVERY_ENVIRONMENT, NULL, NULL }

/// Order of results. Both orders are the same for any number of threads and any instruction set.
typedef int32_t winnow_order;
enum { WINNOW_ORDER_FAST = 0, WINNOW_ORDER_CANONICAL = 1 };

#ifdef __cplusplus
}
#endif
