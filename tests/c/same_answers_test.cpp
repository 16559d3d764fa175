// Whatever is asked in C has the answers of C++, number by number.

#include "tests/c/notes.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace winnow::test {
namespace {

using Scenario = void (*)(const trace*);

void expect_same(Scenario in_c, Scenario in_cpp) {
  Notes c;
  Notes cpp;
  in_c(c.where());
  in_cpp(cpp.where());
  ASSERT_FALSE(cpp.all().empty());
  const std::size_t both = std::min(c.all().size(), cpp.all().size());
  for (std::size_t i = 0; i < both; ++i) {
    ASSERT_EQ(c.all()[i].first, cpp.all()[i].first) << "note " << i << " of " << both;
    ASSERT_EQ(c.all()[i].second, cpp.all()[i].second) << c.all()[i].first << ", note " << i;
  }
  EXPECT_EQ(c.all().size(), cpp.all().size());
}

TEST(CInterface, gives_the_answers_of_cpp_about_partitions) {
  expect_same(ask_partitions_in_c, ask_partitions_in_cpp);
}

TEST(CInterface, gives_the_answers_of_cpp_about_spheres_and_kdops) {
  expect_same(ask_volumes_in_c, ask_volumes_in_cpp);
}

TEST(CInterface, gives_the_answers_of_cpp_about_shapes) {
  expect_same(ask_shapes_in_c, ask_shapes_in_cpp);
}

TEST(CInterface, gives_the_answers_of_cpp_about_pairs_of_shapes) {
  expect_same(ask_narrow_phase_in_c, ask_narrow_phase_in_cpp);
}

TEST(CInterface, gives_the_answers_of_cpp_about_scenes) {
  expect_same(ask_scenes_in_c, ask_scenes_in_cpp);
}

}  // namespace
}  // namespace winnow::test
