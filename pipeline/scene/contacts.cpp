#include <winnow/pipeline/contacts.h>
#include "pipeline/scene/contact_frame.h"

#include <new>

namespace winnow {
namespace {

template <typename T>
[[nodiscard]] std::span<const T> span_of(const Column<T>& column) noexcept {
  return {column.data(), column.size()};
}

}  // namespace

Contacts::State::State(std::pmr::memory_resource* memory) noexcept
    : frame(memory),
      before(memory),
      ended(memory),
      records(memory),
      records_before(memory),
      carried(memory),
      carried_before(memory),
      dormant(memory),
      dormant_records(memory),
      dormant_carried(memory),
      old_record(memory),
      source(memory),
      origin(memory),
      shown_again(memory),
      sums(memory) {}

void Contacts::State::clear() noexcept {
  frame.clear();
  before.clear();
  dormant.clear();
  ended.clear();
  records.clear();
  carried.clear();
  dormant_records.clear();
  dormant_carried.clear();
  scene = 0;
  carried_count = 0;
}

Contacts::Contacts(std::pmr::memory_resource* memory) : state_(new State(memory)) {}

Contacts::~Contacts() {
  delete state_;
}

SceneLevel Contacts::level() const noexcept {
  return state_->level;
}

std::size_t Contacts::size() const noexcept {
  return state_->frame.pairs();
}

std::span<const ContactRun> Contacts::runs() const noexcept {
  return span_of(state_->frame.runs);
}

std::span<const Key> Contacts::a() const noexcept {
  return span_of(state_->frame.key[0]);
}

std::span<const Key> Contacts::b() const noexcept {
  return span_of(state_->frame.key[1]);
}

std::span<const ClientData> Contacts::data_a() const noexcept {
  return span_of(state_->frame.data[0]);
}

std::span<const ClientData> Contacts::data_b() const noexcept {
  return span_of(state_->frame.data[1]);
}

std::span<const ContactEvent> Contacts::event() const noexcept {
  return span_of(state_->frame.event);
}

std::span<const EndedContact> Contacts::ended() const noexcept {
  return span_of(state_->ended);
}

std::span<const std::uint32_t> Contacts::manifold_first() const noexcept {
  return span_of(state_->frame.manifold_first);
}

std::size_t Contacts::manifolds() const noexcept {
  return state_->frame.manifolds();
}

std::span<const std::uint32_t> Contacts::part_a() const noexcept {
  return span_of(state_->frame.part[0]);
}

std::span<const std::uint32_t> Contacts::part_b() const noexcept {
  return span_of(state_->frame.part[1]);
}

std::span<const double> Contacts::distance() const noexcept {
  return span_of(state_->frame.distance);
}

std::span<const double> Contacts::error_bound() const noexcept {
  return span_of(state_->frame.error_bound);
}

std::span<const double> Contacts::normal(int axis) const noexcept {
  return span_of(state_->frame.normal[axis]);
}

std::span<const double> Contacts::point(int axis) const noexcept {
  return span_of(state_->frame.point[axis]);
}

std::span<const std::uint32_t> Contacts::point_first() const noexcept {
  return span_of(state_->frame.point_first);
}

std::size_t Contacts::points() const noexcept {
  return state_->frame.points.size();
}

ContactPoint Contacts::contact(std::size_t point) const noexcept {
  const ContactColumns& points = state_->frame.points;
  return {{points.position[0][point], points.position[1][point], points.position[2][point]},
          points.depth[point],
          points.feature[point]};
}

std::size_t Contacts::carried() const noexcept {
  return state_->carried_count;
}

void Contacts::clear() noexcept {
  state_->clear();
}

Footprint Contacts::footprint() const noexcept {
  const State& s = *state_;
  Footprint footprint;
  footprint.results += s.frame.bytes();
  footprint.results += s.ended.bytes();
  for (const Bytes& bytes :
       {s.before.bytes(), s.dormant.bytes(), s.records.bytes(), s.records_before.bytes(),
        s.carried.bytes(), s.carried_before.bytes(), s.dormant_records.bytes(),
        s.dormant_carried.bytes(), s.old_record.bytes(), s.source.bytes(), s.origin.bytes(),
        s.shown_again.bytes(), s.sums.bytes()}) {
    footprint.scratch += bytes;
  }
  return footprint;
}

}  // namespace winnow
