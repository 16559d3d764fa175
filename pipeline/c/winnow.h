// Generated from pipeline/interface/winnow.toml; do not edit.
// clang-format off
#pragma once

/// winnow for C99, and for any language that can call C. The functions are named after the C++
/// interface: winnow_partition_self_pairs is Partition::self_pairs.
///
/// - Every call that can fail returns a winnow_status. A call that fails has changed nothing, but
///   may have emptied its result buffer. It returns WINNOW_INVALID_ARGUMENT for a null pointer that
///   is not allowed, an invalid kind or a wrong `size`. Pointers to missing, too short or destroyed
///   memory cannot be detected and must not be passed.
/// - Pointers to a winnow_filter, winnow_memory, winnow_execution or a struct of options may be
///   null, which means the defaults. Other pointers may be null only if the function states it, and
///   arrays without entries.
/// - winnow_x_create creates an x, and winnow_x_destroy destroys it; destroying null does nothing.
///   Objects that an x was created from (the shapes of a scene, the scene of its queries, the
///   context of a winnow_memory) must outlive it.
/// - Calls with a const handle are queries and may run concurrently on several threads. All other
///   calls need exclusive access. A result buffer belongs to one thread at a time.
/// - Results are not copied: a returned pointer is valid until the object that it came from is used
///   again or destroyed.
/// - Structs that may grow begin with their `size`, which the caller sets to sizeof. If all other
///   members of an options struct are zero, it has the defaults of C++. A struct whose defaults are
///   not all zero has an initializer macro, its name in capitals.
/// - Callbacks must not throw, longjmp, or call the object that called them.
///
/// README.md in this directory states how the binary interface may change.

#include <winnow/c/contact_groups.h>
#include <winnow/c/continuous_collision.h>
#include <winnow/c/core.h>
#include <winnow/c/deformable_mesh.h>
#include <winnow/c/hooks.h>
#include <winnow/c/narrow_phase.h>
#include <winnow/c/partition.h>
#include <winnow/c/recording.h>
#include <winnow/c/scene.h>
#include <winnow/c/scene_queries.h>
#include <winnow/c/sensors.h>
#include <winnow/c/shapes.h>
#include <winnow/c/snapshots.h>
#include <winnow/c/time_of_impact.h>
#include <winnow/c/volumes.h>
