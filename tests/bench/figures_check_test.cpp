#include "bench/measure/figures_check.h"

#include "bench/common/errors.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace winnow::bench {
namespace {

class FiguresCheck : public testing::Test {
 protected:
  FiguresCheck() {
    const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
    path_ =
        std::filesystem::temp_directory_path() / (std::string("winnow_") + test.name() + ".csv");
  }
  ~FiguresCheck() override { std::filesystem::remove(path_); }

  void write(const std::string& text) const { std::ofstream(path_) << text; }
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

TEST_F(FiguresCheck, chosen_partition_is_compared_with_the_fastest) {
  write(
      "kind,scene,objects,threads,median_ms\n"
      "LinearBvh,uniform,500,1,0.3\n"
      "BoundsNSquared,uniform,500,1,0.1\n"
      "BoundsNSquared,uniform,500,2,0.01\n"
      "LooseOctree,uniform,500,1,0.02\n");
  const auto checks = check_figures(path(), 8);
  ASSERT_EQ(checks.size(), 1U);
  EXPECT_EQ(checks[0].scene, "uniform");
  EXPECT_EQ(checks[0].objects, 500U);
  EXPECT_EQ(checks[0].chosen, "LinearBvh");
  EXPECT_EQ(checks[0].best, "BoundsNSquared");
  EXPECT_DOUBLE_EQ(checks[0].times_best, 3.0);
}

TEST_F(FiguresCheck, file_without_a_valid_table_is_refused) {
  EXPECT_THROW((void)check_figures(path() + ".none", 8), ArgumentError);
  write("scene,objects,threads,kind\nuniform,500,1,LinearBvh\n");
  EXPECT_THROW((void)check_figures(path(), 8), ArgumentError);
  write("scene,objects,threads,kind,median_ms\nuniform,many,1,LinearBvh,0.3\n");
  EXPECT_THROW((void)check_figures(path(), 8), ArgumentError);
  write("scene,objects,threads,kind,median_ms\nuniform,500,1,LinearBvh\n");
  EXPECT_THROW((void)check_figures(path(), 8), ArgumentError);
}

}  // namespace
}  // namespace winnow::bench
