// Checks and conversions of numpy arrays, and the cache of memory blocks for large results. See
// arrays.h.

#include "pipeline/python/arrays.h"

#include "pipeline/python/refusal.h"

#include <winnow/core/volumes.h>

#include <bit>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <mutex>
#include <new>

namespace winnow::python {
namespace {

static_assert(std::endian::native == std::endian::little, "keys are read as 64-bit numbers");

[[nodiscard]] std::string shape_text(const std::vector<std::size_t>& shape, bool one) {
  const auto list = [&](std::string text) {
    for (const std::size_t extent : shape) {
      text += (text.empty() ? "" : ", ") + std::to_string(extent);
    }
    return "(" + text + (text == "n" ? ",)" : ")");
  };
  return one && !shape.empty() ? list("n") + " or " + list("") : list("n");
}

[[nodiscard]] std::string shape_text(const py::array& array) {
  return py::cast<std::string>(py::str(array.attr("shape")));
}

[[nodiscard]] py::array array_of(py::handle object, const char* name) {
  py::array array = py::array::ensure(object);
  if (!array) {
    PyErr_Clear();
    throw py::type_error(std::string(name) + ": not an array of numbers");
  }
  return array;
}

[[nodiscard]] bool is_native(const py::array& array) {
  return (array.flags() & py::detail::npy_api::NPY_ARRAY_ALIGNED_) != 0 &&
         py::detail::array_descriptor_proxy(array.dtype().ptr())->byteorder != '>';
}

[[nodiscard]] bool is_of(const py::array& array, char kind, py::ssize_t size) {
  return array.dtype().kind() == kind && array.itemsize() == size;
}

[[nodiscard]] std::string kind_text(const py::array& array) {
  return py::cast<std::string>(py::str(array.dtype()));
}

/// Returns the array itself if it is aligned and of float or double, else a copy in double.
[[nodiscard]] py::array numbers_in(py::handle object, const char* name) {
  py::array array = array_of(object, name);
  const char kind = array.dtype().kind();
  const bool is_real = (kind == 'f' && array.itemsize() <= 8) || kind == 'i' || kind == 'u';
  if (!is_real) {
    throw py::type_error(std::string(name) + ": expected numbers in float or double, not " +
                         kind_text(array));
  }
  if (is_native(array) && (is_of(array, 'f', 4) || is_of(array, 'f', 8))) return array;
  // Float stays float: the caller has rounded it already.
  return array.attr("astype")(is_of(array, 'f', 4) ? "f4" : "f8");
}

}  // namespace

Numbers::Numbers(py::handle object, const char* name, const std::vector<std::size_t>& shape,
                 bool one)
    : array_(numbers_in(object, name)), name_(name) {
  const auto dimensions = static_cast<std::size_t>(array_.ndim());
  one_ = one && dimensions == shape.size();
  const std::size_t outer = one_ ? 0 : 1;
  bool fits = dimensions == shape.size() + outer;
  for (std::size_t k = 0; fits && k < shape.size(); ++k) {
    const auto axis = static_cast<py::ssize_t>(k + outer);
    fits = static_cast<std::size_t>(array_.shape(axis)) == shape[k];
    if (fits) inner_[k] = array_.strides(axis);
  }
  if (!fits) {
    throw Refusal(Status::size_mismatch, std::string(name) + ": expected shape " +
                                             shape_text(shape, one) + ", not " +
                                             shape_text(array_));
  }
  single_ = array_.itemsize() == 4;
  data_ = static_cast<const std::byte*>(array_.data());
  count_ = one_ ? 1 : static_cast<std::size_t>(array_.shape(0));
  stride_ = one_ ? 0 : array_.strides(0);
}

void Numbers::expect(std::size_t count) {
  if (one_) count_ = count;
  if (count_ == count) return;
  throw Refusal(Status::size_mismatch, std::string(name_) + " has " + std::to_string(count_) +
                                           " entries, not " + std::to_string(count));
}

bool Numbers::is_dense(std::size_t components) const noexcept {
  const auto size = static_cast<std::ptrdiff_t>(single_ ? sizeof(float) : sizeof(double));
  return inner_[0] == size && stride_ == static_cast<std::ptrdiff_t>(components) * size;
}

BoxInput::BoxInput(py::handle lower, py::handle upper)
    : lower_(lower, "lower", {3}), upper_(upper, "upper", {3}) {
  upper_.expect(lower_.count());
}

bool BoxInput::is_in_place() const noexcept {
  return lower_.is_single() && upper_.is_single() &&
         (lower_.stride() == upper_.stride() || lower_.count() < 2);
}

BoxView BoxInput::view(std::vector<Aabb>& room) const {
  const std::size_t n = count();
  if (is_in_place()) {
    return {{lower_.column<float>(0), lower_.column<float>(1), lower_.column<float>(2)},
            {upper_.column<float>(0), upper_.column<float>(1), upper_.column<float>(2)},
            n,
            static_cast<std::size_t>(lower_.stride())};
  }
  room.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto k = axis;
      room[i].min[k] = round_down(lower_.at(i, axis));
      room[i].max[k] = round_up(upper_.at(i, axis));
    }
  }
  return BoxView(std::span<const Aabb>(room));
}

namespace {

/// Converts integers that are of another type, or not contiguous, to T.
template <typename T>
[[nodiscard]] py::array converted(const py::array& array, const char* name) {
  const auto out_of_range = [&] {
    throw Refusal(Status::invalid_argument, std::string(name) + ": a number is out of range");
  };
  const bool is_signed = array.dtype().kind() == 'i';
  const py::array wide = array.attr("astype")(is_signed ? "i8" : "u8", "C");
  py::array_t<T> result(std::vector<py::ssize_t>(wide.shape(), wide.shape() + wide.ndim()));
  const auto count = static_cast<std::size_t>(wide.size());
  T* const to = result.mutable_data();
  for (std::size_t i = 0; i < count; ++i) {
    std::uint64_t value = 0;
    std::memcpy(&value, static_cast<const std::byte*>(wide.data()) + 8 * i, 8);
    const bool negative = is_signed && value >> 63U != 0;
    if (negative || value > std::numeric_limits<T>::max()) out_of_range();
    to[i] = static_cast<T>(value);
  }
  return result;
}

[[nodiscard]] py::array integers_in(py::handle object, const char* name) {
  py::array array = array_of(object, name);
  const char kind = array.dtype().kind();
  // numpy converts an empty list to an array of double.
  if (array.size() == 0 && kind == 'f') return array.attr("astype")("u8");
  if (kind == 'i' || kind == 'u') return array;
  throw py::type_error(std::string(name) + ": expected whole numbers, not " + kind_text(array));
}

}  // namespace

template <typename T>
Integers<T>::Integers(py::handle object, const char* name, std::size_t columns)
    : array_(integers_in(object, name)) {
  const bool fits =
      columns == 1 ? array_.ndim() == 1
                   : array_.ndim() == 2 && static_cast<std::size_t>(array_.shape(1)) == columns;
  if (!fits) {
    const std::string expected = columns == 1 ? "(n,)" : "(n, " + std::to_string(columns) + ")";
    throw Refusal(Status::size_mismatch, std::string(name) + ": expected shape " + expected +
                                             ", not " + shape_text(array_));
  }
  const bool is_dense = (array_.flags() & py::array::c_style) != 0;
  if (!(is_of(array_, 'u', sizeof(T)) && is_dense && is_native(array_))) {
    array_ = converted<T>(array_, name);
  }
  count_ = static_cast<std::size_t>(array_.shape(0));
  values_ = {static_cast<const T*>(array_.data()), count_ * columns};
}

template class Integers<std::uint8_t>;
template class Integers<std::uint32_t>;
template class Integers<std::uint64_t>;

EachInteger::EachInteger(py::handle object, const char* name, std::uint64_t most) : name_(name) {
  const py::array array = integers_in(object, name);
  const py::array flat = array.ndim() == 0 ? py::array(array.attr("reshape")(1)) : array;
  const Integers<std::uint64_t> words(flat, name);
  one_ = array.ndim() == 0;
  for (const std::uint64_t word : words.values()) {
    if (word > most) {
      throw Refusal(Status::invalid_argument, std::string(name) + ": a number is out of range");
    }
  }
  if (one_) {
    all_ = words[0];
  } else {
    words_.assign(words.values().begin(), words.values().end());
  }
}

void EachInteger::expect(std::size_t count) const {
  if (one_ || words_.size() == count) return;
  throw Refusal(Status::size_mismatch, std::string(name_) + " has " +
                                           std::to_string(words_.size()) + " entries, not " +
                                           std::to_string(count));
}

namespace {

/// Returns the array of positions.
[[nodiscard]] py::object positions_in(py::handle object) {
  if (py::isinstance<py::tuple>(object) && py::len(object) == 2) {
    return py::reinterpret_borrow<py::tuple>(object)[0];
  }
  return array_of(object, "poses");
}

[[nodiscard]] bool has_seven(py::handle array) {
  return py::isinstance<py::array>(array) && py::reinterpret_borrow<py::array>(array).ndim() == 2 &&
         py::reinterpret_borrow<py::array>(array).shape(1) == 7;
}

}  // namespace

PoseInput::PoseInput(py::handle object)
    : position_(positions_in(object), "poses",
                {!py::isinstance<py::tuple>(object) && has_seven(positions_in(object)) ? 7U : 3U}) {
  if (py::isinstance<py::tuple>(object) && py::len(object) == 2) {
    turn_.emplace(py::reinterpret_borrow<py::tuple>(object)[1], "orientations",
                  std::vector<std::size_t>{4});
    turn_->expect(position_.count());
  } else {
    is_joined_ = has_seven(positions_in(object));
  }
}

Pose PoseInput::operator[](std::size_t i) const noexcept {
  Pose pose;
  for (std::size_t k = 0; k < 3; ++k) pose.position[k] = position_.at(i, k);
  for (std::size_t k = 0; k < 4; ++k) {
    if (is_joined_) pose.orientation[k] = position_.at(i, 3 + k);
    if (turn_) pose.orientation[k] = turn_->at(i, k);
  }
  return pose;
}

PoseView PoseInput::view(std::vector<Pose>& room) const {
  if (position_.is_single()) return PoseView(packed(room));
  PoseView view;
  view.count = count();
  view.position = {position_.column<double>(0), position_.column<double>(1),
                   position_.column<double>(2)};
  view.position_stride = static_cast<std::size_t>(position_.stride());
  for (std::size_t k = 0; k < 4; ++k) {
    if (is_joined_) view.orientation[k] = position_.column<double>(3 + k);
    if (turn_ && turn_->is_single()) view.orientation_float[k] = turn_->column<float>(k);
    if (turn_ && !turn_->is_single()) view.orientation[k] = turn_->column<double>(k);
  }
  view.orientation_stride = static_cast<std::size_t>(turn_ ? turn_->stride() : position_.stride());
  return view;
}

std::span<const Pose> PoseInput::packed(std::vector<Pose>& room) const {
  if (is_joined_ && !position_.is_single() && position_.is_dense(7)) {
    return {reinterpret_cast<const Pose*>(position_.column<double>(0)), count()};
  }
  room.resize(count());
  for (std::size_t i = 0; i < room.size(); ++i) room[i] = (*this)[i];
  return room;
}

std::vector<ClientData> data_of(py::handle object, std::size_t count) {
  if (object.is_none()) return {};
  const Integers<std::uint64_t> words(object, "data");
  if (words.count() != count) {
    throw Refusal(Status::size_mismatch, "data has " + std::to_string(words.count()) +
                                             " entries, not " + std::to_string(count));
  }
  return {words.values().begin(), words.values().end()};
}

namespace {

/// Unused blocks, the oldest first.
class WaitingBlocks {
 public:
  struct Block {
    void* memory;
    std::size_t bytes;
  };

  /// Returns the smallest block that is large enough, but at most about twice as large; a null
  /// block if there is none.
  [[nodiscard]] Block take(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    auto best = waiting_.end();
    for (auto at = waiting_.begin(); at != waiting_.end(); ++at) {
      const bool fits = at->bytes >= bytes && at->bytes / 2 <= bytes;
      if (fits && (best == waiting_.end() || at->bytes < best->bytes)) best = at;
    }
    if (best == waiting_.end()) return {nullptr, 0};
    const Block taken = *best;
    waiting_.erase(best);
    held_ -= taken.bytes;
    return taken;
  }
  void put(Block block) noexcept {
    const std::lock_guard lock(mutex_);
    if (block.bytes > kMaxBytes || !has_room_) {
      std::free(block.memory);
      return;
    }
    while (waiting_.size() == kMaxBlocks || held_ + block.bytes > kMaxBytes) {
      std::free(waiting_.front().memory);
      held_ -= waiting_.front().bytes;
      waiting_.erase(waiting_.begin());
    }
    waiting_.push_back(block);
    held_ += block.bytes;
  }
  void reserve() {
    const std::lock_guard lock(mutex_);
    if (has_room_) return;
    waiting_.reserve(kMaxBlocks);
    has_room_ = true;
  }

 private:
  static constexpr std::size_t kMaxBlocks = 16;
  static constexpr std::size_t kMaxBytes = std::size_t{128} << 20U;

  std::mutex mutex_;
  std::vector<Block> waiting_;
  std::size_t held_ = 0;
  bool has_room_ = false;
};

// Never destroyed: arrays may outlive all other objects of the module.
WaitingBlocks& waiting_blocks() {
  static auto* const blocks = new WaitingBlocks;
  return *blocks;
}

}  // namespace

std::pair<void*, py::capsule> BlockCache::take(std::size_t bytes) {
  using Block = WaitingBlocks::Block;
  waiting_blocks().reserve();
  auto held = std::make_unique<Block>(waiting_blocks().take(bytes));
  if (held->memory == nullptr) *held = {std::malloc(bytes), bytes};
  if (held->memory == nullptr) throw std::bad_alloc();
  void* const memory = held->memory;
  py::capsule owner(held.get(), [](void* p) {
    const std::unique_ptr<Block> back(static_cast<Block*>(p));
    waiting_blocks().put(*back);
  });
  static_cast<void>(held.release());
  return {memory, std::move(owner)};
}

}  // namespace winnow::python
