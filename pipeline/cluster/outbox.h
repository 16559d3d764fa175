#pragma once

#include <winnow/core/aabb.h>
#include <winnow/pipeline/cluster_transport.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace winnow {

/// What one rank tells others of bodies: such as they are to hold, and such as they hold no more.
/// The columns of a parcel are, in this order, names and boxes of bodies, whether each belongs to
/// the receiver (1) or is a copy (0), and names of what is gone.
class BodyOutbox {
 public:
  void clear() noexcept {
    held_.clear();
    gone_.clear();
  }
  void tell(std::uint32_t to, std::uint64_t name, const Aabb& box, bool belongs) {
    held_.push_back({to, belongs, name, box});
  }
  void tell_gone(std::uint32_t to, std::uint64_t name) { gone_.push_back({to, name}); }

  /// Adds one parcel for each receiver, which look at columns of this.
  void pack(std::uint32_t from, std::vector<Parcel>& parcels);

 private:
  struct Held {
    std::uint32_t to;
    bool belongs;
    std::uint64_t name;
    Aabb box;
  };
  struct Gone {
    std::uint32_t to;
    std::uint64_t name;
  };

  std::vector<Held> held_;
  std::vector<Gone> gone_;
  std::vector<std::uint64_t> names_;
  std::vector<Aabb> boxes_;
  std::vector<std::uint8_t> belongs_;
  std::vector<std::uint64_t> gone_names_;
};

/// A parcel of a BodyOutbox as its receiver reads it.
struct BodyNews {
  explicit BodyNews(const Parcel& parcel) noexcept;

  std::span<const std::uint64_t> names;
  std::span<const Aabb> boxes;
  std::span<const std::uint8_t> belongs;
  std::span<const std::uint64_t> gone;
};

/// A column of a parcel, as elements.
template <typename T>
[[nodiscard]] std::span<const T> column_of(const Parcel& parcel, std::size_t column) noexcept {
  const std::span<const std::byte> bytes = parcel.columns[column];
  return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
}

}  // namespace winnow
