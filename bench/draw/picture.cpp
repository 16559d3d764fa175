// One frame as data for the page: selects the objects, pairs and contacts to draw, and encodes them
// as JSON with base64 columns. commands/draw.cpp calls it; draw/page/data.js reads the result.

#include "bench/draw/picture.h"

#include "bench/draw/base64.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace winnow::bench {
namespace {

static_assert(std::endian::native == std::endian::little, "the page reads little-endian columns");

constexpr std::uint32_t kNotDrawn = std::numeric_limits<std::uint32_t>::max();

Json colour_data(Colour colour) {
  return Json::array({colour.r, colour.g, colour.b});
}

template <typename T>
std::string column(const std::vector<T>& values) {
  return base64_of(std::span<const T>(values));
}

}  // namespace

Picture::Picture(std::string scene, const Stage& stage, const PictureOptions& options,
                 std::span<const RecordedContact> contacts)
    : scene_(std::move(scene)),
      frame_(stage.frame()),
      partition_(stage.partition().name()),
      all_pairs_(stage.pairs().size()),
      reported_(stage.reported()),
      rays_(query_rays(stage.partition(), options.rays)),
      boxes_(query_boxes(stage.partition(), options.boxes)) {
  const Partition& partition = stage.partition();
  const DebugDrawOptions drawing{.labels = options.labels, .max_depth = options.max_depth};
  require_ok(partition.debug_draw(sketch_, drawing), "debug_draw");
  statistics_ = partition.statistics();
  choose_objects(options.most_objects);
  for (const ObjectId id : drawn_) data_.push_back(partition.client_data_of(id));
  choose_pairs(stage.pairs());
  draw_contacts(contacts);
}

// Draws each contact as a line from its point along the normal, half the median thickness of the
// objects long.
void Picture::draw_contacts(std::span<const RecordedContact> contacts) {
  if (contacts.empty()) return;
  std::vector<float> edges;
  for (const Aabb& box : sketch_.objects()) {
    const Vec3f size = box.max - box.min;
    edges.push_back(std::min({size.x(), size.y(), size.z()}));
  }
  const auto middle = edges.begin() + static_cast<std::ptrdiff_t>(edges.size() / 2);
  std::nth_element(edges.begin(), middle, edges.end());
  const float length = std::isfinite(*middle) && *middle > 0.0F ? 0.5F * *middle : 1.0F;
  for (const RecordedContact& contact : contacts) {
    contact_ends_.push_back(contact.at);
    contact_ends_.push_back(contact.at + contact.normal * length);
  }
}

void Picture::choose_objects(std::size_t most) {
  const std::size_t all = sketch_.objects().size();
  std::vector<bool> hit(all);
  for (const RayResult& answer : rays_) {
    for (const Hit& h : answer.hits) hit[h.key.id] = true;
  }
  for (const BoxResult& answer : boxes_) {
    for (const ObjectId id : answer.inside) hit[id] = true;
    for (const ObjectId id : answer.crossing) hit[id] = true;
  }
  place_.assign(all, kNotDrawn);
  for (std::size_t i = 0; i < all; ++i) {
    // Selects `most` of the objects at equal intervals.
    const bool chosen = most >= all || (i + 1) * most / all != i * most / all;
    if (!chosen && !hit[i]) continue;
    place_[i] = static_cast<std::uint32_t>(drawn_.size());
    drawn_.push_back(static_cast<ObjectId>(i));
  }
}

void Picture::choose_pairs(const std::vector<Pair>& pairs) {
  for (const Pair& pair : pairs) {
    const std::uint32_t first = place_[pair.first];
    const std::uint32_t second = place_[pair.second];
    if (first != kNotDrawn && second != kNotDrawn) pairs_.insert(pairs_.end(), {first, second});
  }
}

Json Picture::counts() const {
  Json layers = Json::object();
  std::size_t lines = 0;
  for (const SketchLayer* layer : sketch_.structure()) {
    if (!layer->boxes.empty()) layers[layer->name] = layer->boxes.size();
    lines += layer->line_ends.size() / 2;
  }
  std::size_t ray_hits = 0;
  std::size_t rays_that_hit = 0;
  for (const RayResult& answer : rays_) {
    ray_hits += answer.hits.size();
    rays_that_hit += static_cast<bool>(answer.closest);
  }
  std::size_t inside = 0;
  std::size_t crossing = 0;
  for (const BoxResult& answer : boxes_) {
    inside += answer.inside.size();
    crossing += answer.crossing.size();
  }
  return {{"scene", scene_},
          {"frame", frame_},
          {"partition", partition_},
          {"objects", sketch_.objects().size()},
          {"objects_drawn", drawn_.size()},
          {"regular", statistics_.regular},
          {"irregular", statistics_.irregular},
          {"cells", statistics_.cells},
          {"depth", statistics_.depth},
          {"structure", layers},
          {"structure_lines", lines},
          {"pairs", all_pairs_},
          {"reported", reported_},
          {"pairs_drawn", pairs_.size() / 2},
          {"contacts", contact_ends_.size() / 2},
          {"rays", rays_.size()},
          {"rays_that_hit", rays_that_hit},
          {"ray_hits", ray_hits},
          {"boxes", boxes_.size()},
          {"inside", inside},
          {"crossing", crossing}};
}

Json Picture::data() const {
  Json data{{"counts", counts()}};
  data["objects"] = objects_data();
  data["pairs"] = column(pairs_);
  data["contacts"] = column(contact_ends_);
  data["structure"] = structure_data();
  data.update(questions_data());
  return data;
}

Json Picture::objects_data() const {
  // Objects are drawn in ascending order of their ids.
  std::vector<Aabb> boxes;
  for (const ObjectId id : drawn_) boxes.push_back(sketch_.objects()[id]);
  return {{"boxes", column(boxes)}, {"rows", column(drawn_)}, {"data", column(data_)}};
}

Json Picture::structure_data() const {
  Json layers = Json::array();
  for (const SketchLayer* layer : sketch_.structure()) {
    layers.push_back({{"name", layer->name},
                      {"colour", colour_data(layer->colour)},
                      {"boxes", column(layer->boxes)},
                      {"lines", column(layer->line_ends)}});
  }
  Json texts = Json::array();
  for (const SketchText& text : sketch_.texts()) {
    const std::span<const float> at(text.at.data(), 3);
    texts.push_back(
        {{"at", base64_of(at)}, {"text", text.text}, {"colour", colour_data(text.colour)}});
  }
  return {{"layers", layers}, {"texts", texts}};
}

std::string Picture::places_of(std::span<const ObjectId> ids) const {
  std::vector<std::uint32_t> places;
  for (const ObjectId id : ids) places.push_back(place_[id]);
  return column(places);
}

Json Picture::questions_data() const {
  Json rays = Json::array();
  for (const RayResult& answer : rays_) {
    std::vector<ObjectId> ids;
    std::vector<float> ts;
    for (const Hit& hit : answer.hits) {
      ids.push_back(hit.key.id);
      ts.push_back(hit.t);
    }
    Json ray{{"ray", base64_of(std::span<const Ray>(&answer.ray, 1))},
             {"hits", places_of(ids)},
             {"t", column(ts)}};
    if (answer.closest) {
      ray["closest"] = place_[answer.closest.key.id];
      ray["closest_t"] = answer.closest.t;
    }
    rays.push_back(std::move(ray));
  }
  Json boxes = Json::array();
  for (const BoxResult& answer : boxes_) {
    boxes.push_back({{"box", base64_of(std::span<const Aabb>(&answer.box, 1))},
                     {"inside", places_of(answer.inside)},
                     {"crossing", places_of(answer.crossing)}});
  }
  return {{"rays", rays}, {"boxes", boxes}};
}

}  // namespace winnow::bench
