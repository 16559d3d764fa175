#include "bench/draw/questions.h"

#include "bench/common/errors.h"
#include "bench/draw/stage.h"

#include <array>
#include <cstdlib>

namespace winnow::bench {
namespace {

std::array<float, 6> six_numbers(const std::string& option, const std::string& text) {
  std::array<float, 6> numbers{};
  const char* at = text.c_str();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    char* end = nullptr;
    numbers[i] = std::strtof(at, &end);
    const char expected = i + 1 < numbers.size() ? ',' : '\0';
    if (end == at || *end != expected) {
      throw ArgumentError(option + ": " + text + " is not six numbers with commas between them");
    }
    at = end + 1;
  }
  return numbers;
}

}  // namespace

Ray parse_ray(const std::string& text) {
  const std::array<float, 6> n = six_numbers("--ray", text);
  const Ray ray{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
  if (!ray.is_valid()) {
    throw ArgumentError("--ray: " + text +
                        " needs finite numbers and a direction that is not zero");
  }
  return ray;
}

Aabb parse_box(const std::string& text) {
  const std::array<float, 6> n = six_numbers("--box", text);
  const Aabb box{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
  if (!box.is_valid()) {
    throw ArgumentError("--box: " + text + " needs three lower ends, then three upper ends");
  }
  return box;
}

std::vector<RayResult> query_rays(const Partition& partition, std::span<const Ray> rays) {
  std::vector<RayResult> answers;
  HitBuffer hits;
  for (const Ray& ray : rays) {
    RayResult answer{.ray = ray, .closest = {}, .hits = {}};
    require_ok(partition.closest(Cast(ray), answer.closest), "closest");
    require_ok(partition.all(Cast(ray), hits), "all");
    answer.hits.assign(hits.begin(), hits.end());
    answers.push_back(std::move(answer));
  }
  return answers;
}

std::vector<BoxResult> query_boxes(const Partition& partition, std::span<const Aabb> boxes) {
  std::vector<BoxResult> answers;
  OverlapBuffer found;
  for (const Aabb& box : boxes) {
    require_ok(partition.overlap(Region(box), found, {}, Order::canonical), "overlap");
    answers.push_back({box,
                       {found.inside().begin(), found.inside().end()},
                       {found.crossing().begin(), found.crossing().end()}});
  }
  return answers;
}

}  // namespace winnow::bench
