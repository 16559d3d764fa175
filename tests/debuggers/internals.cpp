// Debug information of what partitions, scenes and contacts hold, as a winnow that was built with
// it has: the library that is tested has none.

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
