#pragma once

#include <gtest/gtest.h>
#include <winnow/partitions/partition.h>

#include <span>
#include <vector>

#include "tests/support/cast_twin.h"
#include "tests/support/region_twin.h"
#include "tests/support/twin.h"

namespace winnow::test {

/// An object that a query may report.
template <typename Truth>
struct Candidate {
  ObjectId id = kNoObject;
  Truth truth;
};
using CastCandidates = std::vector<Candidate<CastTruth>>;
using RegionCandidates = std::vector<Candidate<RegionTruth>>;

/// Those objects that may be reported, by id. Objects come sorted by id.
[[nodiscard]] CastCandidates candidates(const Cast& cast, std::span<const Object> objects);
[[nodiscard]] RegionCandidates candidates(const Region& region, std::span<const Object> objects);

/// True if this is a right answer to `all`: sorted by (t, id), each object once and with its key
/// and data, none missing, each at its first touch.
[[nodiscard]] testing::AssertionResult right_hits(std::span<const Hit> got,
                                                  const CastCandidates& candidates,
                                                  const Partition& partition);

/// True if a hit is one of these, or null where there are none.
[[nodiscard]] testing::AssertionResult is_any_of(const Hit& hit, std::span<const Hit> all);

/// True if a hit is the first of these, or null where there are none.
[[nodiscard]] testing::AssertionResult is_first_of(const Hit& hit, std::span<const Hit> all);

/// True if these are the same hits, t bit by bit.
[[nodiscard]] testing::AssertionResult same_hits(std::span<const Hit> a, std::span<const Hit> b);

/// True if this is a right answer to `overlap`.
[[nodiscard]] testing::AssertionResult right_objects(const OverlapBuffer& got,
                                                     const RegionCandidates& candidates,
                                                     Order order);

/// True if this is a right answer to `nearest`.
[[nodiscard]] testing::AssertionResult right_nearest(std::span<const Hit> got, const Aabb& from,
                                                     std::size_t count, float radius,
                                                     std::span<const Object> objects,
                                                     const Partition& partition);

}  // namespace winnow::test
