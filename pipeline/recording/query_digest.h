#pragma once

#include <winnow/pipeline/scene_queries.h>
#include "core/memory/byte_stream.h"

#include <span>

namespace winnow {

// Digests of all results of scene queries. Of a key, only the id is added.

inline void add_to(Digest& digest, const Vec3d& vector) noexcept {
  for (const double x : vector) digest.add(x);
}

// For a query that found nothing, only the id of the null key is added.

inline void add_to(Digest& digest, const SceneHit& hit) noexcept {
  digest.add(std::uint64_t{hit.key.id});
  if (!hit) return;
  digest.add(std::uint64_t{hit.part});
  digest.add(hit.data);
  digest.add(hit.t);
  add_to(digest, hit.normal);
  add_to(digest, hit.point);
}

inline void add_to(Digest& digest, const SceneCrossing& crossing) noexcept {
  digest.add(std::uint64_t{crossing.key.id} << 32U | crossing.part);
  digest.add(crossing.data);
  digest.add(crossing.t);
  digest.add(std::uint64_t{crossing.exits ? 1U : 0U});
  add_to(digest, crossing.normal);
  add_to(digest, crossing.point);
  add_to(digest, crossing.barycentric);
}

inline void add_to(Digest& digest, const SceneOverlap& body) noexcept {
  digest.add(std::uint64_t{body.key.id} << 32U | body.part);
  digest.add(body.data);
}

inline void add_to(Digest& digest, const SceneDistance& answer) noexcept {
  digest.add(std::uint64_t{answer.key.id});
  if (!answer) return;
  digest.add(answer.data);
  digest.add(std::uint64_t{answer.part_a} << 32U | answer.part);
  digest.add(answer.distance);
  digest.add(answer.error_bound);
  add_to(digest, answer.normal);
  add_to(digest, answer.point_a);
  add_to(digest, answer.point_b);
}

inline void add_to(Digest& digest, const SetDistance& answer) noexcept {
  digest.add(std::uint64_t{answer.a.id});
  if (!answer) return;
  digest.add(answer.data_a);
  add_to(digest, answer.to);
}

inline void add_to(Digest& digest, const KeyPair& pair) noexcept {
  digest.add(std::uint64_t{pair.first.id} << 32U | pair.second.id);
}

template <typename T>
void add_to(Digest& digest, std::span<const T> answers) noexcept {
  for (const T& answer : answers) add_to(digest, answer);
  digest.add(std::uint64_t{answers.size()});
}

inline void add_to(Digest& digest, const SceneHitLists& lists) noexcept {
  add_to(digest, lists.hits);
  for (const std::size_t first : lists.first) digest.add(std::uint64_t{first});
}

/// Skips null columns.
inline void add_to(Digest& digest, const SceneHitColumns& hits, std::size_t count) noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    if (hits.key != nullptr) digest.add(std::uint64_t{hits.key[i].id});
    if (hits.data != nullptr) digest.add(hits.data[i]);
    if (hits.part != nullptr) digest.add(std::uint64_t{hits.part[i]});
    if (hits.t != nullptr) digest.add(hits.t[i]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (hits.normal[axis] != nullptr) digest.add(hits.normal[axis][i]);
      if (hits.point[axis] != nullptr) digest.add(hits.point[axis][i]);
    }
  }
}

/// Returns which columns are not null, one bit each: key, data, part, t, normal x, y, z, point x,
/// y, z.
[[nodiscard]] inline std::uint16_t columns_in(const SceneHitColumns& hits) noexcept {
  const bool there[] = {hits.key != nullptr,       hits.data != nullptr,
                        hits.part != nullptr,      hits.t != nullptr,
                        hits.normal[0] != nullptr, hits.normal[1] != nullptr,
                        hits.normal[2] != nullptr, hits.point[0] != nullptr,
                        hits.point[1] != nullptr,  hits.point[2] != nullptr};
  unsigned bits = 0;
  for (unsigned i = 0; i < 10; ++i) bits |= there[i] ? 1U << i : 0U;
  return static_cast<std::uint16_t>(bits);
}

}  // namespace winnow
