// Writes the contacts of a batch into the frame: tasks count the contacts of their pairs, and once
// there is room for all, each task writes its own range of the columns. Collision (collide.cpp)
// calls this.

#include "pipeline/scene/collision.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace winnow {
namespace {

/// Headroom, so that later batches that have slightly more contacts need no new allocation.
constexpr double kProjectionSlack = 1.02;

}  // namespace

bool ContactFrameWriter::open() {
  ContactsState& c = contacts_;
  if (reads_last_manifolds()) {
    c.frame.swap(c.before);
  } else {
    // May have contents from a call at another level.
    c.before.clear();
  }
  c.frame.with_parts = scene_.has_composites();
  return c.frame.resize(call_.level, 0, 0, 0);
}

bool ContactFrameWriter::write_batch(Cursor& end) {
  ContactsState& c = contacts_;
  const std::size_t tasks = call_.task_count();
  if (!c.sums.resize(tasks)) return false;
  call_.for_tasks([&](std::size_t task, std::uint32_t first, std::uint32_t last) {
    c.sums[task] = count(first, last);
  });
  for (std::size_t task = 0; task < tasks; ++task) {
    const Cursor taken = std::exchange(c.sums[task], end);
    end += taken;
  }
  if (!grow_frame(end)) return false;
  call_.for_tasks([&](std::size_t task, std::uint32_t first, std::uint32_t last) {
    write_task(first, last, c.sums[task]);
  });
  return true;
}

// Resizes the frame to `end`. If it has to grow, reserves for the remaining batches too, on the
// assumption that they have as many contacts per pair.
bool ContactFrameWriter::grow_frame(const Cursor& end) {
  ContactsState& c = contacts_;
  ContactFrame& frame = c.frame;
  const bool has_room = frame.has_room(call_.level, end.pair, end.manifold, end.point);
  if (!has_room && call_.batch_end < call_.pair_count()) {
    const auto projected = [&](std::uint32_t taken) {
      const double all = static_cast<double>(taken) * call_.pair_count() / call_.batch_end;
      return static_cast<std::size_t>(all * kProjectionSlack);
    };
    if (!frame.reserve(call_.level, frame.with_parts, projected(end.pair), projected(end.manifold),
                       projected(end.point), Pages::untouched)) {
      return false;
    }
  }
  return frame.resize(call_.level, end.pair, end.manifold, end.point) && cache_.grow_history();
}

bool ContactFrameWriter::close(const Cursor& end) {
  ContactsState& c = contacts_;
  c.frame.close(call_.level, end);
  // The next call swaps the frames and may find as many contacts.
  return (!reads_last_manifolds() || c.before.reserve_as(c.frame)) && write_runs();
}

// Returns the number of pairs from this one on that are cached and whose contacts are
// adjacent in the last frame, so that they are copied in one piece. Pairs not in contact do not
// interrupt the range.
std::uint32_t ContactFrameWriter::count_cached(std::uint32_t pair,
                                               std::uint32_t end) const noexcept {
  std::uint32_t at = pair;
  std::uint32_t next = kNoEntry;
  for (; at < end && call_.source_of(at) == ContactSource::cached; ++at) {
    const std::uint32_t index = cache_.index_before(at);
    if (index == kNoEntry) continue;
    if (next != kNoEntry && index != next) break;
    next = index + 1;
  }
  return at - pair;
}

// Returns the size of the new contacts of a pair with a composite shape; 0 if it is not in contact.
ContactFrame::Cursor ContactFrameWriter::composite_extent(std::uint32_t pair) const noexcept {
  Cursor sum;
  if (call_.reduces) {
    const auto regions = scene_.batch.parts->regions.of(call_.input_of(pair));
    for (const ContactRegion& region : regions) sum += {0, 1, region.count};
    sum.pair = regions.empty() ? 0 : 1;
    return sum;
  }
  const std::uint32_t* const first = scene_.batch.parts->pairs.first.data() + call_.input_of(pair);
  const NarrowResult& answers = scene_.batch.parts->answers;
  for (std::uint32_t i = first[0]; i < first[1]; ++i) {
    const std::uint32_t at = scene_.batch.parts->slot[i];
    if (!touches(answers, at)) continue;
    sum += {1, 1, call_.level == ContactLevel::manifold ? answers.contact_count()[at] : 0U};
  }
  if (sum.pair != 0) sum.pair = 1;
  return sum;
}

namespace {

/// The range of pairs in contact within a range of cached pairs.
struct Touching {
  std::uint32_t first = kNoEntry;
  std::uint32_t count = 0;

  void take(std::uint32_t index) noexcept {
    if (index == kNoEntry) return;
    if (first == kNoEntry) first = index;
    ++count;
  }
};

}  // namespace

// Returns the size of the contacts of pairs [first, end).
ContactFrame::Cursor ContactFrameWriter::count(std::uint32_t first,
                                               std::uint32_t end) const noexcept {
  if (call_.level == ContactLevel::pairs) return {end - first, 0, 0};
  Cursor sum;
  for (std::uint32_t i = first; i < end;) {
    if (is_fresh_convex(i)) {
      // Without a branch, because contact is unpredictable.
      const std::uint32_t at = call_.input_of(i++);
      const std::uint32_t touching = touches(scene_.batch.answers, at) ? 1 : 0;
      const std::uint32_t points =
          call_.level == ContactLevel::manifold ? scene_.batch.answers.contact_count()[at] : 0;
      sum += {touching, touching, touching * points};
      continue;
    }
    const std::uint32_t cached = count_cached(i, end);
    if (cached == 0) {
      sum += composite_extent(i++);
      continue;
    }
    Touching touching;
    for (const std::uint32_t last = i + cached; i < last; ++i)
      touching.take(cache_.index_before(i));
    if (touching.count != 0) sum += contacts_.before.extent(touching.first, touching.count);
  }
  return sum;
}

// Writes pairs [first, end) and their records.
void ContactFrameWriter::write_task(std::uint32_t first, std::uint32_t end, Cursor at) noexcept {
  if (call_.level == ContactLevel::pairs) return write_all(first, end, at.pair);
  ContactsState& c = contacts_;
  for (std::uint32_t i = first; i < end;) {
    if (is_fresh_convex(i)) {
      const std::uint32_t convex = i;
      while (i < end && is_fresh_convex(i)) ++i;
      write_convex(convex, i, at);
      continue;
    }
    const std::uint32_t cached = count_cached(i, end);
    if (cached == 0) {
      const Cursor taken = composite_extent(i);
      if (taken.pair != 0) write_composite(i, at);
      if (call_.uses_cache) cache_.remember(i, taken.pair != 0 ? at.pair : kNoEntry);
      at += taken;
      ++i;
      continue;
    }
    Touching touching;
    for (const std::uint32_t last = i + cached; i < last; ++i) {
      const std::uint32_t index = cache_.index_before(i);
      cache_.remember(i, index == kNoEntry ? kNoEntry : at.pair + touching.count);
      touching.take(index);
    }
    if (touching.count == 0) continue;
    c.frame.copy(c.before, touching.first, touching.count, at);
    std::fill_n(c.frame.event.data() + at.pair, touching.count, ContactEvent::persisted);
    std::fill_n(c.is_in_new_frame.data() + touching.first, touching.count, std::uint8_t{1});
    for (std::uint32_t k = 0; call_.stores_positions && k < touching.count; ++k) {
      c.history.pair[at.pair + k] = cache_.previous_pair_of(touching.first + k);
    }
    at += c.before.extent(touching.first, touching.count);
  }
}

// Writes keys and events of pairs that are in contact and not cached.
void ContactFrameWriter::write_bodies(std::span<const std::uint32_t> pairs,
                                      std::uint32_t to) noexcept {
  ContactsState& c = contacts_;
  ContactFrame& frame = c.frame;
  for (const std::uint32_t pair : pairs) scene_.keys.fetch(scene_.pairs[pair].b);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::size_t at = to + i;
    const BodyPair bodies = scene_.pairs[pairs[i]];
    const std::uint32_t index = cache_.index_before(pairs[i]);
    bool persists = index != kNoEntry;
    const std::uint32_t ids[2] = {bodies.a, bodies.b};
    for (int side = 0; side < 2; ++side) {
      const Key key = scene_.keys.key_of(ids[side]);
      frame.key[side][at] = key;
      persists = persists && c.known.key(ids[side]) == key;
    }
    frame.event[at] = persists ? ContactEvent::persisted : ContactEvent::begun;
    if (persists) c.is_in_new_frame[index] = 1;
    if (call_.stores_positions)
      c.history.pair[at] = persists ? cache_.previous_pair_of(index) : kNoContact;
  }
}

// Writes pairs [first, end), at most one task's, at level pairs.
void ContactFrameWriter::write_all(std::uint32_t first, std::uint32_t end,
                                   std::uint32_t to) noexcept {
  std::uint32_t pairs[CollideCall::kPairsPerTask];
  std::iota(pairs, pairs + (end - first), first);
  write_bodies({pairs, end - first}, to);
}

// Writes the pairs of [first, end) that are in contact, column by column: bodies, events and parts
// here, results by write_answers. All are convex and not cached; at most one task's pairs.
void ContactFrameWriter::write_convex(std::uint32_t first, std::uint32_t end, Cursor& at) noexcept {
  std::uint32_t touching[CollideCall::kPairsPerTask];
  std::uint32_t count = 0;
  for (std::uint32_t i = first; i < end; ++i) {
    const bool is_touching = touches(scene_.batch.answers, call_.input_of(i));
    if (call_.uses_cache) cache_.remember(i, is_touching ? at.pair + count : kNoEntry);
    touching[count] = i;
    count += is_touching ? 1 : 0;
  }
  ContactFrame& frame = contacts_.frame;
  write_bodies({touching, count}, at.pair);
  for (std::uint32_t i = 0; i < count; ++i) {
    frame.manifold_first[at.pair + i] = at.manifold + i;
  }
  for (Column<std::uint32_t>& part : frame.part) {
    if (frame.with_parts) std::fill_n(part.data() + at.manifold, count, kWholeShape);
  }
  write_answers({touching, count}, at);
}

// Writes the results of the narrow phase for convex pairs in contact, and advances `at`.
void ContactFrameWriter::write_answers(std::span<const std::uint32_t> pairs, Cursor& at) noexcept {
  const auto count = static_cast<std::uint32_t>(pairs.size());
  const auto copy = [&](std::span<const double> from, Column<double>& to) {
    double* const out = to.data() + at.manifold;
    for (std::uint32_t i = 0; i < count; ++i) out[i] = from[call_.input_of(pairs[i])];
  };
  const NarrowResult& answers = scene_.batch.answers;
  ContactFrame& frame = contacts_.frame;
  if (call_.level >= ContactLevel::distance) {
    copy(answers.distance(), frame.distance);
    copy(answers.error_bound(), frame.error_bound);
    for (int k = 0; k < 3; ++k) copy(answers.normal(k), frame.normal[k]);
  }
  if (call_.level == ContactLevel::distance) {
    for (int k = 0; k < 3; ++k) copy(answers.point(k), frame.point[k]);
  }
  for (std::uint32_t i = 0; call_.level == ContactLevel::manifold && i < count; ++i) {
    frame.point_first[at.manifold + i] = at.point;
    write_points(answers, call_.input_of(pairs[i]), nullptr, at.point);
  }
  at.pair += count;
  at.manifold += count;
}

// Writes a pair with a composite shape that is in contact and not cached.
void ContactFrameWriter::write_composite(std::uint32_t pair, const Cursor& to) noexcept {
  write_bodies({&pair, 1}, to.pair);
  ContactFrame& frame = contacts_.frame;
  frame.manifold_first[to.pair] = to.manifold;
  Cursor at = to;
  if (call_.reduces) {
    for (const ContactRegion& region : scene_.batch.parts->regions.of(call_.input_of(pair))) {
      write_region(region, at);
    }
    return;
  }
  const PrimitivePairs& parts = scene_.batch.parts->pairs;
  const std::uint32_t* const first = parts.first.data() + call_.input_of(pair);
  for (std::uint32_t i = first[0]; i < first[1]; ++i) {
    const std::uint32_t answer = scene_.batch.parts->slot[i];
    if (!touches(scene_.batch.parts->answers, answer)) continue;
    const BodyPair primitives = parts.pairs[i];
    frame.part[0][at.manifold] = parts.part[primitives.a];
    frame.part[1][at.manifold] = parts.part[primitives.b];
    write_manifold(scene_.batch.parts->answers, answer, parts.poses[primitives.a].position.data(),
                   at);
  }
}

// Writes the result of a pair of primitives; `offset` is the position of a's primitive relative to
// body a.
void ContactFrameWriter::write_manifold(const NarrowResult& answers, std::size_t at,
                                        const double* offset, Cursor& to) noexcept {
  ContactFrame& frame = contacts_.frame;
  if (call_.level >= ContactLevel::distance) {
    frame.distance[to.manifold] = answers.distance()[at];
    frame.error_bound[to.manifold] = answers.error_bound()[at];
    for (int k = 0; k < 3; ++k) {
      frame.normal[k][to.manifold] = answers.normal(k)[at];
      if (call_.level == ContactLevel::distance) {
        frame.point[k][to.manifold] = answers.point(k)[at] + offset[k];
      }
    }
  }
  if (call_.level == ContactLevel::manifold) {
    frame.point_first[to.manifold] = to.point;
    write_points(answers, at, offset, to.point);
  }
  ++to.manifold;
}

// Writes the points of a result; `offset` is null if body a is convex.
void ContactFrameWriter::write_points(const NarrowResult& answers, std::size_t at,
                                      const double* offset, std::uint32_t& to) noexcept {
  ContactColumns& points = contacts_.frame.points;
  const ContactColumns& from = answers.contact_columns();
  const std::uint32_t first = answers.contact_first()[at];
  const std::uint32_t end = first + answers.contact_count()[at];
  for (std::uint32_t i = first; i < end; ++i, ++to) {
    for (int k = 0; k < 3; ++k) {
      const float p = from.position[k][i];
      points.position[k][to] =
          offset == nullptr ? p : static_cast<float>(static_cast<double>(p) + offset[k]);
    }
    points.depth[to] = from.depth[i];
    points.feature[to] = from.feature[i];
  }
}

void ContactFrameWriter::write_region(const ContactRegion& region, Cursor& to) noexcept {
  ContactFrame& frame = contacts_.frame;
  for (int side = 0; side < 2; ++side) frame.part[side][to.manifold] = region.part[side];
  frame.distance[to.manifold] = region.distance;
  frame.error_bound[to.manifold] = region.error_bound;
  for (int k = 0; k < 3; ++k) frame.normal[k][to.manifold] = region.normal[k];
  frame.point_first[to.manifold] = to.point;
  for (const ContactPoint& point : std::span(region.point, region.count)) {
    for (int k = 0; k < 3; ++k) frame.points.position[k][to.point] = point.position[k];
    frame.points.depth[to.point] = point.depth;
    frame.points.feature[to.point] = point.feature;
    ++to.point;
  }
  ++to.manifold;
}

// Writes the runs of pairs that have the same two shape kinds.
bool ContactFrameWriter::write_runs() {
  ContactFrame& frame = contacts_.frame;
  frame.runs.clear();
  const auto run_at = [&](std::uint32_t i) {
    const auto kind = [&](int side) {
      return static_cast<std::uint8_t>(scene_.shape[frame.key[side][i].id].kind_index());
    };
    return ContactRun{kind(0), kind(1), i, 0};
  };
  const auto pairs = static_cast<std::uint32_t>(frame.pairs());
  for (std::uint32_t first = 0; first < pairs;) {
    ContactRun run = run_at(first);
    // Finds the end of the run by binary search.
    std::uint32_t end = first + 1;
    for (std::uint32_t last = pairs; end < last;) {
      const std::uint32_t middle = end + (last - end) / 2;
      const ContactRun other = run_at(middle);
      const bool alike = other.kind_a == run.kind_a && other.kind_b == run.kind_b;
      (alike ? end : last) = alike ? middle + 1 : middle;
    }
    run.count = end - first;
    if (!frame.runs.push_back(run)) return false;
    first = end;
  }
  return true;
}

}  // namespace winnow
