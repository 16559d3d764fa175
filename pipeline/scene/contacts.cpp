// ContactFrame's columns, and the public interface of Contacts, which only reads them.
// Scene::collide fills them (contact_frame_writer.cpp).

#include <winnow/pipeline/contacts.h>

#include "core/memory/columns.h"
#include "core/memory/new_in.h"
#include "pipeline/narrow/tight_growth.h"
#include "pipeline/scene/contact_frame.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace winnow {
namespace {

template <typename T>
[[nodiscard]] std::span<const T> span_of(const Column<T>& column) noexcept {
  return {column.data(), column.size()};
}

template <typename T>
void copy_range(const Column<T>& from, std::size_t first, std::size_t count, Column<T>& to,
                std::size_t at) noexcept {
  if (!from.empty()) std::copy_n(from.data() + first, count, to.data() + at);
}

/// Returns all columns of a frame except its runs.
template <typename Frame>
[[nodiscard]] auto columns_of(Frame& f) noexcept {
  return std::tie(f.key[0], f.key[1], f.event, f.manifold_first, f.part[0], f.part[1], f.distance,
                  f.error_bound, f.normal[0], f.normal[1], f.normal[2], f.point[0], f.point[1],
                  f.point[2], f.point_first, f.points.position[0], f.points.position[1],
                  f.points.position[2], f.points.depth, f.points.feature);
}

/// Calls visit(column, same column of the other frame) for each, until one call returns false.
template <typename To, typename From, typename Visit, std::size_t... I>
bool for_both(const To& to, const From& from, Visit&& visit, std::index_sequence<I...>) noexcept {
  return (visit(std::get<I>(to), std::get<I>(from)) && ...);
}
template <typename From, typename Visit>
bool for_columns_of_both(ContactFrame& to, From& from, Visit&& visit) noexcept {
  const auto all = columns_of(to);
  return for_both(all, columns_of(from), visit,
                  std::make_index_sequence<std::tuple_size_v<decltype(all)>>{});
}

}  // namespace

ContactFrame::ContactFrame(std::pmr::memory_resource* memory) noexcept
    : runs(memory),
      key{Column<Key>(memory), Column<Key>(memory)},
      event(memory),
      manifold_first(memory),
      part{Column<std::uint32_t>(memory), Column<std::uint32_t>(memory)},
      distance(memory),
      error_bound(memory),
      normal{Column<double>(memory), Column<double>(memory), Column<double>(memory)},
      point{Column<double>(memory), Column<double>(memory), Column<double>(memory)},
      point_first(memory),
      points(memory) {}

template <typename Make>
bool ContactFrame::make_columns(ContactLevel level, bool parts, std::size_t pair_count,
                                std::size_t manifold_count, Make&& make) noexcept {
  const bool with_manifolds = level != ContactLevel::pairs;
  const bool with_points = level == ContactLevel::manifold;
  bool good = make(event, pair_count) && make(manifold_first, with_manifolds ? pair_count + 1 : 0);
  for (int side = 0; side < 2; ++side) {
    good = good && make(key[side], pair_count) && make(part[side], parts ? manifold_count : 0);
  }
  const std::size_t distances = level >= ContactLevel::distance ? manifold_count : 0;
  good = good && make(distance, distances) && make(error_bound, distances) &&
         make(point_first, with_points ? manifold_count + 1 : 0);
  for (int axis = 0; axis < 3; ++axis) {
    good = good && make(normal[axis], distances) &&
           make(point[axis], level == ContactLevel::distance ? manifold_count : 0);
  }
  return good;
}

bool ContactFrame::resize(ContactLevel level, std::size_t pair_count, std::size_t manifold_count,
                          std::size_t point_count) noexcept {
  const auto resize_one = [](auto& column, std::size_t count) {
    return resize_tightly(column, count);
  };
  if (!make_columns(level, with_parts, pair_count, manifold_count, resize_one) ||
      !points.grow(point_count)) {
    return false;
  }
  manifolds = manifold_count;
  points.set_size(point_count);
  return true;
}

bool ContactFrame::has_room(ContactLevel level, std::size_t pair_count, std::size_t manifold_count,
                            std::size_t point_count) const noexcept {
  return pair_count <= event.capacity() && (!with_parts || manifold_count <= part[0].capacity()) &&
         (level < ContactLevel::distance || manifold_count <= distance.capacity()) &&
         point_count <= points.depth.capacity();
}

bool ContactFrame::reserve(ContactLevel level, bool parts, std::size_t pair_count,
                           std::size_t manifold_count, std::size_t point_count,
                           Pages pages) noexcept {
  const auto reserve_one = [pages](auto& column, std::size_t count) {
    return column.reserve(count, pages);
  };
  const std::size_t most_runs = std::min<std::size_t>(pair_count, KindPairs::kCount);
  return runs.reserve(most_runs) &&
         make_columns(level, parts, pair_count, manifold_count, reserve_one) &&
         points.grow(point_count, pages);
}

bool ContactFrame::reserve_as(const ContactFrame& other) noexcept {
  return for_columns_of_both(*this, other, [](auto& column, const auto& model) {
    return column.reserve(model.capacity());
  });
}

void ContactFrame::clear() noexcept {
  runs.clear();
  std::apply([](auto&... column) { (column.clear(), ...); }, columns_of(*this));
  manifolds = 0;
}

void ContactFrame::swap(ContactFrame& other) noexcept {
  runs.swap(other.runs);
  for_columns_of_both(*this, other, [](auto& column, auto& of_other) {
    column.swap(of_other);
    return true;
  });
  std::swap(manifolds, other.manifolds);
  std::swap(with_parts, other.with_parts);
}

Bytes ContactFrame::bytes() const noexcept {
  return std::apply([&](const auto&... column) { return bytes_of(runs, column...); },
                    columns_of(*this));
}

ContactFrame::Cursor ContactFrame::extent(std::uint32_t first, std::uint32_t count) const noexcept {
  Cursor extent{count, 0, 0};
  if (manifold_first.empty()) return extent;
  const std::uint32_t begin = manifold_first[first];
  const std::uint32_t end = manifold_first[first + count];
  extent.manifold = end - begin;
  if (!point_first.empty()) extent.point = point_first[end] - point_first[begin];
  return extent;
}

void ContactFrame::copy(const ContactFrame& other, std::uint32_t first, std::uint32_t count,
                        const Cursor& to) noexcept {
  for (int side = 0; side < 2; ++side) {
    copy_range(other.key[side], first, count, key[side], to.pair);
  }
  copy_range(other.event, first, count, event, to.pair);
  if (other.manifold_first.empty()) {
    if (!manifold_first.empty()) std::fill_n(manifold_first.data() + to.pair, count, to.manifold);
    return;
  }
  const std::uint32_t begin = other.manifold_first[first];
  const std::uint32_t copied = other.manifold_first[first + count] - begin;
  for (std::uint32_t i = 0; i < count; ++i) {
    manifold_first[to.pair + i] = other.manifold_first[first + i] - begin + to.manifold;
  }
  for (int side = 0; with_parts && side < 2; ++side) {
    if (other.with_parts) {
      copy_range(other.part[side], begin, copied, part[side], to.manifold);
    } else {
      std::fill_n(part[side].data() + to.manifold, copied, kWholeShape);
    }
  }
  copy_range(other.distance, begin, copied, distance, to.manifold);
  copy_range(other.error_bound, begin, copied, error_bound, to.manifold);
  for (int axis = 0; axis < 3; ++axis) {
    copy_range(other.normal[axis], begin, copied, normal[axis], to.manifold);
    copy_range(other.point[axis], begin, copied, point[axis], to.manifold);
  }
  if (!other.point_first.empty()) copy_points(other, begin, copied, to);
}

void ContactFrame::copy_points(const ContactFrame& other, std::uint32_t first, std::uint32_t count,
                               const Cursor& to) noexcept {
  const std::uint32_t begin = other.point_first[first];
  const std::uint32_t number = other.point_first[first + count] - begin;
  for (std::uint32_t m = 0; m < count; ++m) {
    point_first[to.manifold + m] = other.point_first[first + m] - begin + to.point;
  }
  for (int axis = 0; axis < 3; ++axis) {
    copy_range(other.points.position[axis], begin, number, points.position[axis], to.point);
  }
  copy_range(other.points.depth, begin, number, points.depth, to.point);
  copy_range(other.points.feature, begin, number, points.feature, to.point);
}

void ContactFrame::close(ContactLevel level, const Cursor& end) noexcept {
  if (level != ContactLevel::pairs) manifold_first[end.pair] = end.manifold;
  if (level == ContactLevel::manifold) point_first[end.manifold] = end.point;
}

ContactsState::ContactsState(std::pmr::memory_resource* memory) noexcept
    : frame(memory),
      before(memory),
      ended(memory),
      records(memory),
      records_before(memory),
      known(memory),
      cached(memory),
      cached_before(memory),
      dormant(memory),
      dormant_records(memory),
      dormant_cached(memory),
      history(memory),
      old_record(memory),
      input(memory),
      source(memory),
      is_in_new_frame(memory),
      sums(memory) {}

void ContactsState::clear() noexcept {
  frame.clear();
  before.clear();
  dormant.clear();
  ended.clear();
  records.clear();
  known.clear();
  cached.clear();
  dormant_records.clear();
  dormant_cached.clear();
  history.clear();
  scene = 0;
  cached_count = 0;
}

Contacts::Contacts(std::pmr::memory_resource* memory) noexcept
    : memory_(memory), state_(new_in<ContactsState>(memory, memory)) {}

Contacts::~Contacts() {
  delete_in(memory_, state_);
}

const ContactsState& Contacts::state() const noexcept {
  static const ContactsState kNothing(std::pmr::null_memory_resource());
  return state_ != nullptr ? *state_ : kNothing;
}

ContactLevel Contacts::level() const noexcept {
  return state().level;
}

std::size_t Contacts::size() const noexcept {
  return state().frame.pairs();
}

std::span<const ContactRun> Contacts::runs() const noexcept {
  return span_of(state().frame.runs);
}

std::span<const Key> Contacts::a() const noexcept {
  return span_of(state().frame.key[0]);
}

std::span<const Key> Contacts::b() const noexcept {
  return span_of(state().frame.key[1]);
}

DataColumn Contacts::data_a() const noexcept {
  return {{a().data(), state().known.data.data()}, size()};
}

DataColumn Contacts::data_b() const noexcept {
  return {{b().data(), state().known.data.data()}, size()};
}

std::span<const ContactEvent> Contacts::event() const noexcept {
  return span_of(state().frame.event);
}

std::span<const EndedContact> Contacts::ended() const noexcept {
  return span_of(state().ended);
}

std::span<const std::uint32_t> Contacts::manifold_first() const noexcept {
  return span_of(state().frame.manifold_first);
}

std::size_t Contacts::manifolds() const noexcept {
  return state().frame.manifolds;
}

PartColumn Contacts::part_a() const noexcept {
  const ContactFrame& frame = state().frame;
  return {{frame.with_parts ? frame.part[0].data() : nullptr}, frame.manifolds};
}

PartColumn Contacts::part_b() const noexcept {
  const ContactFrame& frame = state().frame;
  return {{frame.with_parts ? frame.part[1].data() : nullptr}, frame.manifolds};
}

std::span<const double> Contacts::distance() const noexcept {
  return span_of(state().frame.distance);
}

std::span<const double> Contacts::error_bound() const noexcept {
  return span_of(state().frame.error_bound);
}

std::span<const double> Contacts::normal(int axis) const noexcept {
  return span_of(state().frame.normal[axis]);
}

std::span<const double> Contacts::point(int axis) const noexcept {
  return span_of(state().frame.point[axis]);
}

std::span<const std::uint32_t> Contacts::point_first() const noexcept {
  return span_of(state().frame.point_first);
}

std::size_t Contacts::points() const noexcept {
  return state().frame.points.size();
}

const ContactColumns& Contacts::contact_columns() const noexcept {
  return state().frame.points;
}

ContactPoint Contacts::contact(std::size_t point) const noexcept {
  const ContactColumns& points = state().frame.points;
  return {{points.position[0][point], points.position[1][point], points.position[2][point]},
          points.depth[point],
          points.feature[point]};
}

std::span<const std::uint32_t> Contacts::previous_pair() const noexcept {
  return span_of(state().history.pair);
}

std::span<const std::uint32_t> Contacts::previous_point() const noexcept {
  return span_of(state().history.point);
}

std::size_t Contacts::cached_pairs() const noexcept {
  return state().cached_count;
}

void Contacts::clear() noexcept {
  if (state_ != nullptr) state_->clear();
}

Footprint Contacts::footprint() const noexcept {
  Footprint footprint;
  if (state_ == nullptr) return footprint;
  const ContactsState& s = *state_;
  footprint.structure = {sizeof(ContactsState), sizeof(ContactsState)};
  footprint.results += s.frame.bytes();
  footprint.results += s.ended.bytes();
  footprint.results += bytes_of(s.history.pair, s.history.point);
  for (const Bytes& bytes :
       {s.before.bytes(), s.dormant.bytes(), s.records.bytes(), s.records_before.bytes(),
        s.known.bytes(), s.cached.bytes(), s.cached_before.bytes(), s.dormant_records.bytes(),
        s.dormant_cached.bytes(), s.old_record.bytes(), s.input.bytes(), s.source.bytes(),
        s.is_in_new_frame.bytes(), s.sums.bytes(), s.history.taken.bytes(),
        s.history.pose.bytes()}) {
    footprint.scratch += bytes;
  }
  return footprint;
}

ContactPoint detail::PointLookup::operator()(std::size_t i) const noexcept {
  return contacts->contact(first + i);
}

namespace {

/// Returns entry i of a column, or zero if the level has no such column.
[[nodiscard]] double entry(std::span<const double> column, std::size_t i) noexcept {
  return column.empty() ? 0.0 : column[i];
}

/// Range i of a column of first entries; empty if the level has no such column.
template <typename Lookup>
[[nodiscard]] IndexedView<Lookup> range_of(const Contacts& contacts,
                                           std::span<const std::uint32_t> first,
                                           std::size_t i) noexcept {
  if (first.empty()) return {Lookup{&contacts, 0}, 0};
  return {Lookup{&contacts, first[i]}, first[i + 1] - first[i]};
}

}  // namespace

ContactManifold::ContactManifold(const Contacts& contacts, std::uint32_t index) noexcept
    : IndexedView(range_of<detail::PointLookup>(contacts, contacts.point_first(), index)),
      index_(index) {}

double ContactManifold::distance() const noexcept {
  return entry(lookup().contacts->distance(), index_);
}
double ContactManifold::error_bound() const noexcept {
  return entry(lookup().contacts->error_bound(), index_);
}
Vec3d ContactManifold::normal() const noexcept {
  const Contacts& contacts = *lookup().contacts;
  return {entry(contacts.normal(0), index_), entry(contacts.normal(1), index_),
          entry(contacts.normal(2), index_)};
}
Vec3d ContactManifold::point() const noexcept {
  const Contacts& contacts = *lookup().contacts;
  return {entry(contacts.point(0), index_), entry(contacts.point(1), index_),
          entry(contacts.point(2), index_)};
}
std::uint32_t ContactManifold::part_a() const noexcept {
  return lookup().contacts->part_a()[index_];
}
std::uint32_t ContactManifold::part_b() const noexcept {
  return lookup().contacts->part_b()[index_];
}

ContactPair::ContactPair(const Contacts& contacts, std::size_t index) noexcept
    : IndexedView(range_of<detail::ManifoldLookup>(contacts, contacts.manifold_first(), index)),
      index_(index) {}

Key ContactPair::a() const noexcept {
  return lookup().contacts->a()[index_];
}
Key ContactPair::b() const noexcept {
  return lookup().contacts->b()[index_];
}
ClientData ContactPair::data_a() const noexcept {
  return lookup().contacts->data_a()[index_];
}
ClientData ContactPair::data_b() const noexcept {
  return lookup().contacts->data_b()[index_];
}
ContactEvent ContactPair::event() const noexcept {
  return lookup().contacts->event()[index_];
}

}  // namespace winnow
