#pragma once

// Lanes of boxes and triangles to frames of one pair, and the contacts of such pairs.

#include "pipeline/kernels/flat/flat.wide.h"
#include "pipeline/manifold/flat_patch.h"

namespace winnow::WINNOW_ISA_NAME {

/// Vectors and numbers of all lanes in memory, to be read one lane at a time.
template <typename T, int Count>
struct Stage {
  alignas(64) T value[Count][Lanes<T>::kCount];

  [[gnu::always_inline]] void put(int at, const Vec3<T>& v) {
    v.x.store(value[at]);
    v.y.store(value[at + 1]);
    v.z.store(value[at + 2]);
  }
  [[gnu::always_inline]] void put(int at, const Lanes<T>& v) { v.store(value[at]); }
  [[gnu::always_inline]] void get(int at, int count, unsigned lane, double* out) const {
    for (int i = 0; i < count; ++i) out[i] = static_cast<double>(value[at + i][lane]);
  }
};

/// Contacts of the lanes of `touching` by `meet(lane, points)`, in the caller's order; runs for all
/// lanes of the block. `offset` of a lane is from a to b as the kernel had them, `sign` -1 where
/// the caller has them the other way round.
template <typename T, typename Meet>
inline void write_patch_contacts(NarrowJob& job, const PairBlock<T>& block, Mask16 touching,
                                 const T (*offset)[Lanes<T>::kCount], const T* sign, Meet&& meet) {
  ContactWriter& out = job.contacts;
  for (unsigned lane = 0; lane < block.count; ++lane) {
    job.contact_first[block.first + lane] = out.size;
    std::uint32_t count = 0;
    if ((touching >> lane & 1U) != 0) {
      ContactPoint points[kManifoldPoints];
      count = meet(lane, points);
      const bool turned = sign[lane] < T(0);
      for (std::uint32_t k = 0; k < count; ++k, ++out.size) {
        const ContactPoint& p = points[k];
        for (int r = 0; r < 3; ++r) {
          const double from_b =
              static_cast<double>(p.position[r]) - static_cast<double>(offset[r][lane]);
          out.position[r][out.size] = turned ? static_cast<float>(from_b) : p.position[r];
        }
        out.depth[out.size] = p.depth;
        out.feature[out.size] = turned ? p.feature << 32U | p.feature >> 32U : p.feature;
      }
    }
    job.contact_count[block.first + lane] = count;
  }
}

}  // namespace winnow::WINNOW_ISA_NAME
