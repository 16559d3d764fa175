#include "volumes/quantised.h"

#include "volumes/block_test.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <numeric>

namespace winnow::bench {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

/// Bits of x spread three apart.
std::uint32_t spread_bits(std::uint32_t x) {
  std::uint32_t result = 0;
  for (unsigned bit = 0; bit < 10; ++bit) result |= (x >> bit & 1U) << (3 * bit);
  return result;
}

/// Indices of boxes in the order of their centres on Morton's curve.
std::vector<std::uint32_t> near_together(std::span<const Aabb> boxes) {
  Aabb world{Eigen::Vector3f::Constant(kInf), Eigen::Vector3f::Constant(-kInf)};
  for (const Aabb& box : boxes) {
    world.min = world.min.cwiseMin(box.min);
    world.max = world.max.cwiseMax(box.max);
  }
  const Eigen::Vector3f extent = (world.max - world.min).cwiseMax(1e-30F);
  std::vector<std::uint32_t> code(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const float center = 0.5F * (boxes[i].min[axis] + boxes[i].max[axis]);
      const float place = (center - world.min[axis]) / extent[axis] * 1023.0F;
      code[i] |= spread_bits(static_cast<std::uint32_t>(place)) << axis;
    }
  }
  std::vector<std::uint32_t> order(boxes.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return code[a] < code[b]; });
  return order;
}

/// A group's box, in which 16-bit ends are counted.
struct Frame {
  std::array<float, 6> box;
  std::array<float, 3> scale;

  [[nodiscard]] std::uint16_t place(float x, std::size_t axis) const {
    const float steps = (x - box[axis]) * scale[axis];
    return static_cast<std::uint16_t>(std::min(std::max(steps, 0.0F), 65535.0F));
  }
  void quantise(const float* ends, std::uint16_t* out) const {
    for (std::size_t c = 0; c < 6; ++c) out[c] = place(ends[c], c % 3);
  }
  [[nodiscard]] bool meets(const float* ends) const {
    bool all = true;
    for (std::size_t a = 0; a < 3; ++a) all &= ends[a] <= box[3 + a] && box[a] <= ends[3 + a];
    return all;
  }
};

struct Groups {
  std::array<std::vector<float>, 6> ends;
  std::array<std::vector<std::uint16_t>, 6> small;
  std::vector<Frame> frames;
  std::size_t rows = 0;

  explicit Groups(std::span<const Aabb> boxes);
  void quantise();
  /// All hits between rows and groups; `Number` says of which width. Returns those that overlap.
  template <typename Number>
  std::size_t test(std::size_t& hits) const;
};

Groups::Groups(std::span<const Aabb> boxes) : rows(boxes.size()) {
  const std::vector<std::uint32_t> order = near_together(boxes);
  const std::size_t padded = (rows + kGroup - 1) / kGroup * kGroup;
  for (std::size_t c = 0; c < 6; ++c) {
    ends[c].assign(padded, c < 3 ? kInf : -kInf);
    small[c].assign(padded, c < 3 ? 0xFFFF : 0);
    for (std::size_t i = 0; i < rows; ++i) {
      const Aabb& box = boxes[order[i]];
      const auto axis = static_cast<Eigen::Index>(c % 3);
      ends[c][i] = c < 3 ? box.min[axis] : box.max[axis];
    }
  }
  for (std::size_t begin = 0; begin < padded; begin += kGroup) {
    Frame frame;
    for (std::size_t c = 0; c < 6; ++c) {
      const auto from = ends[c].begin() + static_cast<std::ptrdiff_t>(begin);
      const auto to = from + static_cast<std::ptrdiff_t>(kGroup);
      frame.box[c] = c < 3 ? *std::min_element(from, to) : *std::max_element(from, to);
    }
    for (std::size_t a = 0; a < 3; ++a) {
      frame.scale[a] = 65536.0F / std::max(frame.box[3 + a] - frame.box[a], 1e-30F);
    }
    frames.push_back(frame);
  }
}

void Groups::quantise() {
  for (std::size_t i = 0; i < rows; ++i) {
    float box[6];
    std::uint16_t places[6];
    for (std::size_t c = 0; c < 6; ++c) box[c] = ends[c][i];
    frames[i / kGroup].quantise(box, places);
    for (std::size_t c = 0; c < 6; ++c) small[c][i] = places[c];
  }
}

template <typename Number>
std::size_t Groups::test(std::size_t& hits) const {
  constexpr bool kFloat = std::is_same_v<Number, float>;
  std::array<const float*, 6> column;
  std::array<const std::uint16_t*, 6> small_column;
  for (std::size_t c = 0; c < 6; ++c) {
    column[c] = ends[c].data();
    small_column[c] = small[c].data();
  }
  std::array<std::uint32_t, kGroup + 32> found;
  std::size_t overlapping = 0;
  for (std::uint32_t r = 0; r < rows; ++r) {
    float box[6];
    for (std::size_t c = 0; c < 6; ++c) box[c] = column[c][r];
    for (std::size_t g = r / kGroup; g < frames.size(); ++g) {
      if (!frames[g].meets(box)) continue;
      std::size_t count = 0;
      if constexpr (kFloat) {
        count = meet(column.data(), box, g * kGroup, found.data());
      } else {
        std::uint16_t places[6];
        frames[g].quantise(box, places);
        count = meet(small_column.data(), places, g * kGroup, found.data());
      }
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t other = found[i];
        if (other <= r || other >= rows) continue;
        ++hits;
        bool met = true;
        for (std::size_t a = 0; a < 3 && !kFloat; ++a) {
          met &= column[a][other] <= box[3 + a] && box[a] <= column[3 + a][other];
        }
        overlapping += met ? 1U : 0U;
      }
    }
  }
  return overlapping;
}

}  // namespace

std::vector<BoxWidth> race_widths(std::span<const Aabb> boxes, std::size_t rounds) {
  Groups groups(boxes);
  std::vector<BoxWidth> widths{{"float", lanes_of_floats(), 0, 0, 24.0},
                               {"16 bit", lanes_of_16_bits(), 0, 0, 12.0}};
  for (std::size_t round = 0; round < rounds; ++round) {
    widths[0].hits = widths[1].hits = 0;
    const ThreadStopwatch float_clock;
    widths[0].overlapping = groups.test<float>(widths[0].hits);
    widths[0].test.push_back(float_clock.ms());
    const ThreadStopwatch make_clock;
    groups.quantise();
    widths[1].make.push_back(make_clock.ms());
    const ThreadStopwatch small_clock;
    widths[1].overlapping = groups.test<std::uint16_t>(widths[1].hits);
    widths[1].test.push_back(small_clock.ms());
  }
  return widths;
}

}  // namespace winnow::bench
