#include "bench/questions/scene_questions.h"

#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/scene_queries.h>
#include "bench/questions/query_format.h"
#include "bench/questions/shape_json.h"

#include <limits>

namespace winnow::bench {
namespace {

/// A scene, and the shapes of its bodies.
class SmallScene {
 public:
  SmallScene(NarrowTier tier, double contact_margin)
      : composites_(pool_),
        scene_(pool_,
               {.contact_margin = contact_margin, .tier = tier, .composites = &composites_}) {}

  /// Adds a body with the shape and pose of a query.
  [[nodiscard]] Status add(const Json& shape, Key& key) {
    BodyDefinition body;
    const Status status = read_any_shape(shape, pool_, composites_, body.shape, body.pose);
    return status == Status::ok ? scene_.add(body).get(key) : status;
  }
  [[nodiscard]] Scene& scene() noexcept { return scene_; }

 private:
  ShapePool pool_;
  CompositePool composites_;
  Scene scene_;
};

/// Writes one manifold. The normal of the contacts leads from the body at `origin`, the first of
/// their pair; `sign` is -1 if this is body b of the query.
Json manifold_to_json(const ContactManifold& manifold, const Vec3d& origin, double sign) {
  Json points = Json::array();
  for (const ContactPoint& point : manifold) {
    Vec3d position{};
    for (int axis = 0; axis < 3; ++axis) position[axis] = origin[axis] + point.position[axis];
    points.push_back({{"position", vector_to_json(position)}, {"depth", point.depth}});
  }
  Vec3d normal{};
  for (int axis = 0; axis < 3; ++axis) normal[axis] = sign * manifold.normal()[axis];
  return {{"normal", vector_to_json(normal)},
          {"distance", number_to_json(manifold.distance())},
          {"points", points}};
}

Status write_contacts(Scene& scene, Key first, Json& answer) {
  Contacts contacts;
  const Status status = scene.collide(ContactLevel::manifold, contacts);
  if (status != Status::ok) return status;
  Json manifolds = Json::array();
  for (const ContactPair& pair : contacts) {
    const Vec3d origin = scene.body(pair.a()).pose.position;
    for (const ContactManifold& manifold : pair) {
      manifolds.push_back(manifold_to_json(manifold, origin, pair.a() == first ? 1.0 : -1.0));
    }
  }
  answer["manifolds"] = manifolds;
  return Status::ok;
}

Status write_distance(const Scene& scene, const Key (&bodies)[2], Json& answer) {
  constexpr double kAnyDistance = std::numeric_limits<double>::infinity();
  SceneQueries queries(scene);
  const auto overlaps = queries.overlaps({&bodies[0], 1}, {&bodies[1], 1}, 1, PairRules::none);
  if (overlaps.status != Status::ok) return overlaps.status;
  const auto to = queries.distance(bodies[0], bodies[1], kAnyDistance, PairRules::none);
  if (to.status != Status::ok) return to.status;
  answer["overlap"] = !overlaps.empty();
  answer["distance"] = number_to_json(to.distance);
  answer["normal"] = vector_to_json(to.normal);
  answer["points"] = Json::array({vector_to_json(to.point_a), vector_to_json(to.point_b)});
  answer["error_bound"] = number_to_json(to.error_bound);
  return Status::ok;
}

}  // namespace

void write_ray_hit(const ShapeHit& hit, Json& answer) {
  answer["status"] = to_string(Status::ok);
  answer["hit"] = hit.hit;
  answer["t"] = number_to_json(hit.hit ? hit.t : std::numeric_limits<double>::infinity());
  answer["normal"] = vector_to_json(hit.normal);
}

Status SceneQuestions::answer_pair(const Json& question, Json& answer) const {
  if (!is_readable(question, QueryPart::pair)) return Status::invalid_argument;
  double contact_margin = 0.0;
  static_cast<void>(read_number(member(question, "contact_margin"), contact_margin));
  SmallScene world(tier_, contact_margin);
  Key bodies[2];
  Status status = world.add(question["a"], bodies[0]);
  if (status == Status::ok) status = world.add(question["b"], bodies[1]);
  if (status == Status::ok) status = world.scene().refresh();
  Json found = Json::object();
  if (status == Status::ok) status = write_distance(world.scene(), bodies, found);
  if (status == Status::ok && with_contacts_) {
    status = write_contacts(world.scene(), bodies[0], found);
  }
  if (status != Status::ok) return status;
  answer["status"] = to_string(status);
  answer.update(found);
  return status;
}

Status SceneQuestions::answer_ray(const Json& question, Json& answer) const {
  SmallScene world(tier_, 0.0);
  ShapeRay ray;
  Key target;
  Status status = read_ray(question["ray"], ray);
  if (status == Status::ok) status = world.add(question["target"], target);
  if (status == Status::ok) status = world.scene().refresh();
  if (status != Status::ok) return status;
  const auto hit = SceneQueries(world.scene()).closest(ray);
  if (hit.status != Status::ok) return hit.status;
  write_ray_hit({static_cast<bool>(hit), hit.t, hit.normal}, answer);
  return Status::ok;
}

}  // namespace winnow::bench
