// Emits debug information for the internal types of partitions, scenes and contacts, as a debug
// build of winnow has it; the library under test is built without.

#include "partitions/state/partition_state.h"
#include "pipeline/scene/contact_frame.h"
#include "pipeline/scene/scene_state.h"

namespace winnow::test {

std::size_t sizes_of_internals() {
  const PartitionState* partition = nullptr;
  const SceneState* scene = nullptr;
  const ContactsState* contacts = nullptr;
  const StructureInfo* structure = nullptr;
  return sizeof *partition + sizeof *scene + sizeof *contacts + sizeof *structure;
}

}  // namespace winnow::test
