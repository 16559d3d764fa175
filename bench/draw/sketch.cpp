#include "bench/draw/sketch.h"

#include <winnow/partitions/debug_colours.h>

#include <algorithm>

namespace winnow::bench {

Sketch::Sketch() {
  layers_.push_back({"axis", kAxisColour, {}, {}});
  layers_.push_back({"cells", kCellColour, {}, {}});
  layers_.push_back({"contents of cells", kContentsColour, {}, {}});
  for (std::size_t depth = 0; depth < kNodeColours.size(); ++depth) {
    layers_.push_back({"nodes, depth " + std::to_string(depth), node_colour(depth), {}, {}});
  }
  layers_.push_back({"other", Colour{}, {}, {}});
}

SketchLayer& Sketch::layer_of(Colour colour) {
  const auto found = std::find_if(layers_.begin(), layers_.end() - 1,
                                  [&](const SketchLayer& layer) { return layer.colour == colour; });
  return *found;
}

void Sketch::box(const Aabb& box, Colour colour) {
  if (colour == kObjectColour) {
    objects_.push_back(box);
  } else {
    layer_of(colour).boxes.push_back(box);
  }
}

void Sketch::line(const Vec3f& from, const Vec3f& to, Colour colour) {
  SketchLayer& layer = layer_of(colour);
  layer.line_ends.push_back(from);
  layer.line_ends.push_back(to);
}

void Sketch::sphere(const Sphere& sphere, Colour colour) {
  box(sphere.bounds(), colour);
}

void Sketch::text(const Vec3f& at, std::string_view text, Colour colour) {
  texts_.push_back({at, std::string(text), colour});
}

std::vector<const SketchLayer*> Sketch::structure() const {
  std::vector<const SketchLayer*> drawn;
  for (const SketchLayer& layer : layers_) {
    if (!layer.boxes.empty() || !layer.line_ends.empty()) drawn.push_back(&layer);
  }
  return drawn;
}

}  // namespace winnow::bench
