// Checks and conversions of arguments. See inputs.h.

#include "pipeline/python/inputs.h"

#include "core/numbers/rounding.h"

#include "pipeline/python/refusal.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <unordered_map>

namespace winnow::python {
namespace {

static_assert(std::endian::native == std::endian::little, "keys are read as 64-bit numbers");

/// The arguments of the calls in progress on this thread, in the order of their creation.
thread_local std::vector<const Input*> arguments;

/// Returns a shape as Python shows it; `count` is the number of entries, or empty for one entry.
[[nodiscard]] std::string shape_text(const std::string& count, std::span<const std::size_t> shape) {
  std::string text = count;
  for (const std::size_t extent : shape) {
    text += (text.empty() ? "" : ", ") + std::to_string(extent);
  }
  const bool is_short = shape.size() + (count.empty() ? 0 : 1) == 1;
  return "(" + text + (is_short ? ",)" : ")");
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

// --- Input -------------------------------------------------------------------------------------

Input::Input(const char* name) : name_(name) {
  arguments.push_back(this);
}

Input::~Input() {
  std::erase(arguments, this);
}

std::string Input::first_fault(Status status) {
  for (const Input* const input : arguments) {
    if (std::string text = input->fault(status); !text.empty()) return text;
  }
  return {};
}

void Input::expect(std::size_t count) {
  if (one_) {
    count_ = count;
    return repeat();
  }
  if (count_ == count) return;
  throw Refusal(Status::size_mismatch, std::string(name_) + ": expected " + std::to_string(count) +
                                           (count == 1 ? " entry" : " entries") + ", not " +
                                           std::to_string(count_));
}

std::string Input::place(std::size_t i) const {
  return one_ ? std::string(name_) : std::string(name_) + "[" + std::to_string(i) + "]";
}

void Input::refuse(const py::array& array, std::span<const std::size_t> shape) const {
  throw Refusal(Status::size_mismatch, std::string(name_) + ": expected shape " +
                                           shape_text("n", shape) + " or " + shape_text("", shape) +
                                           ", not " +
                                           py::cast<std::string>(py::str(array.attr("shape"))));
}

void expect_all(std::size_t count, std::initializer_list<Input*> inputs) {
  for (Input* const input : inputs) input->expect(count);
}

std::size_t agree(std::span<Input* const> inputs) {
  std::size_t count = 1;
  for (auto at = inputs.end(); at != inputs.begin();) {
    if (--at; !(*at)->is_one()) count = (*at)->count();
  }
  for (Input* const input : inputs) input->expect(count);
  return count;
}

// --- Numbers -----------------------------------------------------------------------------------

Numbers::Numbers(py::handle object, const char* name, std::initializer_list<std::size_t> shape,
                 Valid valid)
    : Input(name), array_(numbers_in(object, name)), valid_(valid) {
  const auto dimensions = static_cast<std::size_t>(array_.ndim());
  const bool one = dimensions == shape.size();
  const std::size_t outer = one ? 0 : 1;
  bool fits = dimensions == shape.size() + outer;
  for (std::size_t k = 0; fits && k < shape.size(); ++k) {
    const auto axis = static_cast<py::ssize_t>(k + outer);
    extent_[k] = std::data(shape)[k];
    fits = static_cast<std::size_t>(array_.shape(axis)) == extent_[k];
    if (fits) inner_[k] = array_.strides(axis);
  }
  if (!fits) refuse(array_, {std::data(shape), shape.size()});
  single_ = array_.itemsize() == 4;
  data_ = static_cast<const std::byte*>(array_.data());
  set(one ? 1 : static_cast<std::size_t>(array_.shape(0)), one);
  stride_ = one ? 0 : array_.strides(0);
}

bool Numbers::is_dense(std::size_t components) const noexcept {
  const auto size = static_cast<std::ptrdiff_t>(single_ ? sizeof(float) : sizeof(double));
  return inner_[0] == size && stride_ == static_cast<std::ptrdiff_t>(components) * size;
}

std::string Numbers::fault(Status status) const {
  if (status != Status::invalid_bounds && status != Status::invalid_shape &&
      status != Status::invalid_pose && status != Status::invalid_argument) {
    return {};
  }
  const bool has_components = extent_[0] * extent_[1] != 1;
  for (std::size_t i = 0; i < count(); ++i) {
    double least = std::numeric_limits<double>::infinity();
    double greatest = 0.0;
    for (std::size_t k = 0; k < extent_[0] * extent_[1]; ++k) {
      const double number = at(i, k / extent_[1], k % extent_[1]);
      if (std::isnan(number)) return place(i) + (has_components ? " has a NaN" : " is NaN");
      least = std::min(least, number);
      greatest = std::max(greatest, std::abs(number));
    }
    if (valid_ != Valid::any && std::isinf(greatest)) return place(i) + " is not finite";
    if (valid_ == Valid::length && least < 0.0) return place(i) + " is negative";
    if (valid_ == Valid::fraction && (least < 0.0 || greatest > 1.0)) {
      return place(i) + " is not in [0, 1]";
    }
    if (valid_ == Valid::direction && greatest == 0.0) return place(i) + " is zero";
  }
  return {};
}

// --- BoxInput ----------------------------------------------------------------------------------

BoxInput::BoxInput(py::handle lower, py::handle upper)
    : Input("lower"), lower_(lower, "lower", {3}), upper_(upper, "upper", {3}) {
  set(agree({&lower_, &upper_}), lower_.is_one() && upper_.is_one());
}

void BoxInput::repeat() {
  expect_all(count(), {&lower_, &upper_});
}

Aabb BoxInput::operator[](std::size_t i) const noexcept {
  Aabb box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.min[axis] = round_down(lower_.at(i, axis));
    box.max[axis] = round_up(upper_.at(i, axis));
  }
  return box;
}

bool BoxInput::is_in_place() const noexcept {
  return !is_one() && lower_.is_single() && upper_.is_single() &&
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
  for (std::size_t i = 0; i < n; ++i) room[i] = (*this)[i];
  return BoxView(std::span<const Aabb>(room));
}

std::string BoxInput::fault(Status status) const {
  if (status != Status::invalid_bounds) return {};
  for (std::size_t i = 0; i < count(); ++i) {
    const std::string upper = "upper" + place(i).substr(std::strlen(name()));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double low = lower_.at(i, axis);
      const double high = upper_.at(i, axis);
      if (std::isnan(low)) return place(i) + " has a NaN";
      if (std::isnan(high)) return upper + " has a NaN";
      if (low > high) return place(i) + " is above " + upper;
      if (low == high && std::isinf(low)) return place(i) + " and " + upper + " are at infinity";
    }
  }
  return {};
}

// --- integers ----------------------------------------------------------------------------------

namespace {

/// Converts integers that are of another type, or not contiguous, to T.
template <typename T>
[[nodiscard]] py::array converted(const py::array& array, const char* name, std::size_t columns) {
  const bool is_signed = array.dtype().kind() == 'i';
  const py::array wide = array.attr("astype")(is_signed ? "i8" : "u8", "C");
  py::array_t<T> result(std::vector<py::ssize_t>(wide.shape(), wide.shape() + wide.ndim()));
  const auto count = static_cast<std::size_t>(wide.size());
  T* const to = result.mutable_data();
  for (std::size_t i = 0; i < count; ++i) {
    std::uint64_t value = 0;
    std::memcpy(&value, static_cast<const std::byte*>(wide.data()) + 8 * i, 8);
    const bool negative = is_signed && value >> 63U != 0;
    if (negative || value > std::numeric_limits<T>::max()) {
      throw Refusal(Status::invalid_argument,
                    std::string(name) + "[" + std::to_string(i / columns) + "] is out of range");
    }
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
    : Input(name), array_(integers_in(object, name)), columns_(columns) {
  const std::span<const std::size_t> row(&columns, columns == 1 ? 0 : 1);
  const auto dimensions = static_cast<std::size_t>(array_.ndim());
  const bool one = dimensions == row.size();
  const bool fits = dimensions - row.size() <= 1 &&
                    (row.empty() || static_cast<std::size_t>(array_.shape(one ? 0 : 1)) == columns);
  if (!fits) refuse(array_, row);
  const bool is_dense = (array_.flags() & py::array::c_style) != 0;
  if (!(is_of(array_, 'u', sizeof(T)) && is_dense && is_native(array_))) {
    array_ = converted<T>(array_, name, columns);
  }
  set(one ? 1 : static_cast<std::size_t>(array_.shape(0)), one);
  values_ = {static_cast<const T*>(array_.data()), count() * columns};
}

template <typename T>
void Integers<T>::repeat() {
  const std::span<const T> row = values_.first(columns_);
  std::vector<T> all;
  for (std::size_t i = 0; i < count(); ++i) all.insert(all.end(), row.begin(), row.end());
  repeated_ = std::move(all);
  values_ = repeated_;
}

template <typename T>
std::string Integers<T>::fault(Status status) const {
  if (status != Status::invalid_argument) return {};
  for (std::size_t i = 0; i < values_.size(); ++i) {
    if (values_[i] >= limit_)
      return place(i / columns_) + " is not below " + std::to_string(limit_);
  }
  return {};
}

template class Integers<std::uint8_t>;
template class Integers<std::uint32_t>;
template class Integers<std::uint64_t>;

std::string KeyInput::fault(Status status) const {
  if (status != Status::invalid_key) return {};
  std::unordered_map<std::uint64_t, std::size_t> before;
  for (std::size_t i = 0; i < count(); ++i) {
    const Key key = keys()[i];
    if (!key) return place(i) + " is NULL_KEY";
    if (!is_live_(owner_, key)) return place(i) + " is of no object: it was removed, or is foreign";
    const auto [first, is_new] = before.emplace(values()[i], i);
    if (!is_new) return place(i) + " is the same as " + place(first->second);
  }
  return {};
}

EachInteger::EachInteger(py::handle object, const char* name, std::uint64_t most) : Input(name) {
  const Integers<std::uint64_t> words(object, name);
  set(words.count(), words.is_one());
  words_.assign(words.values().begin(), words.values().end());
  const auto bad = std::ranges::find_if(words_, [&](std::uint64_t word) { return word > most; });
  if (bad == words_.end()) return;
  throw Refusal(Status::invalid_argument,
                place(static_cast<std::size_t>(bad - words_.begin())) + " is out of range");
}

std::vector<ClientData> data_of(py::handle object, std::size_t count) {
  if (object.is_none()) return {};
  Integers<std::uint64_t> words(object, "data");
  words.expect(count);
  return {words.values().begin(), words.values().end()};
}

// --- PoseInput ---------------------------------------------------------------------------------

namespace {

[[nodiscard]] bool is_pair(py::handle object) {
  return py::isinstance<py::tuple>(object) && py::len(object) == 2;
}

/// Returns the array of positions, or of positions with quaternions.
[[nodiscard]] py::object positions_in(py::handle object, const char* name) {
  if (is_pair(object)) return py::reinterpret_borrow<py::tuple>(object)[0];
  return array_of(object, name);
}

/// True for poses of seven numbers.
[[nodiscard]] bool has_seven(py::handle object, const char* name) {
  if (is_pair(object)) return false;
  const py::array array = array_of(object, name);
  return array.ndim() != 0 && array.ndim() <= 2 && array.shape(array.ndim() - 1) == 7;
}

}  // namespace

PoseInput::PoseInput(py::handle object, const char* name)
    : Input(name),
      is_joined_(has_seven(object, name)),
      position_(positions_in(object, name), name, {is_joined_ ? 7U : 3U}) {
  set(position_.count(), position_.is_one());
  if (!is_pair(object)) return;
  turn_.emplace(py::reinterpret_borrow<py::tuple>(object)[1], "orientations",
                std::initializer_list<std::size_t>{4});
  set(agree({&position_, &*turn_}), position_.is_one() && turn_->is_one());
}

void PoseInput::repeat() {
  position_.expect(count());
  if (turn_) turn_->expect(count());
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
  const bool repeats = position_.is_one() || (turn_ && turn_->is_one());
  if (position_.is_single() || repeats) return PoseView(packed(room));
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

std::string PoseInput::fault(Status status) const {
  if (status != Status::invalid_pose) return {};
  for (std::size_t i = 0; i < count(); ++i) {
    const Pose pose = (*this)[i];
    if (pose.is_valid()) continue;
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) sum += std::abs(pose.position[k]);
    for (int k = 0; k < 4; ++k) sum += std::abs(pose.orientation[k]);
    const bool is_wrong_turn = std::isfinite(sum);
    return place(i) + (std::isnan(sum) ? " has a NaN"
                       : is_wrong_turn ? " has a quaternion of zeros"
                                       : " is not finite");
  }
  return {};
}

}  // namespace winnow::python
