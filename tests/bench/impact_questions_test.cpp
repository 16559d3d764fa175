// Queries about moving shapes, through the interface of `winnow query`.

#include "bench/questions/questions.h"

#include <gtest/gtest.h>

#include <string>

namespace winnow::bench {
namespace {

Json answer_to_one(const char* question) {
  const Json answers = answer(Json::parse("[" + std::string(question) + "]"), NarrowTier::robust);
  EXPECT_EQ(answers.size(), 1U);
  return answers[0];
}

TEST(ImpactQuestions, moving_shapes_that_touch_get_a_time) {
  const Json hit = answer_to_one(R"({"id": 7,
    "a": {"type": "box", "half": [1, 1, 1]},
    "b": {"type": "sphere", "radius": 0.5, "pose": {"position": [5.5, 0, 0]},
          "end_pose": {"position": [-2.5, 0, 0]}}})");
  EXPECT_EQ(hit["id"], 7);
  EXPECT_EQ(hit["status"], "ok");
  EXPECT_EQ(hit["hit"], true);
  EXPECT_NEAR(hit["time"].get<double>(), 0.5, 1e-6);
  EXPECT_LE(hit["time"].get<double>(), 0.5);
  EXPECT_LE(hit["gap"].get<double>(), 0.5e-6);
  EXPECT_NEAR(hit["normal"][0].get<double>(), 1.0, 1e-9);
  EXPECT_NEAR(hit["points"][0][0].get<double>(), 1.0, 1e-9);
  EXPECT_NEAR(hit["points"][1][0].get<double>(), 1.0, 1e-6);
  EXPECT_LE(hit["error_bound"].get<double>(), 1e-12);
  const Json miss = answer_to_one(R"({
    "a": {"type": "box", "half": [1, 1, 1], "end_pose": {"position": [0, 9, 0]}},
    "b": {"type": "sphere", "radius": 0.5, "pose": {"position": [5.5, 0, 0]}}})");
  EXPECT_EQ(miss["status"], "ok");
  EXPECT_EQ(miss["hit"], false);
  EXPECT_EQ(miss["time"], "inf");
  EXPECT_FALSE(miss.contains("overlap"));
}

TEST(ImpactQuestions, composite_shapes_get_a_time) {
  const auto time_with = [](const std::string& shape) {
    const Json got = answer_to_one((R"({"a": )" + shape +
                                    R"(, "b": {"type": "sphere", "radius": 0.5,
                                        "pose": {"position": [0.25, 0.125, 4.5]},
                                        "end_pose": {"position": [0.25, 0.125, -3.5]}}})")
                                       .c_str());
    EXPECT_EQ(got["status"], "ok");
    return got["hit"] == true ? got["time"].get<double>() : -1.0;
  };
  EXPECT_NEAR(time_with(R"({"type": "mesh", "v": [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
                            "triangles": [[0, 1, 2]]})"),
              0.5, 1e-6);
  EXPECT_NEAR(time_with(R"({"type": "height_field", "heights": [[1, 1], [1, 1]]})"), 0.375, 1e-6);
  EXPECT_NEAR(time_with(R"({"type": "compound", "children": [
                {"type": "box", "half": [1, 1, 1], "pose": {"position": [0, 0, -5]}},
                {"type": "box", "half": [1, 1, 1], "pose": {"position": [0, 0, 1]}}]})"),
              0.25, 1e-6);
  EXPECT_NEAR(time_with(R"({"type": "compound", "children": [
                {"type": "sphere", "radius": 0.25, "pose": {"position": [9, 0, 0]}},
                {"type": "mesh", "v": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]],
                 "pose": {"position": [0, 0, 1]}},
                {"type": "height_field", "heights": [[1, 1], [1, 1]]}]})"),
              0.375, 1e-6);
  EXPECT_EQ(answer_to_one(R"({"a": {"type": "mesh", "v": [[0, 0, 0]], "triangles": [[0, 0, 7]],
                                    "end_pose": {}},
                              "b": {"type": "sphere", "radius": 1}})")["status"],
            "invalid_shape");
  for (const char* const bad :
       {R"({"type": "mesh", "v": [[0, 0, 0]], "end_pose": {}})",
        R"({"type": "height_field", "heights": [[0, 1], [0]], "end_pose": {}})",
        R"({"type": "compound", "children": 3, "end_pose": {}})",
        R"({"type": "compound", "children": [7], "end_pose": {}})",
        R"({"type": "compound", "children": [{"type": "compound", "children": []}],
            "end_pose": {}})"}) {
    const std::string question =
        std::string(R"({"b": {"type": "sphere", "radius": 1}, "a": )") + bad + "}";
    EXPECT_EQ(answer_to_one(question.c_str())["status"], "invalid_argument");
  }
}

TEST(ImpactQuestions, bad_queries_get_an_error_status) {
  const auto status_with = [](const std::string& end) {
    const Json got = answer_to_one((R"({"a": {"type": "sphere", "radius": 1, "end_pose": )" + end +
                                    R"(}, "b": {"type": "sphere", "radius": 1}})")
                                       .c_str());
    return got["status"].get<std::string>();
  };
  EXPECT_EQ(status_with(R"({"position": [1, 2, 3]})"), "ok");
  EXPECT_EQ(status_with(R"({"position": ["nan", 2, 3]})"), "invalid_pose");
  EXPECT_EQ(status_with(R"({"position": ["inf", 2, 3]})"), "invalid_pose");
  EXPECT_EQ(status_with(R"({"orientation": [0, 0, 0, 0]})"), "invalid_pose");
  EXPECT_EQ(status_with(R"({"position": [1, 2]})"), "invalid_argument");
  EXPECT_EQ(status_with("3"), "invalid_argument");
  EXPECT_EQ(status_with("null"), "invalid_argument");
}

}  // namespace
}  // namespace winnow::bench
