// Queries of `winnow query` about composite shapes and contacts.

#include "bench/questions/questions.h"

#include <gtest/gtest.h>

#include <string>

namespace winnow::bench {
namespace {

/// A cube with edges of 2 as a mesh; `flags` are members such as `"solid": true,`.
std::string cube(const std::string& flags, const std::string& position = "[0, 0, 0]") {
  return R"({"type": "mesh", )" + flags + R"(
    "v": [[-1,-1,-1],[1,-1,-1],[-1,1,-1],[1,1,-1],[-1,-1,1],[1,-1,1],[-1,1,1],[1,1,1]],
    "triangles": [[0,2,1],[1,2,3],[4,5,6],[5,7,6],[0,1,4],[1,5,4],
                  [2,6,3],[3,6,7],[0,4,2],[2,4,6],[1,3,5],[3,7,5]],
    "pose": {"position": )" +
         position + "}}";
}

std::string ball(const std::string& position, const std::string& radius = "0.5") {
  return R"({"type": "sphere", "radius": )" + radius + R"(, "pose": {"position": )" + position +
         "}}";
}

Json answer_to(const std::string& a, const std::string& b, const std::string& more = "") {
  const std::string question = "[{\"a\": " + a + ", \"b\": " + b + more + "}]";
  return answer(Json::parse(question), NarrowTier::robust, true)[0];
}

TEST(SceneQuestions, ball_in_solid_is_pushed_out) {
  const Json solid = answer_to(cube("\"solid\": true,"), ball("[0.6, 0, 0]"));
  EXPECT_EQ(solid["status"], "ok");
  EXPECT_EQ(solid["overlap"], true);
  EXPECT_NEAR(solid["distance"].get<double>(), -0.9, 1e-9);
  EXPECT_NEAR(solid["normal"][0].get<double>(), 1.0, 1e-9);
  ASSERT_EQ(solid["manifolds"].size(), 1U);
  EXPECT_NEAR(solid["manifolds"][0]["distance"].get<double>(), -0.9, 1e-9);
  EXPECT_NEAR(solid["manifolds"][0]["normal"][0].get<double>(), 1.0, 1e-9);
  EXPECT_NEAR(solid["manifolds"][0]["points"][0]["depth"].get<double>(), 0.9, 1e-6);
  const Json hollow = answer_to(cube(""), ball("[0, 0, 0]"));
  EXPECT_EQ(hollow["overlap"], false);
  EXPECT_NEAR(hollow["distance"].get<double>(), 0.5, 1e-9);
  EXPECT_TRUE(hollow["manifolds"].empty());
}

TEST(SceneQuestions, normals_lead_from_a_to_b) {
  const Json from_cube = answer_to(cube(""), ball("[0, 0, 1.4]"));
  const Json from_ball = answer_to(ball("[0, 0, 1.4]"), cube(""));
  for (const auto& [answer, sign] : {std::pair{from_cube, 1.0}, {from_ball, -1.0}}) {
    EXPECT_NEAR(answer["distance"].get<double>(), -0.1, 1e-9);
    EXPECT_NEAR(answer["normal"][2].get<double>(), sign, 1e-9);
    ASSERT_EQ(answer["manifolds"].size(), 1U);
    EXPECT_NEAR(answer["manifolds"][0]["normal"][2].get<double>(), sign, 1e-9);
    EXPECT_NEAR(answer["manifolds"][0]["points"][0]["position"][2].get<double>(), 0.95, 1e-6);
  }
}

TEST(SceneQuestions, contact_margin_shows_contacts_of_shapes_apart) {
  const std::string near = ball("[0, 0, 1.6]");
  EXPECT_TRUE(answer_to(cube(""), near)["manifolds"].empty());
  const Json within = answer_to(cube(""), near, ", \"contact_margin\": 0.2");
  ASSERT_EQ(within["manifolds"].size(), 1U);
  EXPECT_NEAR(within["manifolds"][0]["distance"].get<double>(), 0.1, 1e-9);
  EXPECT_EQ(answer_to(cube(""), near, ", \"contact_margin\": -1")["status"], "invalid_argument");
}

TEST(SceneQuestions, one_sided_mesh_ignores_objects_behind) {
  const std::string behind = ball("[0, 0, 0.9]", "0.3");
  EXPECT_EQ(answer_to(cube(""), behind)["overlap"], true);
  EXPECT_EQ(answer_to(cube("\"one_sided\": true,"), behind)["overlap"], false);
}

TEST(SceneQuestions, open_mesh_cannot_be_solid) {
  const Json open = answer_to(R"({"type": "mesh", "solid": true,
      "v": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2]]})",
                              ball("[0, 0, 0]"));
  EXPECT_EQ(open["status"], "invalid_shape");
  EXPECT_EQ(open.size(), 2U);
  EXPECT_EQ(answer_to(cube("\"solid\": 1,"), ball("[0, 0, 0]"))["status"], "invalid_argument");
}

TEST(SceneQuestions, ray_hits_mesh) {
  const Json hit = answer(Json::parse(R"([{"ray": {"origin": [0.3, 0.2, 5],
      "direction": [0, 0, -1]}, "target": )" +
                                      cube("") + "}]"),
                          NarrowTier::robust)[0];
  EXPECT_EQ(hit["status"], "ok");
  EXPECT_EQ(hit["hit"], true);
  EXPECT_NEAR(hit["t"].get<double>(), 4.0, 1e-12);
  EXPECT_EQ(hit["normal"], Json::array({0.0, 0.0, 1.0}));
}

}  // namespace
}  // namespace winnow::bench
