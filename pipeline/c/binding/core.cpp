// C functions of status, version and instruction sets (core.h), and the memory of handles.

#include <winnow/c/core.h>

#include "pipeline/c/binding/structs.h"

#include <winnow/simd/isa.h>

#include <new>

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

}  // namespace winnow::c

const char* winnow_status_name(winnow_status status) {
  winnow::Status known{};
  return winnow::c::read(status, known) ? winnow::to_string(known) : "unknown";
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
