#include "bench/commands/command.h"
#include "bench/commands/options.h"
#include "bench/common/json.h"
#include "bench/common/table.h"
#include "bench/contenders/partitions.h"
#include "bench/draw/picture.h"
#include "bench/pages/page.h"
#include "bench/recordings/recording.h"

#include <iostream>
#include <limits>

namespace winnow::bench {
namespace {

struct View {
  Target target;
  std::size_t frame = 0;
  std::size_t frames = 1;
  std::string partition = "LinearBvh";
  std::vector<std::vector<float>> rays;
  std::vector<std::vector<float>> boxes;
  PictureOptions options;
  std::string out = "winnow-view.html";
  std::string json;

  void add_options(CLI::App& app);
  int run();

 private:
  [[nodiscard]] Json draw_frames(const NamedScene& scene, FrameSource& source) const;
};

void View::add_options(CLI::App& app) {
  target.add_to(app);
  number(app, "--frame", frame, 0, 1e6, "Number of the frame, from 0");
  number(app, "--frames", frames, 0, 1e6,
         "Number of frames from that one on, with a slider to play them; 0: all frames of a "
         "recording, 1,000 of a scene");
  one_of(app, "--partition", partition, all_partitions(), "Partition");
  app.add_option("--ray", rays,
                 "Ray as ox,oy,oz,dx,dy,dz: draw its closest hit and all hits; repeatable")
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option("--box", boxes,
                 "Box as x0,y0,z0,x1,y1,z1: draw the objects that overlap it; repeatable")
      ->delimiter(',')
      ->allow_extra_args(false);
  number(app, "--max-objects", options.most_objects, 1, 1e8,
         "Largest number of drawn objects, evenly chosen; objects hit by a ray or box are drawn in "
         "addition");
  number(app, "--max-depth", options.max_depth, 0, 64,
         "Levels of nodes that are drawn, from the root");
  option(app, "--out", out, "HTML page to write");
  add_json_option(app, json);
}

Json View::draw_frames(const NamedScene& scene, FrameSource& source) const {
  constexpr std::size_t kOfEndless = 1000;  // built-in scenes have no last frame
  PartitionEngine engine(partition, 1);
  ChangedRows changes;
  std::size_t now = 0;
  const auto show = [&] {
    const auto changed = changes.next(source.boxes());
    now == 0 ? engine.start(source.boxes()) : engine.frame(changed, source.boxes());
  };
  const auto advance = [&] {
    if (!source.advance()) return false;
    ++now;
    show();
    return true;
  };
  show();
  while (now < frame) {
    if (!advance()) throw ArgumentError("--frame: the last frame is " + std::to_string(now));
  }
  constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();
  const std::size_t there_are = scene.is_recording() ? kNoLimit : kOfEndless;
  const std::size_t most = frames == 0 ? there_are : frames;
  Json pictures = Json::array();
  do {
    std::span<const RecordedContact> contacts;
    if (scene.is_recording() && now < scene.recording->contacts.size()) {
      contacts = scene.recording->contacts[now];
    }
    pictures.push_back(picture_of(source.name(), now, engine, options, contacts));
  } while (pictures.size() < most && advance());
  return pictures;
}

int View::run() {
  for (const std::vector<float>& n : rays) {
    if (n.size() != 6 ||
        !options.rays.emplace_back(Ray{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}}).is_valid()) {
      throw ArgumentError("--ray needs six finite numbers, and a direction that is not zero");
    }
  }
  for (const std::vector<float>& n : boxes) {
    if (n.size() != 6 ||
        !options.boxes.emplace_back(Aabb{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}}).is_valid()) {
      throw ArgumentError("--box needs three lower ends, then three upper ends");
    }
  }
  const NamedScene scene = target.named();  // a recording must outlive its source
  const auto source = target.source(scene);
  if (const std::size_t most = largest_for(partition); source->objects() > most) {
    throw ArgumentError("--partition: " + partition + " takes too long on more than " +
                        grouped(most) + " objects");
  }
  const Json pictures = draw_frames(scene, *source);
  const std::size_t bytes = write_page(out, kDrawPage, pictures);
  Json counts = pictures.front()["counts"];
  if (pictures.size() > 1) counts["frames"] = pictures.size();
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

void add_view(CLI::App& app) {
  command<View>(app, "view", "Writes frames of a recording or scene as an HTML page with a 3D view",
                "The view can be rotated, moved and zoomed. It shows objects, the structure, "
                "overlapping pairs, hits of rays and boxes, and the contacts of a recorded scene.");
}

}  // namespace winnow::bench
