#pragma once

// For tests that call C and compare with the C++ object behind the handle.

#include "pipeline/c/binding/structs.h"

#include <winnow/c/winnow.h>

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <span>
#include <utility>

namespace winnow::test {

/// A handle that is destroyed at the end.
template <typename OfC, void (*kDestroy)(OfC*)>
class Owned {
 public:
  /// Calls a create function with the given arguments, and with the place of the handle.
  template <typename Create, typename... Given>
  explicit Owned(Create create, const Given&... given) {
    OfC* made = nullptr;
    EXPECT_EQ(create(given..., &made), WINNOW_OK);
    handle_.reset(made);
  }
  operator OfC*() const noexcept { return handle_.get(); }  // NOLINT(google-explicit-constructor)
  /// The C++ object.
  auto* operator->() const noexcept { return &c::of(handle_.get()); }
  auto& operator*() const noexcept { return c::of(handle_.get()); }

 private:
  struct Destroy {
    void operator()(OfC* handle) const noexcept { kDestroy(handle); }
  };
  std::unique_ptr<OfC, Destroy> handle_;
};

using OwnedShapes = Owned<winnow_shape_pool, winnow_shape_pool_destroy>;
using OwnedComposites = Owned<winnow_composite_pool, winnow_composite_pool_destroy>;
using OwnedScene = Owned<winnow_scene, winnow_scene_destroy>;
using OwnedContacts = Owned<winnow_contacts, winnow_contacts_destroy>;
using OwnedQueries = Owned<winnow_scene_queries, winnow_scene_queries_destroy>;
using OwnedImpacts = Owned<winnow_continuous_collision, winnow_continuous_collision_destroy>;
using OwnedPartition = Owned<winnow_partition, winnow_partition_destroy>;
using OwnedPairs = Owned<winnow_pair_buffer, winnow_pair_buffer_destroy>;
using OwnedSnapshot = Owned<winnow_snapshot, winnow_snapshot_destroy>;
using OwnedMesh = Owned<winnow_deformable_mesh, winnow_deformable_mesh_destroy>;

/// Calls a function of C with the arguments and a place for its result, which it returns.
template <typename Result, typename Call, typename... Given>
[[nodiscard]] Result got(Call call, const Given&... given) {
  Result result{};
  EXPECT_EQ(call(given..., &result), WINNOW_OK);
  return result;
}
/// As above, for functions that return an array.
template <typename Element, typename Call, typename... Given>
[[nodiscard]] std::span<const Element> got_all(Call call, const Given&... given) {
  const Element* first = nullptr;
  std::size_t count = 0;
  EXPECT_EQ(call(given..., &first, &count), WINNOW_OK);
  return {first, count};
}

/// True if the C struct has the bits of the C++ struct, apart from padding that both set to zero.
template <typename OfC, typename OfCpp>
[[nodiscard]] bool have_same_bits(const OfC& of_c, const OfCpp& of_cpp) {
  static_assert(c::kIsSameLayout<OfC, OfCpp>);
  return std::memcmp(&of_c, &of_cpp, sizeof of_c) == 0;
}

}  // namespace winnow::test
