#pragma once

/// winnow for C99, and for whatever calls C. It has the words of the C++ interface:
/// winnow_partition_self_pairs is Partition::self_pairs, which its header documents; said here is
/// what is different in C.
///
///  - Every call that can be refused answers a winnow_status. A refused call has changed nothing. A
///    null pointer where none is allowed, a kind that does not exist and a wrong `size` are
///    WINNOW_INVALID_ARGUMENT. What cannot be told, and must not be, is a pointer to memory that is
///    not there, too short, or of something that was destroyed.
///  - winnow_x_create makes an x and winnow_x_destroy ends it; null is ended by doing nothing. What
///    an x was made of (shapes of a scene, a scene of queries, the context of a winnow_memory) must
///    outlive it.
///  - Calls that take const are questions, and may run at the same time from several threads; all
///    others want the thing to themselves. Buffers of results belong to one thread at a time.
///  - Results are shown where they lie: a pointer that a call answers is valid until what it was
///    taken from is used again or destroyed.
///  - Structs that may grow begin with their `size`, which the caller sets to sizeof. Options with
///    zeros behind it are what C++ has by default, and so is null in their place. A struct of which
///    something else than zeros is the default has a macro of its name in capitals.
///  - Callbacks must not throw, jump out, or call what calls them.
///
/// How the binary interface may change is written in README.md beside this file.

#include <winnow/c/contact_groups.h>
#include <winnow/c/core.h>
#include <winnow/c/hooks.h>
#include <winnow/c/narrow_phase.h>
#include <winnow/c/partition.h>
#include <winnow/c/scene.h>
#include <winnow/c/scene_queries.h>
#include <winnow/c/scene_sweep.h>
#include <winnow/c/sensors.h>
#include <winnow/c/shapes.h>
#include <winnow/c/snapshots.h>
#include <winnow/c/time_of_impact.h>
#include <winnow/c/volumes.h>
