#pragma once

#include <gtest/gtest.h>
#include <winnow/partitions/partition.h>

#include <span>
#include <vector>

#include "tests/support/cast_reference.h"
#include "tests/support/reference.h"
#include "tests/support/region_reference.h"

namespace winnow::test {

/// An object that a query may report.
template <typename Truth>
struct Candidate {
  ObjectId id = kNoObject;
  Truth truth;
};
using CastCandidates = std::vector<Candidate<CastTruth>>;
using RegionCandidates = std::vector<Candidate<RegionTruth>>;

/// Returns the objects that may be reported, by id. `objects` are sorted by id.
[[nodiscard]] CastCandidates candidates(const Cast& cast, std::span<const Object> objects);
[[nodiscard]] RegionCandidates candidates(const Region& region, std::span<const Object> objects);

/// Returns true if this is a right result of `all`: sorted by (t, id), each object once and with
/// its key and data, none missing, each at its first touch.
[[nodiscard]] testing::AssertionResult right_hits(std::span<const Hit> got,
                                                  const CastCandidates& candidates,
                                                  const Partition& partition);

/// Returns true if `hit` is an element of `all`, or null if `all` is empty.
[[nodiscard]] testing::AssertionResult is_any_of(const Hit& hit, std::span<const Hit> all);

/// Returns true if `hit` is the first element of `all`, or null if `all` is empty.
[[nodiscard]] testing::AssertionResult is_first_of(const Hit& hit, std::span<const Hit> all);

/// Returns true if the hits are equal, t bit by bit.
[[nodiscard]] testing::AssertionResult same_hits(std::span<const Hit> a, std::span<const Hit> b);

/// Returns true if this is a right result of `overlap`.
[[nodiscard]] testing::AssertionResult right_objects(const OverlapBuffer& got,
                                                     const RegionCandidates& candidates,
                                                     Order order);

/// Returns true if this is a right result of `nearest`.
[[nodiscard]] testing::AssertionResult right_nearest(std::span<const Hit> got, const Aabb& from,
                                                     std::size_t count, float radius,
                                                     std::span<const Object> objects,
                                                     const Partition& partition);

}  // namespace winnow::test
