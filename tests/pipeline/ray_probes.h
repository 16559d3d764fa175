#pragma once

#include <winnow/pipeline/shape_pool.h>

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

namespace winnow::test {

/// A shape and its distance function in its own frame: negative inside, if the shape has an inside.
struct RayProbe {
  std::string name;
  ShapeId id;
  std::function<double(const Eigen::Vector3d&)> distance;
};

/// Shapes of every kind, with and without rounding, flat ones included. The distance functions do
/// not use the library.
class RayProbes {
 public:
  RayProbes();
  [[nodiscard]] const std::vector<RayProbe>& probes() const { return probes_; }
  [[nodiscard]] const ShapeTables& tables() const { return pool_.tables(); }

 private:
  void add_box(const Eigen::Vector3d& half, double r);
  void add_box_hull(const Eigen::Vector3d& half, double r);
  void add_triangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                    double r);
  void add_cylinder(double radius, double half, double r);
  void add_cone(double radius, double half, double r);
  void add_capsule(double radius, double half);
  void add_half_space(const Eigen::Vector3d& normal, double offset);
  void put(Status status, const std::string& name, ShapeId id,
           std::function<double(const Eigen::Vector3d&)> distance);

  ShapePool pool_;
  std::vector<RayProbe> probes_;
};

}  // namespace winnow::test
