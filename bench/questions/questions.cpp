// Runs the queries of a JSON file (`winnow query`). Pairs of convex shapes that do not move are
// collected and computed together by one NarrowPhase::collide. The other queries run one by one as
// they are read; those about composite shapes and contacts in a Scene, see scene_questions.h.

#include "bench/questions/questions.h"

#include <winnow/pipeline/impacts.h>
#include "bench/questions/query_format.h"
#include "bench/questions/scene_questions.h"

#include <array>
#include <utility>
#include <vector>

namespace winnow::bench {
namespace {

std::array<Vec3d, 4> four_points(const Json& value) {
  std::array<Vec3d, 4> points;
  for (std::size_t k = 0; k < points.size(); ++k) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      static_cast<void>(read_exact_number(value[k][axis], points[k][axis]));
    }
  }
  return points;
}

/// Collects the bodies and pairs of all questions and stores each answer in its question's row.
class QueryBatch {
 public:
  QueryBatch(std::size_t count, const SceneQuestions& in_scene)
      : answers_(count), in_scene_(in_scene) {}

  void add(std::size_t row, const Json& question) {
    Json& answer = answers_[row];
    const bool is_object = question.is_object();
    answer["id"] = is_object && question.contains("id") ? question["id"] : Json();
    Status status = Status::invalid_argument;
    if (is_object && question.contains("ray")) {
      status = is_composite(member(question, "target")) ? in_scene_.answer_ray(question, answer)
                                                        : compute_ray(question, answer);
    } else if (is_object && question.contains("motion")) {
      status = compute_motion(question, answer);
    } else if (is_object && question.contains("a") && question.contains("b")) {
      status = compute_pair(row, question);
    }
    if (status != Status::ok) refuse(answer, status);
  }

  void compute_pairs(NarrowTier tier) {
    NarrowPhase phase;
    NarrowResult result;
    const NarrowOptions options{.level = ContactLevel::distance, .tier = tier};
    const Status status = phase.collide(pool_, {shapes_, poses_}, pairs_, options, result);
    if (status != Status::ok) {
      for (const std::size_t row : rows_) refuse(answers_[row], status);
      return;
    }
    for (std::size_t i = 0; i < result.size(); ++i) write(result, i);
  }

  [[nodiscard]] Json take() const {
    Json all = Json::array();
    for (const Json& answer : answers_) all.push_back(answer);
    return all;
  }

 private:
  static void refuse(Json& answer, Status status) { answer["status"] = to_string(status); }

  /// Computes the answer, or adds the pair to those that are computed together.
  Status compute_pair(std::size_t row, const Json& question) {
    const Json& a = question["a"];
    const Json& b = question["b"];
    if (has_end_pose(a) || has_end_pose(b)) return compute_impact(question, answers_[row]);
    if (in_scene_.with_contacts() || is_composite(a) || is_composite(b)) {
      return in_scene_.answer_pair(question, answers_[row]);
    }
    return add_pair(row, question);
  }

  Status add_pair(std::size_t row, const Json& question) {
    ShapeId shape[2];
    Pose pose[2];
    Status status = read_shape(question["a"], pool_, shape[0], pose[0]);
    if (status == Status::ok) status = read_shape(question["b"], pool_, shape[1], pose[1]);
    if (status != Status::ok) return status;
    const auto first = static_cast<std::uint32_t>(shapes_.size());
    shapes_.insert(shapes_.end(), {shape[0], shape[1]});
    poses_.insert(poses_.end(), {pose[0], pose[1]});
    pairs_.push_back({first, first + 1});
    rows_.push_back(row);
    return Status::ok;
  }

  Status compute_ray(const Json& question, Json& answer) {
    ShapeRay ray;
    ShapeId shape;
    Pose pose;
    if (!question.contains("target")) return Status::invalid_argument;
    Status status = read_ray(question["ray"], ray);
    if (status == Status::ok) status = read_shape(question["target"], pool_, shape, pose);
    ShapeHit hit;
    if (status == Status::ok) status = cast_ray(pool_.tables(), shape, pose, ray).get(hit);
    if (status != Status::ok) return status;
    write_ray_hit(hit, answer);
    return Status::ok;
  }

  static Status compute_motion(const Json& question, Json& answer) {
    if (!is_readable(question, QueryPart::motion)) return Status::invalid_argument;
    const Json& motion = question["motion"];
    const FeaturePair pair =
        motion["kind"] == "vertex_face" ? FeaturePair::vertex_face : FeaturePair::edge_edge;
    FeatureImpactOptions options;
    static_cast<void>(
        read_exact_number(member(question, "min_separation"), options.min_separation));
    const auto impact =
        feature_impact(pair, four_points(motion["start"]), four_points(motion["end"]), options);
    if (impact.status != Status::ok) return impact.status;
    answer["status"] = to_string(impact.status);
    answer["hit"] = impact.hit;
    answer["time"] = number_to_json(impact.time);
    return Status::ok;
  }

  Status compute_impact(const Json& question, Json& answer) {
    ShapeId shape[2];
    RigidMotion motion[2];
    CompositePool composites(pool_);
    Status status = Status::ok;
    for (const auto& [side, name] : {std::pair{0, "a"}, {1, "b"}}) {
      if (status != Status::ok) break;
      status = read_moving_shape(question[name], pool_, composites, shape[side], motion[side]);
    }
    constexpr BodyPair kPair[1] = {{0, 1}};
    const ImpactOptions options{.composites = &composites};
    ImpactResult result;
    if (status == Status::ok) {
      status = time_of_impact(pool_, {shape, motion}, kPair, options, result);
    }
    if (status == Status::ok) status = result.status(0);
    if (status != Status::ok) return status;
    write_impact(result, motion[0], answer);
    return Status::ok;
  }

  static void write_impact(const ImpactResult& result, const RigidMotion& of_a, Json& answer) {
    const bool hit = result.hits(0);
    const Pose at = of_a.at(result.time()[0]);
    Vec3d a{};
    Vec3d b{};
    for (int axis = 0; hit && axis < 3; ++axis) {
      a[axis] = at.position[axis] + result.point(axis)[0];
      b[axis] = a[axis] + result.gap()[0] * result.normal(axis)[0];
    }
    answer["status"] = to_string(Status::ok);
    answer["hit"] = hit;
    answer["time"] = hit ? number_to_json(result.time()[0]) : Json("inf");
    answer["gap"] = hit ? number_to_json(result.gap()[0]) : Json("inf");
    answer["normal"] =
        vector_to_json({result.normal(0)[0], result.normal(1)[0], result.normal(2)[0]});
    answer["points"] = Json::array({vector_to_json(a), vector_to_json(b)});
    answer["error_bound"] = number_to_json(result.error_bound()[0]);
  }

  void write(const NarrowResult& result, std::size_t i) {
    const BodyPair pair = pairs_[result.pair_of(i)];
    Json& answer = answers_[rows_[result.pair_of(i)]];
    Vec3d a{};
    Vec3d b{};
    for (int axis = 0; axis < 3; ++axis) {
      a[axis] = poses_[pair.a].position[axis] + result.point(axis)[i];
      b[axis] = a[axis] + result.distance()[i] * result.normal(axis)[i];
    }
    answer["status"] = to_string(Status::ok);
    answer["overlap"] = result.overlaps(i);
    answer["distance"] = number_to_json(result.distance()[i]);
    answer["normal"] =
        vector_to_json({result.normal(0)[i], result.normal(1)[i], result.normal(2)[i]});
    answer["points"] = Json::array({vector_to_json(a), vector_to_json(b)});
    answer["error_bound"] = number_to_json(result.error_bound()[i]);
  }

  std::vector<Json> answers_;
  const SceneQuestions& in_scene_;
  ShapePool pool_;
  std::vector<ShapeId> shapes_;
  std::vector<Pose> poses_;
  std::vector<BodyPair> pairs_;
  std::vector<std::size_t> rows_;
};

}  // namespace

Json answer(const Json& questions, NarrowTier tier, bool contacts) {
  const SceneQuestions in_scene(tier, contacts);
  QueryBatch questionnaire(questions.size(), in_scene);
  for (std::size_t i = 0; i < questions.size(); ++i) questionnaire.add(i, questions[i]);
  questionnaire.compute_pairs(tier);
  return questionnaire.take();
}

}  // namespace winnow::bench
