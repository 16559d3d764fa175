#pragma once

/// What all calls are about: status, version, memory, threads, keys and filters.

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

/// Of the library that this header came with.
#define WINNOW_VERSION_MAJOR 0
#define WINNOW_VERSION_MINOR 1
#define WINNOW_VERSION_PATCH 0
/// The number of the binary interface, and of the shared library's name; see README.md beside this.
#define WINNOW_ABI 1

/// What became of a call. One that is not WINNOW_OK has changed nothing.
typedef int32_t winnow_status;
enum {
  WINNOW_OK = 0,
  WINNOW_INVALID_BOUNDS = 1,
  WINNOW_INVALID_KEY = 2,
  /// Also: a pointer is null that must not be, a kind or a choice is none, a `size` is wrong.
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

/// For messages: "ok", "invalid_bounds", ... Never null.
WINNOW_C_API const char* winnow_status_name(winnow_status status);

/// Of the library that runs: major << 16 | minor << 8 | patch, and the same as text.
WINNOW_C_API uint32_t winnow_version(void);
WINNOW_C_API const char* winnow_version_name(void);
/// WINNOW_ABI of the library that runs: another than that of the header cannot be used with it.
WINNOW_C_API uint32_t winnow_abi(void);

/// The instruction set in use: "sse42", "avx2", "avx512", "neon64".
WINNOW_C_API const char* winnow_isa_name(void);
/// Those that this machine can run, narrowest first; null for any other number.
WINNOW_C_API const char* winnow_available_isa(size_t i);
/// For the whole process.
WINNOW_C_API winnow_status winnow_set_isa(const char* name);

/// Where memory comes from. `allocate` answers null if it refuses; `deallocate` gets the bytes and
/// the alignment (a power of two) that the block was asked with. Calls that take a null pointer in
/// place of one use pages of 2 MB for large blocks, where the system has them, and `new` for
/// others. The struct is copied; the context must outlive what is made with it.
typedef struct winnow_memory {
  void* (*allocate)(void* context, size_t bytes, size_t alignment);
  void (*deallocate)(void* context, void* block, size_t bytes, size_t alignment);
  void* context;
} winnow_memory;

/// Whether memory that is made ready is written to as well.
typedef int32_t winnow_pages;
enum { WINNOW_PAGES_UNTOUCHED = 0, WINNOW_PAGES_TOUCHED = 1 };

/// A host's own way to run tasks side by side; see JobSystem for what it must hold.
typedef struct winnow_job_system {
  void (*parallel_for)(void* context, size_t count, void (*task)(void* tasks, size_t i),
                       void* tasks);
  void* context;
  size_t threads;
} winnow_job_system;

typedef struct winnow_execution {
  int32_t kind;
  winnow_job_system jobs;  ///< of WINNOW_EXECUTION_ON
} winnow_execution;
enum {
  WINNOW_EXECUTION_DEFAULT = 0,  ///< as C++ has it: parallel, but of pairs and impacts serial
  WINNOW_EXECUTION_SERIAL = 1,
  WINNOW_EXECUTION_ON = 2,       ///< on the host's own job system
  WINNOW_EXECUTION_PARALLEL = 3  ///< on all processors, by oneTBB
};

/// So many threads of oneTBB, the one that calls counted in; they are started by the first call
/// that uses them and shared by all that is made with them. From 1 to 4096.
typedef struct winnow_threads winnow_threads;
/// WINNOW_UNSUPPORTED for more than one where the library was built without oneTBB.
WINNOW_C_API winnow_status winnow_threads_create(size_t count, winnow_threads** threads);
/// After all that was made with them.
WINNOW_C_API void winnow_threads_destroy(winnow_threads* threads);
WINNOW_C_API winnow_status winnow_threads_execution(const winnow_threads* threads,
                                                    winnow_execution* execution);

/// Bytes of one purpose: live content, and what the memory gave.
typedef struct winnow_bytes {
  size_t used;
  size_t reserved;
} winnow_bytes;

/// Bytes by purpose. The sum of `reserved` equals, to the byte, what is outstanding at the memory;
/// what a pointer like winnow_partition* leads to is under `structure`.
typedef struct winnow_footprint {
  size_t size;  ///< sizeof(winnow_footprint), of the caller
  winnow_bytes bounds;
  winnow_bytes keys;
  winnow_bytes client_data;
  winnow_bytes structure;
  winnow_bytes scratch;
  winnow_bytes results;
} winnow_footprint;

/// An object of a partition, or a body of a scene. One that was removed, or that another partition
/// or scene gave out, is WINNOW_INVALID_KEY.
typedef struct winnow_key {
  uint32_t id;
  uint32_t stamp;
} winnow_key;
#define WINNOW_NO_OBJECT 0xFFFFFFFFU
#define WINNOW_NULL_KEY \
  { WINNOW_NO_OBJECT, 0 }

#define WINNOW_EVERY_ENVIRONMENT 0xFFFFFFFFU

/// What an object lets itself be paired with.
typedef struct winnow_object_filter {
  uint32_t layers;
  uint32_t mask;
  uint32_t environment;
} winnow_object_filter;
#define WINNOW_OBJECT_FILTER \
  { 1U, 0xFFFFFFFFU, 0U }

/// What a query asks for; null in its place asks for all. `accept` is null or a last word on each
/// object: any thread calls it, several at once, in any order, and it answers the same each time.
typedef struct winnow_filter {
  uint32_t layers;
  uint32_t mask;
  uint32_t environment;
  bool (*accept)(void* context, winnow_key key, uint64_t data);
  void* context;
} winnow_filter;
#define WINNOW_FILTER \
  { 0xFFFFFFFFU, 0xFFFFFFFFU, WINNOW_EVERY_ENVIRONMENT, NULL, NULL }

/// The order of results; the same on any thread count and any instruction set either way.
typedef int32_t winnow_order;
enum { WINNOW_ORDER_FAST = 0, WINNOW_ORDER_CANONICAL = 1 };

#ifdef __cplusplus
}
#endif
