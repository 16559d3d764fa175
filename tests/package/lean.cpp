// A program without exceptions and run-time types that implements the interfaces that winnow calls:
// memory, debug drawing, threads.

#include <winnow/winnow.h>

#include <array>
#include <cstdlib>

namespace {

class Memory final : public std::pmr::memory_resource {
 public:
  std::size_t requests = 0;

 private:
  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    ++requests;
    return std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
  }
  void do_deallocate(void* memory, std::size_t, std::size_t) override { std::free(memory); }
  bool do_is_equal(const memory_resource& other) const noexcept override { return this == &other; }
};

class Drawing final : public winnow::DebugDraw {
 public:
  int boxes = 0;

  void box(const winnow::Aabb&, winnow::Colour) override { ++boxes; }
  void line(const winnow::Vec3f&, const winnow::Vec3f&, winnow::Colour) override {}
  void sphere(const winnow::Sphere&, winnow::Colour) override {}
  void text(const winnow::Vec3f&, std::string_view, winnow::Colour) override {}
};

void backwards(void*, std::size_t count, winnow::JobSystem::Task task, void* tasks) {
  while (count > 0) task(tasks, --count);
}

}  // namespace

int main() {
  Memory memory;
  winnow::Partition partition(
      winnow::linear_bvh(),
      {.memory = &memory, .execution = winnow::Execution::on({backwards, nullptr, 4})});
  std::array<winnow::Aabb, 100> boxes;
  boxes.fill({{0, 0, 0}, {1, 1, 1}});
  std::array<winnow::Key, boxes.size()> keys;
  winnow::PairBuffer pairs;
  Drawing drawing;
  const bool works = partition.insert(boxes, {}, keys) == winnow::Status::ok &&
                     partition.self_pairs(pairs) == winnow::Status::ok &&
                     partition.debug_draw(drawing) == winnow::Status::ok;
  return works && pairs.size() == 4950 && drawing.boxes >= 100 && memory.requests > 0 ? 0 : 1;
}
