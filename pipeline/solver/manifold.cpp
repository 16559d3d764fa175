#include <winnow/pipeline/solver/manifold.h>

namespace winnow::solver {

void make_manifold(const Problem&, double, PairAnswer& answer) noexcept {
  answer.contact_count = 1;
  ContactPoint& contact = answer.contacts[0];
  for (int i = 0; i < 3; ++i) {
    contact.position[i] =
        static_cast<float>(answer.point[i] + 0.5 * answer.distance * answer.normal[i]);
  }
  contact.depth = static_cast<float>(-answer.distance);
  contact.feature = 0;
}

}  // namespace winnow::solver
