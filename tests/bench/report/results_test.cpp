// Tests of the rows of results: their names, and the form in which they are written.

#include "bench/rows/results.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace winnow::bench {
namespace {

Json frame(const char* partition, const std::vector<double>& ms) {
  return {{"scene", "uniform"},     {"objects", 10'000U},
          {"partition", partition}, {"threads", 1},
          {"isa", "avx2"},          {"frame_ms", to_value(ms)},
          {"first_ms", 2.5},        {"update_ms", to_value(ms)},
          {"command", "again"}};
}

TEST(Results, words_of_names_are_snake_case) {
  EXPECT_EQ(word_of("LinearBvh"), "linear_bvh");
  EXPECT_EQ(word_of("BoundsNSquared"), "bounds_n_squared");
  EXPECT_EQ(word_of("FCL tree"), "fcl_tree");
  EXPECT_EQ(word_of("AABB + 5 %"), "aabb_plus_5_percent");
  EXPECT_EQ(word_of("footprint()"), "footprint");
  EXPECT_EQ(word_of("a/b:c"), "a_b_c");
}

TEST(Results, document_has_the_form_of_google_benchmark) {
  Results results;
  results.context()["isa"] = "avx2";
  const std::string name = results.add("throughput", frame("LinearBvh", {3.0, 1.0, 2.0}));
  EXPECT_EQ(name, "throughput/uniform/objects:10000/threads:1/linear_bvh/isa:avx2");
  const Json document = Json::parse(document_text(results.document()));
  EXPECT_EQ(document["context"]["isa"], "avx2");
  ASSERT_EQ(document["benchmarks"].size(), 1U);
  const Json& row = document["benchmarks"][0];
  EXPECT_EQ(row["name"], name);
  EXPECT_EQ(row["run_type"], "iteration");
  EXPECT_EQ(row["iterations"], 3);
  EXPECT_EQ(row["real_time"], 2.0);
  EXPECT_EQ(row["cpu_time"], 2.0);
  EXPECT_EQ(row["time_unit"], "ms");
  EXPECT_EQ(row["real_time_min"], 1.0);
  EXPECT_EQ(row["real_time_max"], 3.0);
  EXPECT_EQ(row["update_ms"], 2.0);
  EXPECT_EQ(row["update_ms_max"], 3.0);
  EXPECT_EQ(row["first_ms"], 2.5);
  EXPECT_FALSE(row.contains("scene"));
}

TEST(Results, row_with_a_known_name_replaces_the_row) {
  Results results;
  results.add("throughput", frame("LinearBvh", {1.0}));
  results.add("throughput", frame("FlatGrid", {2.0}));
  results.add("throughput", frame("LinearBvh", {5.0}));
  ASSERT_EQ(results.rows("throughput").size(), 2U);
  EXPECT_EQ(value_of(*results.row("throughput", {{"partition", "LinearBvh"}}), "frame_ms"), 5.0);
  EXPECT_EQ(results.row("throughput", {{"partition", "StaticBvh"}}), nullptr);
}

TEST(Results, values_that_are_not_finite_are_left_out) {
  Results results;
  Json row = frame("LinearBvh", {});
  row["first_ms"] = std::numeric_limits<double>::quiet_NaN();
  results.add("throughput", std::move(row));
  const Json written = results.document()["benchmarks"][0];
  EXPECT_FALSE(written.contains("first_ms"));
  EXPECT_EQ(written["real_time"], 0.0);
  EXPECT_TRUE(std::isnan(value_of(*results.rows("throughput").front(), "frame_ms")));
}

TEST(Results, unknown_family_is_refused) {
  Results results;
  EXPECT_THROW(results.add("none", Json::object()), std::logic_error);
  EXPECT_TRUE(results.document()["benchmarks"].empty());
}

TEST(Results, rows_of_another_process_are_adopted) {
  Results results;
  results.adopt(Json::array({{{"name", "memory/uniform"}, {"reserved", 80}}}));
  EXPECT_EQ(results.document()["benchmarks"][0]["reserved"], 80);
}

TEST(Results, printed_rows_share_the_keys_in_the_title) {
  Results results;
  results.add("throughput", frame("LinearBvh", {1.0, 2.0, 3.0}));
  results.add("throughput", frame("FlatGrid", {4.0}));
  std::ostringstream out;
  print_rows(out, results, "throughput", {"frame_ms"});
  EXPECT_NE(out.str().find("throughput, scene uniform, objects 10,000, threads 1, isa avx2"),
            std::string::npos)
      << out.str();
  EXPECT_NE(out.str().find("2.00 (1.00 to 3.00)"), std::string::npos) << out.str();
  EXPECT_EQ(out.str().find("first"), std::string::npos) << out.str();
}

}  // namespace
}  // namespace winnow::bench
