#pragma once

// Contacts of one pair with curved shapes: the supporting features of both cores along a normal, as
// patches for contact_patch.

#include "pipeline/kernels/cores/curved_pair.wide.h"
#include "pipeline/manifold/contact_patch.h"
#include "pipeline/manifold/feature_rules.h"

namespace winnow::WINNOW_ISA_NAME::curved {

/// The supporting feature of one core, in world axes, relative to body a.
class CurvedPatch {
 public:
  /// `normal` is in the frame of the first and points from the first to the second. `at` is the
  /// point of the core that is closest to the other core, or deepest in it, in the frame of the
  /// core.
  CurvedPatch(const CurvedPair& pair, bool of_first, const double* normal, const double* at)
      : pair_(pair), form_(of_first ? pair.first : pair.second), of_first_(of_first) {
    double d[3];
    if (of_first) {
      for (int k = 0; k < 3; ++k) d[k] = normal[k];
    } else {
      turn_back3(pair.turn, normal, d);
      for (double& x : d) x = -x;
    }
    hull::with_core(form_.kind, [&](auto kind) {
      if constexpr (!decltype(kind)::kTouchesInPoint) kind.add_feature(form_, d, at, *this);
    });
  }

  [[nodiscard]] SupportingFeature view() const {
    return {vertex_, vertex_feature_, edge_feature_, count_, feature_, form_.rounding * pair_.unit};
  }

  // Called by the kind of the core. Its points are in its frame and scaled; `scale`, `unit` and
  // `size` are those of the pair.

  struct Local {
    double x;
    double y;
    double z;
  };
  void add(const Local& at, std::uint32_t vertex_feature, std::uint32_t edge_feature) {
    const double local[3] = {at.x * pair_.unit, at.y * pair_.unit, at.z * pair_.unit};
    double* r = vertex_[count_];
    double x[3] = {local[0], local[1], local[2]};
    if (!of_first_) {
      turn3(pair_.turn, local, x);
      for (int k = 0; k < 3; ++k) x[k] += pair_.shift[k] * pair_.unit;
    }
    turn3(pair_.frame, x, r);
    if (pair_.swapped) {
      for (int k = 0; k < 3; ++k) r[k] -= pair_.offset[k];
    }
    vertex_feature_[count_] = vertex_feature;
    edge_feature_[count_++] = edge_feature;
  }

  void set_feature(std::uint32_t feature) { feature_ = feature; }
  [[nodiscard]] double scale() const { return pair_.scale; }
  [[nodiscard]] double unit() const { return pair_.unit; }
  [[nodiscard]] double size() const { return pair_.size; }

 private:
  static constexpr std::uint32_t kRoom = kPatchRoom;

  const CurvedPair& pair_;
  const CoreDesc& form_;
  bool of_first_;
  std::uint32_t count_ = 0;
  std::uint32_t feature_ = 0;
  double vertex_[kRoom][3];
  std::uint32_t vertex_feature_[kRoom];
  std::uint32_t edge_feature_[kRoom];
};

/// Feature number of a single contact point, at a point of the core in its frame.
static inline std::uint32_t point_feature(const CoreDesc& form, const double* at, double size) {
  return hull::with_core(form.kind, [&](auto kind) { return kind.point_feature(form, at, size); });
}

static inline bool touches_in_a_point(const CoreDesc& form) {
  return hull::with_core(form.kind, [](auto kind) { return decltype(kind)::kTouchesInPoint; });
}

/// Writes the contact points of a pair within the margin, and returns their number. `normal` is in
/// the frame of the first. `world`, from body a to body b, and `point`, on the surface of a and
/// relative to it, are in world axes. `core` is the point on the core of the first, `apart` the
/// distance of the cores, both scaled. The closest point of the pair replaces the deepest point of
/// the features if the depths of the two differ by more than rounding errors and tied_depth (as for
/// rims, whose features are polygons), if the features are farther apart than the margin, or if
/// they have only one contact. If the depths differ by more than 1e-2 of the size, the closest
/// point is inserted before the points of the features instead. No point becomes deeper than the
/// closest point, and the first point has its depth.
static inline std::uint32_t curved_contacts(const CurvedPair& pair, const double* normal,
                                            const double* world, const double* point,
                                            const double* core, double apart, double distance,
                                            double margin, ContactPoint (&out)[kManifoldPoints]) {
  double theirs[3];
  double local[3];
  for (int k = 0; k < 3; ++k) theirs[k] = core[k] + apart * normal[k] - pair.shift[k];
  turn_back3(pair.turn, theirs, local);
  std::uint32_t count = 0;
  if (!touches_in_a_point(pair.first) && !touches_in_a_point(pair.second)) {
    const CurvedPatch first(pair, true, normal, core);
    const CurvedPatch second(pair, false, normal, local);
    count = contact_patch(pair.swapped ? second.view() : first.view(),
                          pair.swapped ? first.view() : second.view(), world, margin, out);
  }
  ContactPoint own{};
  for (int k = 0; k < 3; ++k) {
    own.position[k] = static_cast<float>(point[k] + 0.5 * distance * world[k]);
  }
  own.depth = static_cast<float>(-distance);
  const std::uint64_t mine = point_feature(pair.first, core, pair.size);
  const std::uint64_t other = point_feature(pair.second, local, pair.size);
  own.feature = pair.swapped ? other << 32U | mine : mine << 32U | other;
  const double size = pair.size * pair.unit;
  const double miss =
      __builtin_fabs(static_cast<double>(out[0].depth) - static_cast<double>(own.depth));
  const bool near = count > 0 && static_cast<double>(out[0].depth) >= -margin;
  if (near && count > 1 && miss > 1e-2 * size) {
    count = count < kManifoldPoints ? count + 1 : count;
    for (std::uint32_t i = count - 1; i > 0; --i) out[i] = out[i - 1];
    out[0] = own;
  } else if (!near || count == 1 || (miss > 4e-7 * size && miss > tied_depth(out, count))) {
    if (near) own.feature = out[0].feature;
    out[0] = own;
    count = count == 0 ? 1 : count;
  }
  out[0].depth = own.depth;
  for (std::uint32_t i = 1; i < count; ++i) {
    out[i].depth = out[i].depth < own.depth ? out[i].depth : own.depth;
  }
  return count;
}

}  // namespace winnow::WINNOW_ISA_NAME::curved
