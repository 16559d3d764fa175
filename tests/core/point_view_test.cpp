#include <gtest/gtest.h>
#include <winnow/core/point_view.h>

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace winnow::test {
namespace {

template <int kRows, int kCols, int kOrder>
using Matrix = Eigen::Matrix<double, kRows, kCols, kOrder>;

// The three coordinates of each point follow one another.
static_assert(detail::ArrayOfPoints<Matrix<3, Eigen::Dynamic, Eigen::ColMajor>>);
static_assert(detail::ArrayOfPoints<Matrix<Eigen::Dynamic, 3, Eigen::RowMajor>>);
static_assert(detail::ArrayOfPoints<Eigen::VectorXf>);
static_assert(!detail::ArrayOfPoints<Matrix<Eigen::Dynamic, 3, Eigen::ColMajor>>);
static_assert(!detail::ArrayOfPoints<Matrix<3, Eigen::Dynamic, Eigen::RowMajor>>);
static_assert(!detail::ArrayOfPoints<Eigen::Block<Eigen::MatrixXd>>);
static_assert(detail::ArrayOfPoints<Eigen::Map<const Eigen::Matrix3Xf>>);
static_assert(detail::ArrayOfPoints<Eigen::Map<Eigen::VectorXd>>);
static_assert(!detail::ArrayOfPoints<Eigen::Map<Eigen::VectorXd, 0, Eigen::InnerStride<2>>>);
static_assert(!detail::ArrayOfPoints<Eigen::Map<Eigen::Matrix3Xd, 0, Eigen::OuterStride<4>>>);
static_assert(!detail::ArrayOfPoints<Eigen::Map<Eigen::Matrix4Xd>>);
static_assert(!detail::ArrayOfPoints<std::vector<int>>);

struct UsersVertex {
  float u;
  float x, y, z;
};

template <typename Points>
void expect_two_points(const Points& points) {
  const PointView view(points);
  ASSERT_EQ(view.count, 2U);
  EXPECT_EQ(view[0], Vec3d(1, 2, 3));
  EXPECT_EQ(view[1], Vec3d(4, 5, 6));
}

TEST(PointView, containers_of_points_are_viewed) {
  expect_two_points(std::vector<Vec3f>{{1, 2, 3}, {4, 5, 6}});
  expect_two_points(std::array<Vec3d, 2>{Vec3d(1, 2, 3), Vec3d(4, 5, 6)});
  expect_two_points(std::vector<Eigen::Vector3d>{{1, 2, 3}, {4, 5, 6}});
  expect_two_points(std::vector<std::array<double, 3>>{{1, 2, 3}, {4, 5, 6}});
  expect_two_points(std::vector<UsersVertex>{{0, 1, 2, 3}, {0, 4, 5, 6}});
  const float rows[2][3] = {{1, 2, 3}, {4, 5, 6}};
  expect_two_points(rows);
}

TEST(PointView, numbers_are_viewed_three_by_three) {
  expect_two_points(std::vector<float>{1, 2, 3, 4, 5, 6});
  expect_two_points(std::vector<double>{1, 2, 3, 4, 5, 6, 7});
  expect_two_points(Eigen::Matrix3Xd(Eigen::Matrix<double, 3, 2>{{1, 4}, {2, 5}, {3, 6}}));
  expect_two_points(Matrix<2, 3, Eigen::RowMajor>{{1, 2, 3}, {4, 5, 6}});
  const double numbers[] = {1, 2, 3, 4, 5, 6};
  expect_two_points(Eigen::Map<const Eigen::Matrix3Xd>(numbers, 3, 2));
}

TEST(PointView, empty_container_has_no_points) {
  EXPECT_EQ(PointView(std::vector<float>{}).count, 0U);
  EXPECT_EQ(PointView(std::vector<Vec3d>{}).count, 0U);
}

template <typename Corners>
void expect_two_triangles(const Corners& corners) {
  const IndexView view(corners);
  ASSERT_EQ(view.count, 2U);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(view.corner(i / 3, i % 3), i);
}

TEST(IndexView, containers_of_indices_are_viewed) {
  expect_two_triangles(std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5});
  expect_two_triangles(std::vector<int>{0, 1, 2, 3, 4, 5, 6});
  expect_two_triangles(std::vector<std::uint16_t>{0, 1, 2, 3, 4, 5});
  const std::uint32_t flat[] = {0, 1, 2, 3, 4, 5};
  expect_two_triangles(flat);
  expect_two_triangles(std::span(flat));
}

TEST(IndexView, containers_of_triangles_are_viewed) {
  expect_two_triangles(std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {3, 4, 5}});
  expect_two_triangles(std::vector<std::array<std::int16_t, 3>>{{0, 1, 2}, {3, 4, 5}});
  expect_two_triangles(std::vector<Eigen::Vector3i>{{0, 1, 2}, {3, 4, 5}});
  const int rows[2][3] = {{0, 1, 2}, {3, 4, 5}};
  expect_two_triangles(rows);
}

TEST(IndexView, negative_index_is_of_no_vertex) {
  const std::vector<int> corners{0, 1, -1};
  EXPECT_EQ(IndexView(corners).corner(0, 2), std::numeric_limits<std::uint32_t>::max());
}

}  // namespace
}  // namespace winnow::test
