#include "bench/commands/arguments.h"
#include "bench/commands/command.h"
#include "bench/commands/target.h"
#include "bench/common/json.h"
#include "bench/common/table.h"
#include "bench/contenders/partitions.h"
#include "bench/draw/page.h"
#include "bench/draw/picture.h"

#include <iostream>

namespace winnow::bench {
namespace {

struct Draw {
  Target target;
  std::size_t frame = 0;
  std::string partition = "LinearBvh";
  std::vector<std::string> rays;
  std::vector<std::string> boxes;
  PictureOptions options;
  std::string out;
  std::string json;

  int run();
};

int Draw::run() {
  for (const std::string& ray : rays) options.rays.push_back(parse_ray(ray));
  for (const std::string& box : boxes) options.boxes.push_back(parse_box(box));
  const auto source = target.source(target.named());
  if (const std::size_t most = largest_for(partition); source->boxes().size() > most) {
    throw ArgumentError("--partition: " + partition + " takes too long on more than " +
                        grouped(most) + " objects");
  }
  const Stage stage(partition, *source, frame);
  const Picture picture(source->name(), frame, stage, options);
  const std::size_t bytes = write_page(out, picture.data());
  const Json counts = picture.counts();
  Table table({"in the picture", "number"});
  for (const auto& [name, value] : counts.items()) {
    if (value.is_number_unsigned()) table.add({name, grouped(value.get<std::size_t>())});
    if (!value.is_object()) continue;
    for (const auto& [layer, number] : value.items()) {
      table.add({"drawn: " + layer, grouped(number.get<std::size_t>())});
    }
  }
  std::cout << partition << " on " << source->name() << '\n'
            << table << out << ": " << grouped(bytes) << " bytes; open it in a browser\n";
  write_json(json, counts);
  return kDone;
}

}  // namespace

Command add_draw(CLI::App& app) {
  auto draw = std::make_shared<Draw>();
  CLI::App* sub = app.add_subcommand(
      "draw",
      "Writes one frame as an HTML page that can be turned, moved and zoomed: objects, the "
      "partition's structure, overlapping pairs, and what rays and boxes hit.");
  draw->target.add_to(*sub);
  sub->add_option("--frame", draw->frame, "Which frame; the first one is 0")
      ->check(CLI::Range(std::size_t{0}, std::size_t{1'000'000}))
      ->capture_default_str();
  sub->add_option("--partition", draw->partition, "Which partition")
      ->check(CLI::IsMember(all_partitions()))
      ->capture_default_str();
  sub->add_option("--ray", draw->rays,
                  "ox,oy,oz,dx,dy,dz: its closest hit and all hits; repeatable")
      ->allow_extra_args(false);
  sub->add_option("--box", draw->boxes, "x0,y0,z0,x1,y1,z1: what overlaps it; repeatable")
      ->allow_extra_args(false);
  sub->add_option("--max-objects", draw->options.most_objects,
                  "Objects drawn, evenly chosen; those hit by a ray or box besides")
      ->check(CLI::Range(std::size_t{1}, std::size_t{100'000'000}))
      ->capture_default_str();
  sub->add_option("--max-depth", draw->options.max_depth, "Levels of nodes drawn, from the root")
      ->check(CLI::Range(0, 64))
      ->capture_default_str();
  sub->add_flag("--labels", draw->options.labels, "Client data beside the first 500 objects");
  sub->add_option("--out", draw->out, "The page to write")->required();
  add_json_option(*sub, draw->json);
  return {sub, [draw] { return draw->run(); }};
}

}  // namespace winnow::bench
