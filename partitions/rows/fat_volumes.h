#pragma once

// Volumes that are stored larger by a margin (fat AABBs), so that small motions leave the stored
// volume unchanged. FatSource wraps a source of volume_source.h; volume_update.cpp uses it.
// Included by source files, not by headers.

#include <winnow/core/volumes.h>
#include "core/memory/volume_columns.h"
#include "partitions/rows/box_compare.kernel.h"
#include "partitions/rows/row_input.h"
#include "partitions/rows/volume_source.h"

#include <algorithm>
#include <bit>
#include <cfloat>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace winnow {

/// Rows whose given boxes are gathered before they are compared: 16 cache lines per column.
inline constexpr std::size_t kRowsAtOnce = 256;

/// True if a margin leaves volumes as given.
[[nodiscard]] inline bool is_none(const FatMargin& margin) noexcept {
  return !(margin.distance > 0.0F) && !(margin.share > 0.0F);
}

/// Returns the margin with each member replaced by a finite value that is not negative.
[[nodiscard]] inline FatMargin legal(const FatMargin& margin) noexcept {
  const auto of = [](float value) { return value > 0.0F ? std::min(value, FLT_MAX) : 0.0F; };
  return {of(margin.distance), of(margin.share)};
}

/// Returns the margin of an object whose longest finite edge is `edge`; may be infinite. Requires a
/// result of `legal`.
[[nodiscard]] inline float margin_at(const FatMargin& margin, float edge) noexcept {
  return margin.distance + margin.share * edge;
}

/// Growth of boxes and k-DOPs by a margin.
template <Volume V>
struct FatSlabs {
  static constexpr std::size_t kColumns = column_count(V);
  static constexpr std::size_t kSlabs = slab_count(V);

  /// Returns the margin of the volume in `given`.
  static float margin_of(const float* given, const FatMargin& margin) noexcept {
    float edge = 0.0F;
    for (std::size_t s = 0; s < 3; ++s) {
      const float low = given[low_column(kSlabs, s)];
      const float high = given[high_column(kSlabs, s)];
      const bool finite = (low > -FLT_MAX) & (high < FLT_MAX) & (high - low <= FLT_MAX);
      edge = std::max(edge, finite ? high - low : 0.0F);
    }
    return margin_at(margin, edge);
  }

  /// True if the stored volume contains the given one, and each slab is at most four margins
  /// longer.
  static bool still_fits(const float* given, float margin, const float* stored) noexcept {
    bool ok = true;
    for (std::size_t s = 0; s < kSlabs; ++s) {
      const float low = given[low_column(kSlabs, s)];
      const float high = given[high_column(kSlabs, s)];
      const float stored_low = stored[low_column(kSlabs, s)];
      const float stored_high = stored[high_column(kSlabs, s)];
      const float most = high - low + 4.0F * margin * length(s);
      ok &= (stored_low <= low) & (high <= stored_high) & (stored_high - stored_low <= most);
    }
    return ok;
  }

  static void grow(float* volume, float margin) noexcept {
    for (std::size_t s = 0; s < kSlabs; ++s) {
      const double by = static_cast<double>(margin) * static_cast<double>(length(s));
      float& low = volume[low_column(kSlabs, s)];
      float& high = volume[high_column(kSlabs, s)];
      low = std::max(round_down(static_cast<double>(low) - by), -FLT_MAX);
      high = std::min(round_up(static_cast<double>(high) + by), FLT_MAX);
    }
  }

 private:
  /// Length of the direction of a slab (see kdop_directions), rounded up.
  static constexpr float length(std::size_t s) noexcept {
    if (s < 3) return 1.0F;
    const bool corner = V != Volume::kdop18 && s < 7;
    return corner ? 1.7320509F : 1.4142137F;
  }
};

/// Growth of spheres by a margin.
struct FatSphere {
  static constexpr std::size_t kColumns = column_count(Volume::sphere);

  static float margin_of(const float* given, const FatMargin& margin) noexcept {
    return std::min(margin_at(margin, std::min(2.0F * given[kRadiusColumn], FLT_MAX)), FLT_MAX);
  }
  static bool still_fits(const float* given, float margin, const float* stored) noexcept {
    const double room =
        static_cast<double>(stored[kRadiusColumn]) - static_cast<double>(given[kRadiusColumn]);
    double square = 0.0;
    for (std::size_t c = kCenterColumn; c < kCenterColumn + 3; ++c) {
      const double d = static_cast<double>(stored[c]) - static_cast<double>(given[c]);
      square += d * d;
    }
    // The factor exceeds the rounding errors of both squares.
    return room >= 0.0 && room <= 2.0 * static_cast<double>(margin) &&
           square <= room * room * (1.0 - 1e-14);
  }
  static void grow(float* volume, float margin) noexcept {
    const double radius = static_cast<double>(volume[kRadiusColumn]) + static_cast<double>(margin);
    const Sphere grown{
        {volume[kCenterColumn], volume[kCenterColumn + 1], volume[kCenterColumn + 2]},
        std::min(round_up(radius), FLT_MAX)};
    float* columns[kColumns];
    for (std::size_t c = 0; c < kColumns; ++c) columns[c] = volume + c;
    write_sphere(columns, 0, grown);
  }
};

template <Volume V>
struct FatVolume : FatSlabs<V> {};
template <>
struct FatVolume<Volume::sphere> : FatSphere {};

/// Writes the volumes of another source enlarged by a margin, but keeps a stored volume for which
/// `still_fits` is true.
template <typename Source>
struct FatSource {
  static constexpr Volume kVolume = Source::kVolume;
  using Fat = FatVolume<kVolume>;

  const Source& source;
  FatMargin margin;

  void write(std::size_t i, ColumnPointers columns, std::size_t row) const noexcept {
    Values given(source, i);
    Fat::grow(given.value, Fat::margin_of(given.value, margin));
    for (std::size_t c = 0; c < Fat::kColumns; ++c) columns[c][row] = given.value[c];
  }

  /// Writes nothing and returns false if the stored volume need not change.
  bool write_if_departed(std::size_t i, ColumnPointers columns, std::size_t row) const noexcept {
    Values given(source, i);
    float stored[Fat::kColumns];
    for (std::size_t c = 0; c < Fat::kColumns; ++c) stored[c] = columns[c][row];
    const float by = Fat::margin_of(given.value, margin);
    if (Fat::still_fits(given.value, by, stored)) return false;
    Fat::grow(given.value, by);
    // If the margin is smaller than the rounding error, `still_fits` may be false although the
    // object did not move. The grown volume then equals the stored one.
    if (std::equal(stored, stored + Fat::kColumns, given.value)) return false;
    for (std::size_t c = 0; c < Fat::kColumns; ++c) columns[c][row] = given.value[c];
    return true;
  }

 private:
  /// One entry of the source as a row of columns.
  struct Values {
    float value[Fat::kColumns];
    Values(const Source& source, std::size_t i) noexcept {
      float* columns[Fat::kColumns];
      for (std::size_t c = 0; c < Fat::kColumns; ++c) columns[c] = value + c;
      source.write(i, columns, 0);
    }
  };
};

/// For up to 256 rows from `begin` on: writes the boxes that no longer fit their stored boxes and
/// sets the bits of these rows in `departed`. Tests 16 boxes at a time, because most stay within.
inline void write_departed_boxes(const FatSource<BoxSource>& fat, const EntryOfRow& entries,
                                 ColumnPointers columns, std::size_t begin, std::size_t end,
                                 std::uint64_t* departed) noexcept {
  const BoxSource& source = fat.source;
  alignas(64) float given[6][kRowsAtOnce];
  float* given_columns[6];
  const float* stored[6];
  for (std::size_t c = 0; c < 6; ++c) {
    given_columns[c] = given[c];
    stored[c] = columns[c] + begin;
  }
  std::size_t written = 0;
  if (source.packed()) {
    written = (end - begin) / kBlockRows * kBlockRows;
    source.write_rows(entries.entry_of_id, entries.id + begin, given_columns, 0, written);
  }
  std::uint64_t has_entry[kRowsAtOnce / 64] = {};
  for (std::size_t k = 0; k < end - begin; ++k) {
    const std::size_t i = entries[begin + k];
    has_entry[k / 64] |= std::uint64_t{i != kNoObject} << (k % 64);
    if (k >= written && i != kNoObject) source.write(i, given_columns, k);
  }
  std::uint64_t within[kRowsAtOnce / 64] = {};
  box_compare_kernels().within(given_columns, stored, end - begin, fat.margin.distance,
                               fat.margin.share, within);
  for (std::size_t w = 0; w < kRowsAtOnce / 64; ++w) {
    for (std::uint64_t out = has_entry[w] & ~within[w]; out != 0; out &= out - 1) {
      const std::size_t k = 64 * w + static_cast<std::size_t>(std::countr_zero(out));
      if (!fat.write_if_departed(entries[begin + k], columns, begin + k)) continue;
      departed[begin / 64 + w] |= std::uint64_t{1} << (k % 64);
    }
  }
}

/// As above for any volume and the rows [begin, end); `begin` is a multiple of 256.
template <typename Source>
void write_departed_rows(const FatSource<Source>& fat, const EntryOfRow& entries,
                         ColumnPointers columns, std::size_t begin, std::size_t end,
                         std::uint64_t* departed) noexcept {
  for (std::size_t row = begin; row < end; row += kRowsAtOnce) {
    const std::size_t behind = std::min(end, row + kRowsAtOnce);
    if constexpr (std::is_same_v<Source, BoxSource>) {
      write_departed_boxes(fat, entries, columns, row, behind, departed);
    } else {
      for (std::size_t r = row; r < behind; ++r) {
        const std::size_t i = entries[r];
        if (i == kNoObject || !fat.write_if_departed(i, columns, r)) continue;
        departed[r / 64] |= std::uint64_t{1} << (r % 64);
      }
    }
  }
}

}  // namespace winnow
