#pragma once

// Arguments of calls: numpy arrays as winnow's views. Every file with calls on arrays uses this;
// inputs.cpp implements it.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <winnow/core/filter.h>
#include <winnow/core/key.h>
#include <winnow/core/pose.h>
#include <winnow/core/status.h>
#include <winnow/core/volumes.h>

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace winnow::python {

namespace py = pybind11;

/// An argument of a call: entries that belong to the entries of the other arguments by index. A
/// single entry without an index, such as a number or a point, is repeated.
class Input {
 public:
  virtual ~Input();
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  /// True if a single entry is used for all.
  [[nodiscard]] bool is_one() const noexcept { return one_; }
  /// Throws a size_mismatch unless there are `count` entries; repeats a single entry.
  void expect(std::size_t count);

  /// Describes the first entry because of which a call was refused, such as "poses[17] has a NaN",
  /// by the arguments of the call that is in progress on this thread; empty if none explains it.
  [[nodiscard]] static std::string first_fault(Status status);

 protected:
  explicit Input(const char* name);

  void set(std::size_t count, bool one) noexcept {
    count_ = count;
    one_ = one;
  }
  [[nodiscard]] const char* name() const noexcept { return name_; }
  /// The name of entry i in messages.
  [[nodiscard]] std::string place(std::size_t i) const;
  /// Throws a size_mismatch that states the shapes of one entry and of many.
  [[noreturn]] void refuse(const py::array& array, std::span<const std::size_t> shape) const;

 private:
  virtual void repeat() {}
  [[nodiscard]] virtual std::string fault(Status) const { return {}; }

  const char* name_;
  std::size_t count_ = 0;
  bool one_ = false;
};

/// Expects `count` entries in each of these: see Input::expect.
void expect_all(std::size_t count, std::initializer_list<Input*> inputs);
/// Expects the same number of entries in all of these and returns it; repeats single entries.
std::size_t agree(std::span<Input* const> inputs);
inline std::size_t agree(std::initializer_list<Input*> inputs) {
  return agree(std::span<Input* const>(std::data(inputs), inputs.size()));
}

/// Valid values of numbers; messages name the first number that has none. No number may be NaN.
enum class Valid { any, finite, length, direction, fraction };

/// An array of float or double numbers, read in place: any strides, but aligned entries in native
/// byte order. Other types that convert to double without loss are converted.
class Numbers : public Input {
 public:
  /// Expects any number of entries of `shape`, an array with one dimension more than `shape`, or a
  /// single entry, whose stride is 0. `name` is for messages.
  Numbers(py::handle object, const char* name, std::initializer_list<std::size_t> shape,
          Valid valid = Valid::any);

  [[nodiscard]] bool is_single() const noexcept { return single_; }
  [[nodiscard]] std::ptrdiff_t stride() const noexcept { return stride_; }
  /// Component (j, k) of the first entry. T must be float if `is_single`, else double.
  template <typename T>
  [[nodiscard]] const T* column(std::size_t j, std::size_t k = 0) const noexcept {
    return reinterpret_cast<const T*>(data_ + static_cast<std::ptrdiff_t>(j) * inner_[0] +
                                      static_cast<std::ptrdiff_t>(k) * inner_[1]);
  }
  /// Component (j, k) of entry i.
  [[nodiscard]] double at(std::size_t i, std::size_t j = 0, std::size_t k = 0) const noexcept {
    const std::byte* const p = data_ + static_cast<std::ptrdiff_t>(i) * stride_ +
                               static_cast<std::ptrdiff_t>(j) * inner_[0] +
                               static_cast<std::ptrdiff_t>(k) * inner_[1];
    if (single_) return to_double(*reinterpret_cast<const float*>(p));
    return *reinterpret_cast<const double*>(p);
  }
  /// The first three components of entry i.
  [[nodiscard]] Vec3d vector(std::size_t i) const noexcept {
    return {at(i, 0), at(i, 1), at(i, 2)};
  }
  /// True if entries and components are contiguous.
  [[nodiscard]] bool is_dense(std::size_t components) const noexcept;

 private:
  [[nodiscard]] std::string fault(Status status) const override;

  py::array array_;
  const std::byte* data_ = nullptr;
  std::ptrdiff_t stride_ = 0;
  std::ptrdiff_t inner_[2] = {0, 0};
  std::size_t extent_[2] = {1, 1};
  bool single_ = false;
  Valid valid_;
};

/// Boxes given as lower and upper corners, (n, 3) each.
class BoxInput : public Input {
 public:
  BoxInput(py::handle lower, py::handle upper);

  /// Box i, rounded outward.
  [[nodiscard]] Aabb operator[](std::size_t i) const noexcept;
  /// True if the arrays can be used without a copy: both of float, with one stride.
  [[nodiscard]] bool is_in_place() const noexcept;
  /// Returns a view; other arrays are rounded outward into `room`. Needs no GIL.
  [[nodiscard]] BoxView view(std::vector<Aabb>& room) const;

 private:
  void repeat() override;
  [[nodiscard]] std::string fault(Status status) const override;

  Numbers lower_;
  Numbers upper_;
};

/// A contiguous array of integers of type T, with one dimension, or with two and `columns` in each
/// row; or a single entry. Other integers are copied if they are in the range of T.
template <typename T>
class Integers : public Input {
 public:
  Integers(py::handle object, const char* name, std::size_t columns = 1);

  /// Count times columns numbers.
  [[nodiscard]] std::span<const T> values() const noexcept { return values_; }
  [[nodiscard]] T operator[](std::size_t i) const noexcept { return values_[i]; }
  /// States, for messages, that the numbers have to be below `limit`.
  void limit(std::size_t limit) noexcept { limit_ = limit; }

 private:
  void repeat() override;
  [[nodiscard]] std::string fault(Status status) const override;

  py::array array_;
  std::vector<T> repeated_;
  std::span<const T> values_;
  std::size_t columns_;
  std::size_t limit_ = ~std::size_t{0};
};
extern template class Integers<std::uint8_t>;
extern template class Integers<std::uint32_t>;
extern template class Integers<std::uint64_t>;

/// Keys as uint64: the id in the lower half, the stamp in the upper half.
class KeyInput : public Integers<std::uint64_t> {
 public:
  /// `owner` is the partition, scene or sensors that the keys belong to: has_key(owner, key) is
  /// called if the call was refused, with the GIL and without locks.
  template <typename Owner>
  KeyInput(const Owner& owner, py::handle object, const char* name = "keys")
      : Integers(object, name), owner_(&owner), is_live_([](const void* of, Key key) {
          return has_key(*static_cast<const Owner*>(of), key);
        }) {}
  [[nodiscard]] std::span<const Key> keys() const noexcept {
    return {reinterpret_cast<const Key*>(values().data()), count()};
  }

 private:
  [[nodiscard]] std::string fault(Status status) const override;

  const void* owner_;
  bool (*is_live_)(const void* owner, Key key);
};

/// An integer for each of n entries: an array, or one number for all.
class EachInteger : public Input {
 public:
  EachInteger(py::handle object, const char* name, std::uint64_t most);
  [[nodiscard]] std::uint64_t operator[](std::size_t i) const noexcept {
    return words_[is_one() ? 0 : i];
  }

 private:
  std::vector<std::uint64_t> words_;
};

/// Filters of objects as three columns.
class FilterInput {
 public:
  FilterInput(py::handle layers, py::handle mask, py::handle environment)
      : layers_(layers, "layers", kMaxMask),
        mask_(mask, "mask", kMaxMask),
        environment_(environment, "environment", kMaxMask) {}
  void expect(std::size_t count) { expect_all(count, {&layers_, &mask_, &environment_}); }
  [[nodiscard]] ObjectFilter operator[](std::size_t i) const noexcept {
    return {static_cast<std::uint32_t>(layers_[i]), static_cast<std::uint32_t>(mask_[i]),
            static_cast<std::uint32_t>(environment_[i])};
  }

 private:
  static constexpr std::uint64_t kMaxMask = 0xFFFFFFFFU;
  EachInteger layers_;
  EachInteger mask_;
  EachInteger environment_;
};

/// Poses: (n, 7) with x, y, z and a quaternion w, x, y, z; (n, 3) positions only; or a tuple of
/// positions (n, 3) and quaternions (n, 4).
class PoseInput : public Input {
 public:
  explicit PoseInput(py::handle object, const char* name = "poses");

  [[nodiscard]] Pose operator[](std::size_t i) const noexcept;
  /// Returns a view of the arrays if positions are of double, else of copies in `room`.
  [[nodiscard]] PoseView view(std::vector<Pose>& room) const;
  /// Returns the array itself if it is (n, 7), of double and contiguous, else copies in `room`.
  [[nodiscard]] std::span<const Pose> packed(std::vector<Pose>& room) const;

 private:
  void repeat() override;
  [[nodiscard]] std::string fault(Status status) const override;

  /// Quaternions are columns 3 to 6 of `position_`; otherwise they are in `turn_`, or there are
  /// none.
  bool is_joined_;
  Numbers position_;
  std::optional<Numbers> turn_;
};

/// Client data: none, or a number for each object.
[[nodiscard]] std::vector<ClientData> data_of(py::handle object, std::size_t count);

}  // namespace winnow::python
