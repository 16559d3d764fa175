// The reference model of contacts_fuzz.cpp: computes which contacts a scene must report, from a
// pair list over all bodies and from new scenes without any cache, and compares them with the
// Contacts.

#include "tests/fuzz/contacts_model.h"

#include "pipeline/composites/parts.h"
#include "pipeline/shapes/pair_order.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>

#include "tests/fuzz/target.h"

namespace winnow::test {
namespace {

[[nodiscard]] bool same_pose(const Pose& a, const Pose& b) {
  return a.position == b.position && a.orientation == b.orientation;
}

[[nodiscard]] ModelScene::Names names_of(const ModelBody& a, const ModelBody& b) {
  return std::minmax(a.definition.data, b.definition.data);
}

[[nodiscard]] bool is_floor(const ModelBody& body) {
  return body.definition.state == BodyState::fixed;
}

[[nodiscard]] bool are_convex(const ModelBody& a, const ModelBody& b) {
  return !a.definition.shape.is_composite() && !b.definition.shape.is_composite();
}

[[nodiscard]] ModelManifolds manifolds_of(const Contacts& contacts, std::size_t i) {
  ModelManifolds all;
  for (auto m = contacts.manifold_first()[i]; m < contacts.manifold_first()[i + 1]; ++m) {
    ModelManifold& one = all.emplace_back();
    one.part[0] = contacts.part_a()[m];
    one.part[1] = contacts.part_b()[m];
    if (contacts.level() < ContactLevel::distance) continue;
    one.distance = contacts.distance()[m];
    one.error_bound = contacts.error_bound()[m];
    for (int k = 0; k < 3; ++k) one.normal[k] = contacts.normal(k)[m];
    if (contacts.level() == ContactLevel::distance) {
      for (int k = 0; k < 3; ++k) one.point[k] = contacts.point(k)[m];
      continue;
    }
    for (auto p = contacts.point_first()[m]; p < contacts.point_first()[m + 1]; ++p) {
      one.points.push_back(contacts.contact(p));
    }
  }
  return all;
}

[[nodiscard]] bool same_point(const ContactPoint& x, const ContactPoint& y) {
  return x.position == y.position && x.depth == y.depth && x.feature == y.feature;
}

[[nodiscard]] bool same_manifold(const ModelManifold& x, const ModelManifold& y) {
  return std::equal(x.part, x.part + 2, y.part) && x.distance == y.distance &&
         x.error_bound == y.error_bound && x.normal == y.normal && x.point == y.point &&
         std::equal(x.points.begin(), x.points.end(), y.points.begin(), y.points.end(), same_point);
}

[[nodiscard]] std::string text_of(const ModelManifolds& manifolds) {
  std::ostringstream out;
  out.precision(17);
  for (const ModelManifold& one : manifolds) {
    out << "  parts " << one.part[0] << ' ' << one.part[1] << " distance " << one.distance << " +- "
        << one.error_bound << " normal " << one.normal[0] << ' ' << one.normal[1] << ' '
        << one.normal[2] << '\n';
    for (const ContactPoint& point : one.points) {
      out << "    " << point.position[0] << ' ' << point.position[1] << ' ' << point.position[2]
          << " depth " << point.depth << " feature " << std::hex << point.feature << std::dec
          << '\n';
    }
  }
  return out.str();
}

/// The text of a failed comparison.
[[nodiscard]] testing::AssertionResult explained(bool holds, const ModelManifolds& now,
                                                 const ModelManifolds& fresh, const ModelBody& a,
                                                 const ModelBody& b) {
  if (holds) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "kinds " << a.definition.shape.kind_index() << ' '
                                     << b.definition.shape.kind_index() << "\nshown:\n"
                                     << text_of(now) << "expected:\n"
                                     << text_of(fresh);
}

/// Compares bit by bit.
[[nodiscard]] bool same_manifolds(const ModelManifolds& x, const ModelManifolds& y) {
  return std::equal(x.begin(), x.end(), y.begin(), y.end(), same_manifold);
}

[[nodiscard]] Eigen::Quaterniond turn_of(const Pose& pose) {
  const double* const q = pose.orientation.data();
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized();
}

[[nodiscard]] Eigen::Vector3d place_of(const Pose& pose) {
  return {pose.position[0], pose.position[1], pose.position[2]};
}

/// Returns the distance that the farthest point of a body of this radius moved, relative to the
/// other body.
[[nodiscard]] double moved(const Pose (&from)[2], const Pose (&to)[2], int seen, double radius) {
  const auto relative = [&](const Pose(&pose)[2]) {
    const Eigen::Quaterniond back = turn_of(pose[1 - seen]).conjugate();
    return std::pair(Eigen::Vector3d(back * (place_of(pose[seen]) - place_of(pose[1 - seen]))),
                     Eigen::Quaterniond(back * turn_of(pose[seen])));
  };
  const auto before = relative(from);
  const auto now = relative(to);
  const double half_angle = 0.5 * before.second.angularDistance(now.second);
  const double chord = half_angle < 1e-9 ? 0.0 : 2.0 * radius * std::sin(half_angle);
  return (now.first - before.first).norm() + chord;
}

/// Applies rest offsets to a result of the shapes, as ContactOffsets documents.
void rest(ModelManifold& manifold, ContactLevel level, double rest_a, double rest_b) {
  if (rest_a == 0.0 && rest_b == 0.0) return;
  const double size = std::abs(manifold.distance) + std::abs(rest_a) + std::abs(rest_b);
  manifold.error_bound += 0x1p-52 * size;
  manifold.distance -= rest_a + rest_b;
  for (int k = 0; k < 3 && level == ContactLevel::distance; ++k) {
    manifold.point[k] += rest_a * manifold.normal[k];
  }
  for (ContactPoint& point : manifold.points) {
    point.depth = static_cast<float>(static_cast<double>(point.depth) + rest_a + rest_b);
    for (int k = 0; k < 3; ++k) {
      point.position[k] = static_cast<float>(static_cast<double>(point.position[k]) +
                                             0.5 * (rest_a - rest_b) * manifold.normal[k]);
    }
  }
}

[[nodiscard]] ModelManifolds query_convex(const ModelScene& world, ContactLevel level,
                                          const ModelBody& a, const ModelBody& b) {
  const BodyDefinition& one = a.definition;
  const BodyDefinition& other = b.definition;
  const double gap = world.gap(a, b);
  PairAnswer answer;
  WINNOW_REQUIRE(collide(world.shapes, one.shape, one.pose, other.shape, other.pose,
                         {level, world.options.tier, gap}, answer) == Status::ok);
  if (level == ContactLevel::boolean) return ModelManifolds(answer.overlap ? 1 : 0);
  if (!(answer.distance <= gap)) return {};
  ModelManifold manifold;
  manifold.distance = answer.distance;
  manifold.error_bound = answer.error_bound;
  manifold.normal = answer.normal;
  if (level == ContactLevel::distance) manifold.point = answer.point;
  if (level == ContactLevel::manifold) {
    manifold.points.assign(answer.contacts, answer.contacts + answer.contact_count);
  }
  rest(manifold, level, one.offsets.rest, other.offsets.rest);
  return {manifold};
}

/// Returns the contacts of a new scene of only these two bodies, without any state of earlier
/// frames.
[[nodiscard]] ModelManifolds query_scene(const ModelScene& world, ContactLevel level,
                                         const ModelBody& a, const ModelBody& b) {
  Scene scene(world.shapes, {.execution = Execution::serial(),
                             .structures = {n_squared(), n_squared(), n_squared()},
                             .contact_margin = world.options.contact_margin,
                             .tier = world.options.tier,
                             .part_manifolds = world.options.part_manifolds,
                             .composites = &world.composites});
  const bool swapped = b.key.id < a.key.id;
  for (const ModelBody* body : {swapped ? &b : &a, swapped ? &a : &b}) {
    BodyDefinition definition{.shape = body->definition.shape, .pose = body->definition.pose};
    definition.offsets = body->definition.offsets;
    Key key;
    WINNOW_REQUIRE(scene.add(definition).get(key) == Status::ok);
  }
  Contacts contacts;
  WINNOW_REQUIRE(scene.collide(level, contacts) == Status::ok);
  return contacts.size() == 0 ? ModelManifolds{} : manifolds_of(contacts, 0);
}

}  // namespace

bool ModelScene::may_pair(const ModelBody& a, const ModelBody& b) const {
  const BodyDefinition& one = a.definition;
  const BodyDefinition& other = b.definition;
  return (one.state == BodyState::dynamic || other.state == BodyState::dynamic) &&
         filters_allow(one.filter, other.filter) && !ignored.contains(names_of(a, b)) &&
         !layers_apart.contains(std::minmax(one.layer, other.layer));
}

std::uint64_t ModelScene::surfaces_changed_of(const ModelBody& a, const ModelBody& b) const {
  return are_convex(a, b) ? 0 : surfaces_changed;
}

double ModelScene::gap(const ModelBody& a, const ModelBody& b) const {
  return options.contact_margin + (a.definition.offsets.contact + b.definition.offsets.contact);
}

double ModelScene::radius(const ModelBody& body) const {
  return SubShapeQuery(shapes, &composites).radius(body.definition.shape);
}

bool PairReference::Inputs::operator==(const Inputs& other) const {
  return same_pose(pose[0], other.pose[0]) && same_pose(pose[1], other.pose[1]) &&
         std::equal(reshaped, reshaped + 2, other.reshaped) &&
         surfaces_changed == other.surfaces_changed && level == other.level;
}

const ModelManifolds& PairReference::contacts(const ModelScene& world, ContactLevel level,
                                              const ModelBody& a, const ModelBody& b) {
  const Inputs inputs{{a.definition.pose, b.definition.pose},
                      {a.reshaped, b.reshaped},
                      world.surfaces_changed_of(a, b),
                      level};
  const auto [at, is_new] = answers_.try_emplace(names_of(a, b));
  Answer& answer = at->second;
  if (is_new || !(answer.inputs == inputs)) {
    answer.inputs = inputs;
    const double centers = (place_of(inputs.pose[0]) - place_of(inputs.pose[1])).norm();
    const bool is_far =
        centers > 1.001 * (world.radius(a) + world.radius(b) + world.gap(a, b)) + 1e-9;
    answer.manifolds = is_far             ? ModelManifolds{}
                       : are_convex(a, b) ? query_convex(world, level, a, b)
                                          : query_scene(world, level, a, b);
  }
  return answer.manifolds;
}

PairAnswer PairReference::distance(const ModelScene& world, const ModelBody& a,
                                   const ModelBody& b) {
  PairAnswer answer;
  WINNOW_REQUIRE(collide(world.shapes, a.definition.shape, a.definition.pose, b.definition.shape,
                         b.definition.pose, {ContactLevel::distance, world.options.tier},
                         answer) == Status::ok);
  return answer;
}

void ContactsModel::forget() {
  level_.reset();
  shown_.clear();
  dormant_.clear();
  history_.forget();
}

ContactsModel::Sides ContactsModel::sides(const ModelBody& one, const ModelBody& other) {
  const std::uint32_t kind = one.definition.shape.kind_index();
  const std::uint32_t other_kind = other.definition.shape.kind_index();
  const bool in_order = kind != other_kind ? kind < other_kind : one.key.id < other.key.id;
  return in_order ? Sides{one, other} : Sides{other, one};
}

ContactsModel::Name ContactsModel::name_of(const Sides& pair) {
  return {pair.a.definition.data, pair.b.definition.data,
          KindPairs::index(pair.a.definition.shape, pair.b.definition.shape)};
}

ContactsModel::Kept ContactsModel::new_pair(const Sides& pair) {
  const std::uint32_t kinds = KindPairs::index(pair.a.definition.shape, pair.b.definition.shape);
  Kept kept;
  kept.order = (std::uint64_t{kinds} << 28U | pair.a.key.id) << 28U | pair.b.key.id;
  kept.ended = {pair.a.key, pair.b.key, pair.a.definition.data, pair.b.definition.data};
  return kept;
}

/// Returns the pairs that are reported; checks that each occurs once and in order.
ContactsModel::KeptPairs ContactsModel::list_shown(const ModelScene& world,
                                                   const Contacts& contacts) const {
  KeptPairs shown;
  std::uint64_t last = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const auto a = world.bodies.find(contacts.data_a()[i]);
    const auto b = world.bodies.find(contacts.data_b()[i]);
    WINNOW_REQUIRE(a != world.bodies.end() && b != world.bodies.end());
    WINNOW_REQUIRE(a->second.key == contacts.a()[i] && b->second.key == contacts.b()[i]);
    WINNOW_REQUIRE(world.may_pair(a->second, b->second));
    const Sides pair = sides(a->second, b->second);
    WINNOW_REQUIRE(&pair.a == &a->second);
    const Kept kept = new_pair(pair);
    WINNOW_REQUIRE(i == 0 || last < kept.order);
    last = kept.order;
    WINNOW_REQUIRE(shown.emplace(name_of(pair), kept).second);
  }
  return shown;
}

void ContactsModel::check(const ModelScene& world, const Scene& scene, ContactLevel level,
                          const Contacts& contacts, PairReference& reference) {
  WINNOW_REQUIRE(contacts.level() == level);
  KeptPairs shown = list_shown(world, contacts);
  check_pairs(world, level, contacts, reference, shown);
  check_events(world, contacts, shown);
  check_places(world, scene, level, contacts);
  shown_ = std::move(shown);
  level_ = level;
}

bool ContactsModel::keeps_manifolds(const ModelScene& world, ContactLevel level,
                                    const Sides& pair) const {
  return world.options.cache_tolerance > 0.0 && level >= ContactLevel::distance &&
         !(world.options.suppress_ghost_contacts && (is_floor(pair.a) || is_floor(pair.b)));
}

namespace {

/// All contacts of a new scene of the same bodies. If the scene drops ghost contacts, the contacts
/// of a pair depend on all contacts of its bodies, and not only on the pair.
class WholeScene {
 public:
  WholeScene(const ModelScene& world, ContactLevel level)
      : scene_(world.shapes, options_of(world)) {
    std::map<std::uint32_t, const ModelBody*> by_id;
    for (const auto& [data, body] : world.bodies) by_id[body.key.id] = &body;
    for (const auto& [id, body] : by_id) {
      Key key;
      WINNOW_REQUIRE(scene_.add(body->definition).get(key) == Status::ok);
      keys_[body->definition.data] = key;
    }
    for (const auto& [a, b] : world.layers_apart) {
      WINNOW_REQUIRE(scene_.set_layers_collide(a, b, false) == Status::ok);
    }
    for (const auto& [a, b] : world.ignored) {
      WINNOW_REQUIRE(scene_.set_ignored(keys_.at(a), keys_.at(b)) == Status::ok);
    }
    WINNOW_REQUIRE(scene_.collide(level, contacts_) == Status::ok);
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      pairs_[std::minmax(contacts_.data_a()[i], contacts_.data_b()[i])] = i;
    }
  }

  [[nodiscard]] ModelManifolds contacts(const ModelBody& a, const ModelBody& b) const {
    const auto at = pairs_.find(names_of(a, b));
    return at == pairs_.end() ? ModelManifolds{} : manifolds_of(contacts_, at->second);
  }

 private:
  [[nodiscard]] static SceneOptions options_of(const ModelScene& world) {
    SceneOptions options = world.options;
    options.memory = default_memory();
    options.execution = Execution::serial();
    for (StructureKind& kind : options.structures) kind = n_squared();
    options.cache_tolerance = 0.0;
    options.warm_start = false;
    return options;
  }

  Scene scene_;
  Contacts contacts_;
  std::map<ClientData, Key> keys_;
  std::map<ModelScene::Names, std::size_t> pairs_;
};

}  // namespace

void ContactsModel::check_pairs(const ModelScene& world, ContactLevel level,
                                const Contacts& contacts, PairReference& reference,
                                KeptPairs& shown) {
  std::map<ModelScene::Names, std::size_t> at;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    at[std::minmax(contacts.data_a()[i], contacts.data_b()[i])] = i;
  }
  std::optional<WholeScene> whole;
  if (world.options.suppress_ghost_contacts && level >= ContactLevel::distance) {
    whole.emplace(world, level);
  }
  for (auto first = world.bodies.begin(); first != world.bodies.end(); ++first) {
    for (auto second = std::next(first); second != world.bodies.end(); ++second) {
      if (!world.may_pair(first->second, second->second)) continue;
      const Sides pair = sides(first->second, second->second);
      const bool has_seams = whole && (is_floor(pair.a) || is_floor(pair.b));
      // At level `pairs` the scene reports pairs of boxes, which must include all touching pairs.
      const ContactLevel query_level = std::max(level, ContactLevel::boolean);
      const ModelManifolds fresh = has_seams
                                       ? whole->contacts(pair.a, pair.b)
                                       : reference.contacts(world, query_level, pair.a, pair.b);
      const auto found = at.find(names_of(pair.a, pair.b));
      if (found == at.end()) {
        check_not_shown(world, level, pair, fresh);
      } else if (level != ContactLevel::pairs) {
        Kept& kept = shown.at(name_of(pair));
        check_shown(world, level, manifolds_of(contacts, found->second), pair, fresh, kept);
      }
    }
  }
}

void ContactsModel::check_not_shown(const ModelScene& world, ContactLevel level, const Sides& pair,
                                    const ModelManifolds& fresh) {
  if (fresh.empty()) return;
  // A cached pair that was apart is recomputed only after a motion that could close its gap. A
  // missing contact is therefore at the limit of the gap, up to rounding.
  WINNOW_REQUIRE(world.options.cache_tolerance > 0.0 && level >= ContactLevel::distance);
  const double rest = pair.a.definition.offsets.rest + pair.b.definition.offsets.rest;
  for (const ModelManifold& manifold : fresh) {
    WINNOW_REQUIRE(manifold.distance + rest >= world.gap(pair.a, pair.b) - 1e-9);
  }
}

namespace {

/// Returns true if `shown` can be the result of keeping `made` from the poses `from` to the
/// poses `to`.
[[nodiscard]] bool is_kept_copy(const ModelManifold& shown, const ModelManifold& made,
                                const Pose (&from)[2], const Pose (&to)[2], double cache_tolerance,
                                double radius_a) {
  const bool may_be_turned = shown.distance == made.distance &&
                             std::equal(shown.part, shown.part + 2, made.part) &&
                             shown.points.size() == made.points.size() &&
                             (shown.error_bound == made.error_bound ||
                              shown.error_bound == made.error_bound + cache_tolerance);
  if (!may_be_turned) return false;
  const Eigen::Matrix3d turn = (turn_of(to[0]) * turn_of(from[0]).conjugate()).toRotationMatrix();
  const double slack = 1e-5;
  const auto is_near = [&](const Eigen::Vector3d& now, const Eigen::Vector3d& then, double most) {
    return (now - turn * then).norm() <= most + slack * (1.0 + then.norm());
  };
  const auto vector = [](const Vec3d& v) { return Eigen::Vector3d(v[0], v[1], v[2]); };
  // The cache may leave out a rotation of body a by less than this angle, which moves the surface
  // of the body by less than cache_tolerance. A point of a deep contact can be farther out than the
  // surface; such a rotation then moves the point by more.
  const double angle = std::isfinite(radius_a) ? cache_tolerance / radius_a : 0.0;
  const auto off = [&](const Eigen::Vector3d& point) {
    return std::max(cache_tolerance, angle * point.norm());
  };
  if (!is_near(vector(shown.normal), vector(made.normal), angle)) return false;
  if (!is_near(vector(shown.point), vector(made.point), off(vector(made.point)))) return false;
  for (std::size_t p = 0; p < made.points.size(); ++p) {
    const auto place = [](const ContactPoint& point) {
      return as_eigen(point.position).cast<double>().eval();
    };
    if (made.points[p].feature != shown.points[p].feature ||
        made.points[p].depth != shown.points[p].depth ||
        !is_near(place(shown.points[p]), place(made.points[p]), off(place(made.points[p])))) {
      return false;
    }
  }
  return true;
}

}  // namespace

void ContactsModel::check_shown(const ModelScene& world, ContactLevel level,
                                const ModelManifolds& now, const Sides& pair,
                                const ModelManifolds& fresh, Kept& kept) {
  const bool is_fresh = !fresh.empty() && same_manifolds(now, fresh);
  const Pose poses[2] = {pair.a.definition.pose, pair.b.definition.pose};
  const double cache_tolerance = world.options.cache_tolerance;
  const double radius[2] = {world.radius(pair.a), world.radius(pair.b)};
  const int seen = radius[0] <= radius[1] ? 0 : 1;
  const Name name = name_of(pair);
  const bool keeps = keeps_manifolds(world, level, pair);
  if (keeps && level_ == level) {
    for (const KeptPairs* const before : {&shown_, &dormant_}) {
      const auto at = before->find(name);
      if (at == before->end()) continue;
      for (const Origin& origin : at->second.origins) {
        const bool is_same_shape =
            origin.reshaped[0] == pair.a.reshaped && origin.reshaped[1] == pair.b.reshaped &&
            origin.surfaces_changed == world.surfaces_changed_of(pair.a, pair.b);
        const bool stays =
            is_same_shape &&
            moved(origin.pose, poses, seen, radius[seen]) <= cache_tolerance * (1.0 + 1e-9) &&
            std::equal(now.begin(), now.end(), origin.made.begin(), origin.made.end(),
                       [&](const ModelManifold& shown, const ModelManifold& made) {
                         return is_kept_copy(shown, made, origin.pose, poses, cache_tolerance,
                                             radius[0]);
                       });
        if (stays) kept.origins.push_back(origin);
      }
    }
  }
  if (!is_fresh) ++cached;
  const auto is_made_here = [&](const Origin& origin) {
    return same_pose(origin.pose[0], poses[0]) && same_pose(origin.pose[1], poses[1]);
  };
  if (is_fresh && std::none_of(kept.origins.begin(), kept.origins.end(), is_made_here)) {
    kept.origins.push_back({{poses[0], poses[1]},
                            {pair.a.reshaped, pair.b.reshaped},
                            world.surfaces_changed_of(pair.a, pair.b),
                            now});
  }
  WINNOW_REQUIRE(explained(!kept.origins.empty(), now, fresh, pair.a, pair.b));
  if (!keeps || !are_convex(pair.a, pair.b)) return;
  const PairAnswer truth = PairReference::distance(world, pair.a, pair.b);
  const double rest = pair.a.definition.offsets.rest + pair.b.definition.offsets.rest;
  WINNOW_REQUIRE(std::abs(truth.distance - rest - now[0].distance) <=
                 now[0].error_bound + truth.error_bound + 1e-12);
}

void ContactsModel::check_events(const ModelScene& world, const Contacts& contacts,
                                 const KeptPairs& shown) {
  const bool same_level = level_ == contacts.level();
  if (!same_level) dormant_.clear();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const ModelBody& a = world.bodies.at(contacts.data_a()[i]);
    const ModelBody& b = world.bodies.at(contacts.data_b()[i]);
    const Name name = name_of({a, b});
    const bool persists = shown_.contains(name) || dormant_.contains(name);
    WINNOW_REQUIRE(persists == (contacts.event()[i] == ContactEvent::persisted));
  }
  const auto sleeps = [&](const Name& name) {
    const auto is_at_rest = [&](ClientData data) {
      const auto body = world.bodies.find(data);
      return body != world.bodies.end() && body->second.definition.state != BodyState::dynamic;
    };
    return same_level && is_at_rest(name.a) && is_at_rest(name.b);
  };
  std::vector<Kept> ended[2];
  KeptPairs dormant;
  for (const bool slept : {false, true}) {
    for (const auto& [name, kept] : slept ? dormant_ : shown_) {
      if (shown.contains(name)) continue;
      if (sleeps(name)) {
        dormant.emplace(name, kept);
      } else {
        ended[slept].push_back(kept);
      }
    }
  }
  dormant_ = std::move(dormant);
  check_ended(contacts, ended[0], ended[1]);
}

void ContactsModel::check_ended(const Contacts& contacts, std::vector<Kept>& ended,
                                std::vector<Kept>& ended_asleep) const {
  for (std::vector<Kept>* list : {&ended, &ended_asleep}) {
    std::sort(list->begin(), list->end(),
              [](const Kept& x, const Kept& y) { return x.order < y.order; });
  }
  ended.insert(ended.end(), ended_asleep.begin(), ended_asleep.end());
  WINNOW_REQUIRE(std::equal(
      ended.begin(), ended.end(), contacts.ended().begin(), contacts.ended().end(),
      [](const Kept& kept, const EndedContact& reported) {
        return kept.ended.a == reported.a && kept.ended.b == reported.b &&
               kept.ended.data_a == reported.data_a && kept.ended.data_b == reported.data_b;
      }));
}

void ContactsModel::check_places(const ModelScene& world, const Scene& scene, ContactLevel level,
                                 const Contacts& contacts) {
  if (!world.options.warm_start) {
    WINNOW_REQUIRE(contacts.previous_pair().empty() && contacts.previous_point().empty());
    return;
  }
  const bool reduces = !world.options.part_manifolds && level == ContactLevel::manifold;
  std::map<std::uint32_t, double> radius;
  for (const auto& [data, body] : world.bodies) radius[body.key.id] = world.radius(body);
  history_.compare(scene, contacts, reduces,
                   [&](Key a, Key b) { return std::min(radius.at(a.id), radius.at(b.id)); });
}

}  // namespace winnow::test
