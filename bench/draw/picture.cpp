// One frame as data for the page: what the partition draws, pairs, contacts and the answers to
// queries, as JSON with base64 columns. commands/view.cpp calls it; page/data.js reads the result.

#include "bench/draw/picture.h"

#include <winnow/core/debug_draw.h>
#include "bench/common/need.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <type_traits>

namespace winnow::bench {
namespace {

static_assert(std::endian::native == std::endian::little, "the page reads little-endian columns");

/// Encodes the memory of the values as base64 (RFC 4648, with padding).
template <typename T>
std::string column(const std::vector<T>& values) {
  static_assert(std::is_standard_layout_v<T>);
  constexpr const char* kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto bytes = std::as_bytes(std::span(values));
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t taken = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8U | (k < taken ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= taken ? kDigits[group >> (18U - 6U * k) & 63U] : '=';
    }
  }
  return text;
}

/// Boxes and lines of one colour, which the page shows or hides together.
struct Layer {
  std::string name;
  Colour colour;
  std::vector<Aabb> boxes{};
  std::vector<Vec3f> line_ends{};  ///< two per line
};

/// Stores what a partition draws, sorted into layers by colour.
struct Sketch final : DebugDraw {
  std::vector<Aabb> objects;  ///< in ascending order of their ids
  std::vector<Layer> layers;  ///< the last one takes unknown colours

  Sketch() {
    layers = {
        {"axis", kAxisColour}, {"cells", kCellColour}, {"contents of cells", kContentsColour}};
    for (std::size_t depth = 0; depth < kNodeColours.size(); ++depth) {
      layers.push_back({"nodes, depth " + std::to_string(depth), node_colour(depth)});
    }
    layers.push_back({"other", Colour{}});
  }

  void box(const Aabb& box, Colour colour) override {
    (colour == kObjectColour ? objects : layer_of(colour).boxes).push_back(box);
  }
  void line(const Vec3f& from, const Vec3f& to, Colour colour) override {
    std::vector<Vec3f>& ends = layer_of(colour).line_ends;
    ends.insert(ends.end(), {from, to});
  }
  void sphere(const Sphere& sphere, Colour colour) override { box(sphere.bounds(), colour); }
  void text(const Vec3f&, std::string_view, Colour) override {}

 private:
  Layer& layer_of(Colour colour) {
    return *std::find_if(layers.begin(), layers.end() - 1,
                         [&](const Layer& layer) { return layer.colour == colour; });
  }
};

/// Queries rays, marks the objects that they hit, and counts.
Json query_rays(const Partition& partition, std::span<const Ray> rays, std::vector<bool>& hit,
                Json& counts) {
  Json answers = Json::array();
  std::size_t rays_that_hit = 0;
  std::size_t ray_hits = 0;
  HitBuffer hits;
  for (const Ray& ray : rays) {
    const Hit closest = need(partition.closest(Cast(ray)), "closest");
    need(partition.all(Cast(ray), hits), "all");
    std::vector<ObjectId> ids;
    std::vector<float> ts;
    for (const Hit& one : hits) {
      hit[one.key.id] = true;
      ids.push_back(one.key.id);
      ts.push_back(one.t);
    }
    Json answer{{"ray", column(std::vector{ray})}, {"hits", column(ids)}, {"t", column(ts)}};
    if (closest) {
      answer["closest"] = closest.key.id;
      answer["closest_t"] = closest.t;
      ++rays_that_hit;
    }
    ray_hits += ids.size();
    answers.push_back(std::move(answer));
  }
  counts.update({{"rays", rays.size()}, {"rays_that_hit", rays_that_hit}, {"ray_hits", ray_hits}});
  return answers;
}

/// Queries boxes, marks the objects that overlap them, and counts.
Json query_boxes(const Partition& partition, std::span<const Aabb> boxes, std::vector<bool>& hit,
                 Json& counts) {
  Json answers = Json::array();
  std::size_t all_inside = 0;
  std::size_t all_crossing = 0;
  OverlapBuffer found;
  for (const Aabb& box : boxes) {
    need(partition.overlap(Region(box), found, {}, Order::canonical), "overlap");
    const std::vector<ObjectId> inside(found.inside().begin(), found.inside().end());
    const std::vector<ObjectId> crossing(found.crossing().begin(), found.crossing().end());
    for (const auto* ids : {&inside, &crossing}) {
      for (const ObjectId id : *ids) hit[id] = true;
    }
    all_inside += inside.size();
    all_crossing += crossing.size();
    answers.push_back({{"box", column(std::vector{box})},
                       {"inside", column(inside)},
                       {"crossing", column(crossing)}});
  }
  counts.update({{"boxes", boxes.size()}, {"inside", all_inside}, {"crossing", all_crossing}});
  return answers;
}

/// Returns the two ends of a line for each contact: from its point along the normal, half the
/// median thickness of the objects long.
std::vector<Vec3f> ends_of(std::span<const RecordedContact> contacts,
                           const std::vector<Aabb>& objects) {
  std::vector<Vec3f> ends;
  if (contacts.empty()) return ends;
  std::vector<float> edges;
  for (const Aabb& box : objects) {
    const Vec3f size = box.max - box.min;
    edges.push_back(std::min({size.x(), size.y(), size.z()}));
  }
  const auto middle = edges.begin() + static_cast<std::ptrdiff_t>(edges.size() / 2);
  std::nth_element(edges.begin(), middle, edges.end());
  const float length = std::isfinite(*middle) && *middle > 0.0F ? 0.5F * *middle : 1.0F;
  for (const RecordedContact& contact : contacts) {
    ends.insert(ends.end(), {contact.at, contact.at + contact.normal * length});
  }
  return ends;
}

}  // namespace

Json picture_of(const std::string& scene, std::size_t frame, const PartitionEngine& engine,
                const PictureOptions& options, std::span<const RecordedContact> contacts) {
  const Partition& partition = engine.partition();
  Sketch sketch;
  need(partition.debug_draw(sketch, {.max_depth = options.max_depth}), "debug_draw");
  const std::size_t all = sketch.objects.size();
  std::vector<bool> drawn(all);
  Json query_counts;
  const Json rays = query_rays(partition, options.rays, drawn, query_counts);
  const Json boxes = query_boxes(partition, options.boxes, drawn, query_counts);
  // Selects as many objects as are allowed, at equal intervals.
  const std::size_t most = std::min(options.most_objects, all);
  for (std::size_t i = 0; i < all; ++i) {
    if ((i + 1) * most / all != i * most / all) drawn[i] = true;
  }
  std::vector<Aabb> bounds;
  std::vector<ObjectId> ids;
  for (ObjectId id = 0; id < all; ++id) {
    if (!drawn[id]) continue;
    bounds.push_back(sketch.objects[id]);
    ids.push_back(id);
  }
  std::size_t overlapping = 0;
  std::vector<ObjectId> pairs;
  for (const Pair& pair : engine.pairs()) {
    if (!sketch.objects[pair.first].overlaps(sketch.objects[pair.second])) continue;
    ++overlapping;
    if (drawn[pair.first] && drawn[pair.second]) {
      pairs.insert(pairs.end(), {pair.first, pair.second});
    }
  }
  const std::vector<Vec3f> contact_ends = ends_of(contacts, sketch.objects);
  Json layers = Json::array();
  Json layer_counts = Json::object();
  std::size_t lines = 0;
  for (const Layer& layer : sketch.layers) {
    if (layer.boxes.empty() && layer.line_ends.empty()) continue;
    if (!layer.boxes.empty()) layer_counts[layer.name] = layer.boxes.size();
    lines += layer.line_ends.size() / 2;
    layers.push_back({{"name", layer.name},
                      {"colour", {layer.colour.r, layer.colour.g, layer.colour.b}},
                      {"boxes", column(layer.boxes)},
                      {"lines", column(layer.line_ends)}});
  }
  const Statistics statistics = partition.statistics();
  Json counts{{"scene", scene},
              {"frame", frame},
              {"partition", partition.name()},
              {"objects", all},
              {"objects_drawn", ids.size()},
              {"regular", statistics.regular},
              {"irregular", statistics.irregular},
              {"cells", statistics.cells},
              {"depth", statistics.depth},
              {"structure", layer_counts},
              {"structure_lines", lines},
              {"pairs", overlapping},
              {"reported", engine.pairs().size()},
              {"pairs_drawn", pairs.size() / 2},
              {"contacts", contact_ends.size() / 2}};
  counts.update(query_counts);
  return {{"counts", counts},       {"objects", {{"boxes", column(bounds)}, {"rows", column(ids)}}},
          {"pairs", column(pairs)}, {"contacts", column(contact_ends)},
          {"structure", layers},    {"rays", rays},
          {"boxes", boxes}};
}

}  // namespace winnow::bench
