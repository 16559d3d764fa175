// The frame of contacts: its size is counted by tasks, then each writes its own stretch.

#include <winnow/pipeline/scene/collision.h>

#include <limits>

namespace winnow {

bool Collision::touches(const NarrowResult& answers, std::size_t at) const noexcept {
  return level_ == SceneLevel::boolean ? answers.overlaps(at)
                                       : answers.distance()[at] <= scene_.options.margin;
}

// What a pair takes in the frame: nothing if it does not touch.
ContactFrame::Place Collision::extent(std::uint32_t pair) const noexcept {
  if (level_ == SceneLevel::pairs) return {1, 0, 0};
  const auto points = [&](const NarrowResult& answers, std::size_t at) {
    return level_ == SceneLevel::manifold ? answers.contact_count()[at] : 0U;
  };
  switch (static_cast<Origin>(contacts_.origin[pair])) {
    case Origin::carried: {
      const std::uint32_t record = same_pairs_ ? pair : contacts_.old_record[pair];
      const std::uint32_t shown = contacts_.records_before[record].shown;
      return shown == kNone ? Place{} : contacts_.before.extent(shown);
    }
    case Origin::convex: {
      const std::uint32_t at = scene_.slot[contacts_.source[pair]];
      if (!touches(scene_.answers, at)) return {};
      return {1, 1, points(scene_.answers, at)};
    }
    case Origin::composite: {
      Place sum;
      const std::uint32_t* const first = scene_.parts.first.data() + contacts_.source[pair];
      for (std::uint32_t i = first[0]; i < first[1]; ++i) {
        const std::uint32_t at = scene_.parts_slot[i];
        if (touches(scene_.parts_answers, at)) sum += {1, 1, points(scene_.parts_answers, at)};
      }
      if (sum.pair != 0) sum.pair = 1;
      return sum;
    }
  }
  return {};
}

bool Collision::show() {
  Contacts::State& c = contacts_;
  const std::size_t tasks = task_count();
  if (!c.sums.resize(tasks + 1) || !c.shown_again.resize(c.before.pairs())) return false;
  std::fill(c.shown_again.begin(), c.shown_again.end(), std::uint8_t{0});
  for_tasks([&](std::size_t task, std::uint32_t first, std::uint32_t end) {
    Place sum;
    for (std::uint32_t i = first; i < end; ++i) sum += extent(i);
    c.sums[task] = sum;
  });
  Place end;
  for (std::size_t task = 0; task <= tasks; ++task) {
    const Place count = task < tasks ? c.sums[task] : Place{};
    c.sums[task] = end;
    end += count;
  }
  const std::size_t records = carries_ ? pair_count() : end.pair;
  if (!c.frame.resize(level_, end.pair, end.manifold, end.point) || !c.records.resize(records) ||
      !c.carried.resize(carries_ ? records : 0)) {
    return false;
  }
  for_tasks([&](std::size_t task, std::uint32_t first, std::uint32_t last) {
    Place at = c.sums[task];
    for (std::uint32_t i = first; i < last; ++i) {
      const Place taken = extent(i);
      if (taken.pair != 0) write(i, at);
      if (taken.pair != 0 || carries_) remember(i, taken.pair != 0 ? at.pair : kNone);
      at += taken;
    }
  });
  c.frame.close(level_, end);
  return write_runs();
}

// Writes a pair that touches, and says whether it did before.
void Collision::write(std::uint32_t pair, const Place& to) noexcept {
  Contacts::State& c = contacts_;
  ContactFrame& frame = c.frame;
  const BodyPair bodies = scene_.pairs.pairs()[pair];
  const std::uint32_t record = same_pairs_ ? pair : c.old_record[pair];
  const std::uint32_t shown = record == kNone ? kNone : c.records_before[record].shown;
  const bool carried =
      level_ != SceneLevel::pairs && static_cast<Origin>(c.origin[pair]) == Origin::carried;
  if (carried) frame.copy(c.before, shown, to);
  const std::uint32_t ids[2] = {bodies.a, bodies.b};
  bool persists = shown != kNone;
  for (int side = 0; side < 2; ++side) {
    frame.key[side][to.pair] = scene_.keys.key_of(ids[side]);
    frame.data[side][to.pair] = scene_.keys.client_data(ids[side]);
    persists = persists && c.before.key[side][shown] == frame.key[side][to.pair];
  }
  frame.event[to.pair] = persists ? ContactEvent::persisted : ContactEvent::begun;
  if (persists) c.shown_again[shown] = 1;
  if (carried || level_ == SceneLevel::pairs) return;
  frame.manifold_first[to.pair] = to.manifold;
  Place at = to;
  if (static_cast<Origin>(c.origin[pair]) == Origin::convex) {
    frame.part[0][at.manifold] = frame.part[1][at.manifold] = kWholeShape;
    write_manifold(scene_.answers, scene_.slot[c.source[pair]], nullptr, at);
    return;
  }
  const PrimitivePairs& parts = scene_.parts;
  const std::uint32_t* const first = parts.first.data() + c.source[pair];
  for (std::uint32_t i = first[0]; i < first[1]; ++i) {
    const std::uint32_t answer = scene_.parts_slot[i];
    if (!touches(scene_.parts_answers, answer)) continue;
    const BodyPair primitives = parts.pairs[i];
    frame.part[0][at.manifold] = parts.part[primitives.a];
    frame.part[1][at.manifold] = parts.part[primitives.b];
    write_manifold(scene_.parts_answers, answer, parts.poses[primitives.a].position, at);
  }
}

// `offset`: where the primitive of a stands, relative to body a; null if it is the body.
void Collision::write_manifold(const NarrowResult& answers, std::size_t at, const double* offset,
                               Place& to) noexcept {
  ContactFrame& frame = contacts_.frame;
  if (level_ >= SceneLevel::distance) {
    frame.distance[to.manifold] = answers.distance()[at];
    frame.error_bound[to.manifold] = answers.error_bound()[at];
    for (int k = 0; k < 3; ++k) {
      frame.normal[k][to.manifold] = answers.normal(k)[at];
      if (level_ == SceneLevel::distance) {
        frame.point[k][to.manifold] = answers.point(k)[at] + (offset == nullptr ? 0.0 : offset[k]);
      }
    }
  }
  if (level_ == SceneLevel::manifold) {
    const std::uint32_t first = answers.contact_first()[at];
    const std::uint32_t count = answers.contact_count()[at];
    const ContactColumns& from = answers.contact_columns();
    frame.point_first[to.manifold] = to.point;
    for (std::uint32_t i = 0; i < count; ++i) {
      for (int k = 0; k < 3; ++k) {
        const float p = from.position[k][first + i];
        frame.points.position[k][to.point + i] =
            offset == nullptr ? p : static_cast<float>(static_cast<double>(p) + offset[k]);
      }
      frame.points.depth[to.point + i] = from.depth[first + i];
      frame.points.feature[to.point + i] = from.feature[first + i];
    }
    to.point += count;
  }
  ++to.manifold;
}

// Runs of pairs of the same two kinds.
bool Collision::write_runs() {
  ContactFrame& frame = contacts_.frame;
  frame.runs.clear();
  const auto kind = [&](int side, std::size_t i) {
    return static_cast<std::uint8_t>(scene_.shape[frame.key[side][i].id].kind_index());
  };
  for (std::size_t i = 0; i < frame.pairs(); ++i) {
    const ContactRun run{kind(0, i), kind(1, i), static_cast<std::uint32_t>(i), 1};
    ContactRun* const last = frame.runs.empty() ? nullptr : frame.runs.end() - 1;
    if (last != nullptr && last->kind_a == run.kind_a && last->kind_b == run.kind_b) {
      ++last->count;
    } else if (!frame.runs.push_back(run)) {
      return false;
    }
  }
  return true;
}

// How much farther than the margin a pair that does not touch is at least; of composite shapes that
// of what the mid phase found near.
double Collision::clearance(std::uint32_t pair) const noexcept {
  const auto of = [&](const NarrowResult& answers, std::size_t at) {
    return answers.distance()[at] - answers.error_bound()[at] - scene_.options.margin;
  };
  double least = std::numeric_limits<double>::infinity();
  if (static_cast<Origin>(contacts_.origin[pair]) == Origin::convex) {
    least = of(scene_.answers, scene_.slot[contacts_.source[pair]]);
  } else {
    const std::uint32_t* const first = scene_.parts.first.data() + contacts_.source[pair];
    for (std::uint32_t i = first[0]; i < first[1]; ++i) {
      least = std::min(least, of(scene_.parts_answers, scene_.parts_slot[i]));
    }
  }
  return least;
}

}  // namespace winnow
