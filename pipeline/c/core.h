// Generated from pipeline/interface/core.toml; do not edit.
// clang-format off
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

/// A number of oneTBB threads, including the calling thread. They are started by the first call
/// that uses them, and shared by everything created with them.
typedef struct winnow_threads winnow_threads;

/// Version of winnow that this header belongs to: major, minor, patch.
#define WINNOW_VERSION_MAJOR 0

/// See WINNOW_VERSION_MAJOR.
#define WINNOW_VERSION_MINOR 1

/// See WINNOW_VERSION_MAJOR.
#define WINNOW_VERSION_PATCH 0

/// Number of the binary interface, also part of the shared library's name; see README.md here.
#define WINNOW_ABI 1

/// Id of no object.
#define WINNOW_NO_OBJECT 0xFFFFFFFFU

/// Environment whose objects pair with objects of every environment.
#define WINNOW_EVERY_ENVIRONMENT 0xFFFFFFFFU

/// Result of a call. A call that does not return WINNOW_OK has changed nothing, except that it may
/// have emptied its result buffer.
typedef int32_t winnow_status;
enum {
  WINNOW_OK = 0,  ///< success
  /// A bounding volume has a NaN, has min > max, or is entirely at infinity.
  WINNOW_INVALID_BOUNDS = 1,
  /// A key is null, stale (its object was removed) or of another partition or scene.
  WINNOW_INVALID_KEY = 2,
  /// An option or argument is out of range; also a null pointer that is not allowed, an invalid
  /// kind or choice, or a wrong `size`.
  WINNOW_INVALID_ARGUMENT = 3,
  WINNOW_SIZE_MISMATCH = 4,       ///< arrays that belong together differ in length
  WINNOW_OUT_OF_MEMORY = 5,       ///< the memory was refused; the object is unchanged
  WINNOW_TOO_MANY_OBJECTS = 6,    ///< the number of objects would exceed its limit
  WINNOW_UNSUPPORTED_VOLUME = 7,  ///< the partition does not store this kind of bounding volume
  WINNOW_INVALID_SHAPE = 8,  ///< a shape has an invalid length, or its points do not define a shape
  WINNOW_INVALID_POSE = 9,   ///< a pose has a NaN or infinity, or its quaternion is zero
  WINNOW_UNSUPPORTED = 10,   ///< this build, or the object as it was created, lacks the function
  WINNOW_COMMUNICATION_FAILED = 11  ///< a rank of a cluster does not respond; not returned by C
};

/// Whether reserved memory is also written to, so that its pages are present before first use.
typedef int32_t winnow_pages;
enum {
  WINNOW_PAGES_UNTOUCHED = 0,
  WINNOW_PAGES_TOUCHED = 1
};

/// How a call runs its work; results do not depend on it.
enum {
  /// C++ default: parallel (narrow phase, impacts, deformable meshes: serial).
  WINNOW_EXECUTION_DEFAULT = 0,
  WINNOW_EXECUTION_SERIAL = 1,   ///< on the calling thread
  WINNOW_EXECUTION_ON = 2,       ///< the host's job system `jobs`
  WINNOW_EXECUTION_PARALLEL = 3  ///< all processors, with oneTBB
};

/// Order of results. Both orders are the same for any number of threads and any instruction set.
typedef int32_t winnow_order;
enum {
  WINNOW_ORDER_FAST = 0,      ///< order in which results are found
  WINNOW_ORDER_CANONICAL = 1  ///< sorted by ids
};

/// Source of memory. If a call is given a null pointer to this struct, large blocks use pages of 2
/// MB where the system has them, and other blocks use `new`. The struct is copied; the context must
/// outlive everything created with it.
typedef struct winnow_memory {
  void* (*allocate)(void* context, size_t bytes, size_t alignment);  ///< returns null on failure
  /// Called with the bytes and the alignment (a power of two) of the allocation.
  void (*deallocate)(void* context, void* block, size_t bytes, size_t alignment);
  void* context;  ///< passed to both functions
} winnow_memory;

/// Job system of the host program.
typedef struct winnow_job_system {
  /// Calls `task(tasks, i)` once for every i < count, on any threads and in any order, and returns
  /// after all calls have returned. While it blocks it must not run other work that may call
  /// winnow. It may be called from any thread, from several threads at once, and from its own
  /// tasks.
  void (*parallel_for)(void* context, size_t count, void (*task)(void* tasks, size_t i),
                       void* tasks);
  void* context;  ///< passed to `parallel_for`; must outlive everything created with it
  /// Tasks that may run at the same time, and the largest count; affects only speed.
  size_t threads;
} winnow_job_system;

/// How a call runs its work.
typedef struct winnow_execution {
  int32_t kind;            ///< WINNOW_EXECUTION_DEFAULT, ..._SERIAL, ..._ON or ..._PARALLEL
  winnow_job_system jobs;  ///< used if `kind` is WINNOW_EXECUTION_ON
} winnow_execution;

/// Bytes of one purpose.
typedef struct winnow_bytes {
  size_t used;      ///< bytes with content
  size_t reserved;  ///< bytes allocated, with content or not
} winnow_bytes;

/// Memory of an object, by purpose. The sum of `reserved` equals the bytes that the object has
/// allocated from its winnow_memory. The object behind a handle such as winnow_partition* counts as
/// `structure`.
typedef struct winnow_footprint {
  size_t size;               ///< set by the caller to sizeof(winnow_footprint)
  winnow_bytes bounds;       ///< bounding volumes
  winnow_bytes keys;         ///< keys of objects
  winnow_bytes client_data;  ///< client data of all objects
  winnow_bytes structure;    ///< cells, nodes and sort orders; the handle
  winnow_bytes scratch;      ///< buffers kept from call to call
  winnow_bytes results;      ///< pairs, hits, contacts and other results
} winnow_footprint;

/// Key of an object of a partition, or of a body of a scene. Calls return WINNOW_INVALID_KEY for
/// the key of a removed object, and for a key of another partition or scene.
typedef struct winnow_key {
  uint32_t id;     ///< index of the object
  uint32_t stamp;  ///< distinguishes objects with the same id
} winnow_key;
#define WINNOW_NULL_KEY {WINNOW_NO_OBJECT, 0}

/// Filter that restricts which other objects an object pairs with: each of the two must be in a
/// layer that the other accepts, and their environments must be equal, or one of them
/// WINNOW_EVERY_ENVIRONMENT.
typedef struct winnow_object_filter {
  uint32_t layers;       ///< layers that the object is in, one bit each
  uint32_t mask;         ///< layers of objects that it accepts
  uint32_t environment;  ///< objects of different environments do not pair
} winnow_object_filter;
#define WINNOW_OBJECT_FILTER {1U, 0xFFFFFFFFU, 0U}

/// Filter of a query, as if the query were an object; a null pointer to it accepts all objects.
typedef struct winnow_filter {
  uint32_t layers;       ///< layers that the query is in, one bit each
  uint32_t mask;         ///< layers that it accepts
  uint32_t environment;  ///< objects of other environments are skipped
  /// Null, or called for objects that pass the rest of the filter: from any thread, from several at
  /// once and in any order. It must return the same value each time for an object.
  bool (*accept)(void* context, winnow_key key, uint64_t data);
  void* context;  ///< passed to `accept`
} winnow_filter;
#define WINNOW_FILTER {0xFFFFFFFFU, 0xFFFFFFFFU, WINNOW_EVERY_ENVIRONMENT, NULL, NULL}

/// Callback that accepts or rejects pairs of objects, by their ids; see winnow_filter for its
/// rules.
typedef struct winnow_pair_predicate {
  bool (*accept)(void* context, uint32_t first, uint32_t second);  ///< null accepts all pairs
  void* context;                                                   ///< passed to `accept`
} winnow_pair_predicate;

/// Creates 1 to 4096 threads. WINNOW_UNSUPPORTED if count > 1 and the library was built without
/// oneTBB.
WINNOW_C_API winnow_status winnow_threads_create(size_t count, winnow_threads** threads);

/// Destroys the threads. Destroy everything that was created with them first.
WINNOW_C_API void winnow_threads_destroy(winnow_threads* threads);

/// Writes an execution that runs work on these threads.
WINNOW_C_API winnow_status winnow_threads_execution(
    const winnow_threads* threads, winnow_execution* execution);

/// Returns the name of a status: "ok", "invalid_bounds", ...; "unknown" for another number. Never
/// null.
WINNOW_C_API const char* winnow_status_name(winnow_status status);

/// Returns the version of the loaded library: major << 16 | minor << 8 | patch.
WINNOW_C_API uint32_t winnow_version(void);

/// Returns the version of the loaded library as text.
WINNOW_C_API const char* winnow_version_name(void);

/// Returns WINNOW_ABI of the loaded library. If it differs from the header's WINNOW_ABI, the
/// library cannot be used with this header.
WINNOW_C_API uint32_t winnow_abi(void);

/// Returns the name of the instruction set in use: "sse42", "avx2", "avx512" or "neon64".
WINNOW_C_API const char* winnow_isa_name(void);

/// Returns the name of instruction set i that this machine can run, narrowest first; null if i is
/// out of range.
WINNOW_C_API const char* winnow_available_isa(size_t i);

/// Selects the instruction set for the whole process. WINNOW_INVALID_ARGUMENT for a name that the
/// machine cannot run.
WINNOW_C_API winnow_status winnow_set_isa(const char* name);

#ifdef __cplusplus
}
#endif
