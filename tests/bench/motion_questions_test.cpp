// Queries of `winnow query` about features in motion.

#include "bench/questions/questions.h"

#include <gtest/gtest.h>

#include <string>

namespace winnow::bench {
namespace {

/// A vertex that falls from height 1 to -1 above a face at rest.
Json falling_vertex() {
  return Json::parse(R"({"id": "fall", "motion": {"kind": "vertex_face",
    "start": [[0.25, 0.25, 1], [0, 0, 0], [1, 0, 0], [0, 1, 0]],
    "end": [[0.25, 0.25, -1], [0, 0, 0], [1, 0, 0], [0, 1, 0]]}})");
}

Json answer_to_one(const Json& question) {
  return answer(Json::array({question}), NarrowTier::robust)[0];
}

TEST(MotionQuestions, query_returns_the_time_of_first_touch) {
  const Json got = answer_to_one(falling_vertex());
  EXPECT_EQ(got["id"], "fall");
  EXPECT_EQ(got["status"], "ok");
  EXPECT_EQ(got["hit"], true);
  EXPECT_LE(got["time"].get<double>(), 0.5);
  EXPECT_GE(got["time"].get<double>(), 0.5 - 1e-9);
  EXPECT_EQ(got.size(), 4U);
  Json edges = falling_vertex();
  edges["motion"]["kind"] = "edge_edge";
  edges["motion"]["start"] = Json::parse("[[-1,0,1],[1,0,1],[0,-1,0],[0,1,0]]");
  edges["motion"]["end"] = Json::parse("[[-1,0,0.5],[1,0,0.5],[0,-1,0],[0,1,0]]");
  EXPECT_EQ(answer_to_one(edges)["hit"], false);
  EXPECT_EQ(answer_to_one(edges)["time"], "inf");
}

TEST(MotionQuestions, separation_in_the_query_makes_the_time_earlier) {
  Json question = falling_vertex();
  question["min_separation"] = 0.5;
  EXPECT_NEAR(answer_to_one(question)["time"].get<double>(), 0.25, 1e-9);
  question["min_separation"] = -1;
  EXPECT_EQ(answer_to_one(question)["status"], "invalid_argument");
  question["min_separation"] = "wide";
  EXPECT_EQ(answer_to_one(question)["status"], "invalid_argument");
}

TEST(MotionQuestions, hexadecimal_numbers_are_read) {
  const Json plain = answer_to_one(falling_vertex());
  Json question = falling_vertex();
  question["motion"]["start"][0] = {"0x1p-2", "+0X.4P+0", "0x1.0p+0"};
  question["motion"]["end"][0][2] = "-0x1";
  EXPECT_EQ(answer_to_one(question), plain);
  for (const char* bad : {"0x", "0xinf", "0x-1p0", "1.0", "0x1p0 ", " 0x1p0", "0x1p99999", ""}) {
    question["motion"]["end"][0][2] = bad;
    EXPECT_EQ(answer_to_one(question)["status"], "invalid_argument") << bad;
  }
}

TEST(MotionQuestions, invalid_queries_get_an_error_status) {
  for (const char* bad : {"nan", "inf", "-inf"}) {
    Json question = falling_vertex();
    question["motion"]["end"][3][1] = bad;
    const Json got = answer_to_one(question);
    EXPECT_EQ(got["status"], "invalid_bounds");
    EXPECT_EQ(got.size(), 2U);
  }
  Json far = falling_vertex();
  far["motion"]["start"][0][0] = 1e308;
  far["motion"]["start"][1][0] = -1e308;
  EXPECT_EQ(answer_to_one(far)["status"], "invalid_bounds");
  for (const char* name : {"kind", "start", "end"}) {
    for (const Json& bad : {Json(), Json("edge"), Json(7), Json::array({1, 2, 3, 4})}) {
      Json question = falling_vertex();
      question["motion"][name] = bad;
      EXPECT_EQ(answer_to_one(question)["status"], "invalid_argument");
    }
  }
  EXPECT_EQ(answer_to_one({{"id", 1}, {"motion", "none"}})["status"], "invalid_argument");
}

}  // namespace
}  // namespace winnow::bench
