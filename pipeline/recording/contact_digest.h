#pragma once

#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/shapes.h>
#include "core/memory/byte_stream.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace winnow {

/// Adds a computed column as if its values were an array in memory.
template <typename Lookup>
void add_to(Digest& digest, const IndexedView<Lookup>& values) noexcept {
  constexpr std::size_t kBytes = sizeof(values[0]);
  constexpr std::size_t kPerWord = sizeof(std::uint64_t) / kBytes;
  std::uint64_t word = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    word |= std::uint64_t{values[i]} << (8 * kBytes * (i % kPerWord));
    if (i % kPerWord == kPerWord - 1) digest.add(std::exchange(word, 0));
  }
  digest.add(word);
  digest.add(std::uint64_t{values.size() * kBytes});
}

/// Adds all results of contacts. Of a key, only the id is added.
inline void add_to(Digest& digest, const Contacts& contacts) noexcept {
  const auto add_ids = [&](std::span<const Key> keys) {
    for (const Key& key : keys) digest.add(std::uint64_t{key.id});
  };
  digest.add(std::uint64_t{contacts.size()});
  add_ids(contacts.a());
  add_ids(contacts.b());
  add_to(digest, contacts.data_a());
  add_to(digest, contacts.data_b());
  digest.add_array(contacts.event());
  for (const EndedContact& ended : contacts.ended()) {
    digest.add(std::uint64_t{ended.a.id} << 32U | ended.b.id);
    digest.add(ended.data_a);
    digest.add(ended.data_b);
  }
  digest.add(std::uint64_t{contacts.ended().size()});
  digest.add_array(contacts.manifold_first());
  add_to(digest, contacts.part_a());
  add_to(digest, contacts.part_b());
  digest.add_array(contacts.distance());
  digest.add_array(contacts.error_bound());
  for (int axis = 0; axis < 3; ++axis) {
    digest.add_array(contacts.normal(axis));
    digest.add_array(contacts.point(axis));
  }
  digest.add_array(contacts.point_first());
  for (std::size_t i = 0; i < contacts.points(); ++i) {
    const ContactPoint point = contacts.contact(i);
    for (const float x : point.position) digest.add(x);
    digest.add(point.depth);
    digest.add(point.feature);
  }
  digest.add_array(contacts.previous_pair());
  digest.add_array(contacts.previous_point());
  digest.add(std::uint64_t{contacts.cached_pairs()});
}

/// Adds the numbers, vertices and faces of a hull in a pool. Its other arrays are computed from
/// these data.
inline void add_to(Digest& digest, const HullShape& hull) noexcept {
  for (const std::uint32_t count :
       {hull.vertex_count, hull.face_count, hull.edge_count, hull.dimension}) {
    digest.add(std::uint64_t{count});
  }
  for (const double x : {hull.rounding, hull.center[0], hull.center[1], hull.center[2], hull.radius,
                         hull.inner_radius}) {
    digest.add(x);
  }
  for (const double* column : hull.vertex) {
    digest.add_array(std::span<const double>(column, hull.vertex_count));
  }
  std::size_t corners = 0;
  for (std::uint32_t f = 0; f < hull.face_count; ++f) {
    const HullFace& face = hull.faces[f];
    for (const double x : {face.normal[0], face.normal[1], face.normal[2], face.offset}) {
      digest.add(x);
    }
    digest.add(std::uint64_t{face.first} << 32U | face.count);
    corners += face.count;
  }
  digest.add_array(std::span<const std::uint32_t>(hull.loop, corners));
}

}  // namespace winnow
