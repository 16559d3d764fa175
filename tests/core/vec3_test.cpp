#include <gtest/gtest.h>
#include <winnow/core/eigen.h>
#include <winnow/core/vectors.h>
#include <winnow/core/volumes.h>

#include <Eigen/Geometry>
#include <array>
#include <limits>

#include "tests/support/random.h"

namespace winnow::test {
namespace {

// A vector class of a user.
class UsersPoint {
 public:
  UsersPoint(float x, float y, float z) : at_{x, y, z} {}
  [[nodiscard]] float x() const { return at_[0]; }
  [[nodiscard]] float y() const { return at_[1]; }
  [[nodiscard]] float z() const { return at_[2]; }

 private:
  std::array<float, 3> at_;
};

TEST(Vec3, operators_compute_componentwise) {
  constexpr Vec3f a{1, 2, 3};
  constexpr Vec3f b{4, -5, 6};
  static_assert(a + b == Vec3f(5, -3, 9) && a - b == Vec3f(-3, 7, -3) && -a == Vec3f(-1, -2, -3));
  static_assert(a * 2.0F == Vec3f(2, 4, 6) && 2.0F * a == a * 2.0F &&
                b / 2.0F == Vec3f(2, -2.5, 3));
  static_assert(a.dot(b) == 12.0F && a.cross(b) == Vec3f(27, 6, -13));
  static_assert(a.squared_norm() == 14.0F && Vec3f(3, 0, 4).squared_norm() == 25.0F);
  static_assert(a.min(b) == Vec3f(1, -5, 3) && a.max(b) == Vec3f(4, 2, 6));
  static_assert(b.abs() == Vec3f(4, 5, 6) && Vec3f::constant(2) == Vec3f(2, 2, 2));
  static_assert(Vec3f().is_zero() && !a.is_zero() && a[2] == 3.0F && a.z() == 3.0F);
  EXPECT_EQ(Vec3f(3, 0, 4).norm(), 5.0F);
}

TEST(Vec3, vector_with_infinity_or_nan_is_not_finite) {
  EXPECT_TRUE(Vec3f::constant(std::numeric_limits<float>::max()).all_finite());
  for (const float bad :
       {std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
        std::numeric_limits<float>::quiet_NaN()}) {
    for (int axis = 0; axis < 3; ++axis) {
      Vec3f v{1, 2, 3};
      v[axis] = bad;
      EXPECT_FALSE(v.all_finite());
    }
  }
}

TEST(Vec3, foreign_vectors_convert_in_and_eigen_out) {
  const Aabb box{UsersPoint(1, 2, 3), Eigen::Vector3f(4, 5, 6)};
  EXPECT_EQ(box, (Aabb{{1, 2, 3}, {4, 5, 6}}));
  const Eigen::Vector3f max = box.max;
  EXPECT_EQ(Vec3f(max + Eigen::Vector3f(box.min)), Vec3f(5, 7, 9));
  EXPECT_EQ(max - box.min, Vec3f(3, 3, 3));
}

TEST(Vec3, arrays_and_structs_convert_in) {
  struct Users {
    float x, y, z;
  };
  const float numbers[3] = {1, 2, 3};
  EXPECT_EQ(Vec3f(numbers), Vec3f(1, 2, 3));
  EXPECT_EQ(Vec3d(std::array{1.0, 2.0, 3.0}), Vec3d(1, 2, 3));
  EXPECT_EQ(Vec3d(Users{1, 2, 3}), Vec3d(1, 2, 3));
}

TEST(Vec3, only_conversions_without_loss_are_implicit) {
  EXPECT_EQ(Vec3d(Vec3f(0.1F, 0, 0)).x(), static_cast<double>(0.1F));
  static_assert(std::is_convertible_v<Vec3f, Vec3d> && !std::is_convertible_v<Vec3d, Vec3f> &&
                !std::is_convertible_v<Eigen::Vector3d, Vec3f> &&
                !std::is_convertible_v<std::array<double, 3>, Vec3f>);
}

TEST(Vec3, as_eigen_maps_the_same_memory) {
  Vec3d v{1, -2, 3};
  as_eigen(v) *= 2.0;
  EXPECT_EQ(v, Vec3d(2, -4, 6));
  EXPECT_EQ(as_eigen(v).cwiseAbs().maxCoeff(), 6.0);
}

TEST(Matrix, matrix_converts_to_eigen_and_back) {
  Random random(77);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d axis(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(random.uniform(-4, 4), axis.normalized()).toRotationMatrix();
    const Mat3d matrix = turn;
    EXPECT_EQ(Eigen::Matrix3d(matrix), turn);
    EXPECT_EQ(as_eigen(matrix), turn);
    EXPECT_EQ(matrix.column(1), Vec3d(turn.col(1)));
    EXPECT_EQ(matrix.cast<float>()(2, 0), static_cast<float>(turn(2, 0)));
    const Mat3d product = turn * turn;
    EXPECT_EQ(as_eigen(product), (turn * turn).eval());
  }
  EXPECT_EQ(Mat3f::identity(), Mat3f(1, 0, 0, 0, 1, 0, 0, 0, 1));
  EXPECT_EQ(Mat3f(0, 1, 2, 3, 4, 5, 6, 7, 8)(1, 2), 5.0F);
}

}  // namespace
}  // namespace winnow::test
