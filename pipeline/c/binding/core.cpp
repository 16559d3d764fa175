// C binding of status, version and instruction sets (core.h), and arguments shared by all calls.

#include <winnow/c/core.h>

#include "pipeline/c/binding/arguments.h"
#include "pipeline/c/binding/callers_memory.h"

#include <winnow/simd/isa.h>

#include <new>

#define WINNOW_SAME(name, value) \
  static_assert((name) == static_cast<winnow_status>(winnow::Status::value))
WINNOW_SAME(WINNOW_OK, ok);
WINNOW_SAME(WINNOW_INVALID_BOUNDS, invalid_bounds);
WINNOW_SAME(WINNOW_INVALID_KEY, invalid_key);
WINNOW_SAME(WINNOW_INVALID_ARGUMENT, invalid_argument);
WINNOW_SAME(WINNOW_SIZE_MISMATCH, size_mismatch);
WINNOW_SAME(WINNOW_OUT_OF_MEMORY, out_of_memory);
WINNOW_SAME(WINNOW_TOO_MANY_OBJECTS, too_many_objects);
WINNOW_SAME(WINNOW_UNSUPPORTED_VOLUME, unsupported_volume);
WINNOW_SAME(WINNOW_INVALID_SHAPE, invalid_shape);
WINNOW_SAME(WINNOW_INVALID_POSE, invalid_pose);
WINNOW_SAME(WINNOW_UNSUPPORTED, unsupported);
WINNOW_SAME(WINNOW_COMMUNICATION_FAILED, communication_failed);
#undef WINNOW_SAME

#define WINNOW_TEXT(x) #x
#define WINNOW_VERSION_TEXT(major, minor, patch) \
  WINNOW_TEXT(major) "." WINNOW_TEXT(minor) "." WINNOW_TEXT(patch)

namespace winnow::c {
namespace {

constexpr std::string_view kVersion =
    WINNOW_VERSION_TEXT(WINNOW_VERSION_MAJOR, WINNOW_VERSION_MINOR, WINNOW_VERSION_PATCH);
static_assert(kVersion == WINNOW_PROJECT_VERSION && WINNOW_ABI == WINNOW_PROJECT_ABI,
              "core.h and CMakeLists.txt name different versions");

}  // namespace

void* CallersMemory::do_allocate(std::size_t bytes, std::size_t alignment) {
  if (functions_.allocate == nullptr) return fallback_->allocate(bytes, alignment);
  void* const block = functions_.allocate(functions_.context, bytes, alignment);
  if (block == nullptr) throw std::bad_alloc();
  return block;
}

void CallersMemory::do_deallocate(void* block, std::size_t bytes, std::size_t alignment) {
  if (functions_.allocate == nullptr) {
    fallback_->deallocate(block, bytes, alignment);
  } else {
    functions_.deallocate(functions_.context, block, bytes, alignment);
  }
}

Filter filter_of(const winnow_filter* given) noexcept {
  if (given == nullptr) return {};
  Filter filter{given->layers, given->mask, given->environment, {}};
  if (given->accept == nullptr) return filter;
  filter.predicate.context = const_cast<winnow_filter*>(given);
  filter.predicate.accept = [](void* context, Key key, ClientData data) {
    const auto& c_filter = *static_cast<const winnow_filter*>(context);
    return c_filter.accept(c_filter.context, {key.id, key.stamp}, data);
  };
  return filter;
}

bool read_execution(const winnow_execution& given, Execution& execution) noexcept {
  switch (given.kind) {
    case WINNOW_EXECUTION_DEFAULT:
      return true;
    case WINNOW_EXECUTION_PARALLEL:
      execution = Execution::parallel();
      return true;
    case WINNOW_EXECUTION_SERIAL:
      execution = Execution::serial();
      return true;
    case WINNOW_EXECUTION_ON:
      execution = Execution::on({given.jobs.parallel_for, given.jobs.context, given.jobs.threads});
      return given.jobs.parallel_for != nullptr;
    default:
      return false;
  }
}

}  // namespace winnow::c

const char* winnow_status_name(winnow_status status) {
  winnow::Status known{};
  return winnow::c::read_choice(status, winnow::Status::communication_failed, known)
             ? winnow::to_string(known)
             : "unknown";
}

uint32_t winnow_version(void) {
  return WINNOW_VERSION_MAJOR << 16U | WINNOW_VERSION_MINOR << 8U | WINNOW_VERSION_PATCH;
}

const char* winnow_version_name(void) {
  return winnow::c::kVersion.data();
}

uint32_t winnow_abi(void) {
  return WINNOW_ABI;
}

const char* winnow_isa_name(void) {
  return winnow::isa_name();
}

const char* winnow_available_isa(size_t i) {
  const auto isas = winnow::available_isas();
  return i < isas.size() ? winnow::to_string(isas[i]) : nullptr;
}

winnow_status winnow_set_isa(const char* name) {
  if (name == nullptr) return WINNOW_INVALID_ARGUMENT;
  return winnow::c::answer(winnow::set_isa(std::string_view(name)));
}
