// The derivative of both lenses against central differences of the projection.

#include <gtest/gtest.h>

#include <random>

#include "pilotfish/core/camera_model.hpp"

namespace {

using namespace pilotfish;
using Eigen::Vector2d;

CameraModel brown_conrady() {
  CameraModel camera{640, 480, 420.0, 430.0, 330.0, 230.0};
  camera.k1 = -0.28, camera.k2 = 0.08, camera.p1 = 0.006, camera.p2 = -0.004, camera.k3 = 0.01;
  return camera;
}

CameraModel fisheye() {
  CameraModel camera{640, 480, 250.0, 251.0, 322.0, 236.0};
  camera.k1 = -0.04, camera.k2 = 0.012, camera.k3 = -0.005, camera.k4 = 0.0006;
  camera.lens = Lens::kannala_brandt;
  return camera;
}

/// Largest difference, relative to the derivative, over points up to `radius` off the axis.
double worst_difference(const CameraModel& camera, double radius) {
  constexpr double kStep = 1e-6;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> coordinate(-radius, radius);
  double worst = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const Vector2d point(coordinate(random), coordinate(random));
    Eigen::Matrix2d differences;
    for (int axis = 0; axis < 2; ++axis) {
      const Vector2d step = kStep * Vector2d::Unit(axis);
      differences.col(axis) =
          (project_normalized(camera, point + step) - project_normalized(camera, point - step)) / (2.0 * kStep);
    }
    const Eigen::Matrix2d derivative = pixels_from_normalized(camera, point);
    worst = std::max(worst, (derivative - differences).norm() / derivative.norm());
  }
  return worst;
}

TEST(Lens, DerivativeOfBrownConradyIsThatOfItsProjection) { EXPECT_LT(worst_difference(brown_conrady(), 0.8), 1e-7); }

// 4 off the axis in x and y: 80 degrees
TEST(Lens, DerivativeOfAFisheyeIsThatOfItsProjection) { EXPECT_LT(worst_difference(fisheye(), 4.0), 1e-7); }

// Below 1e-6 the series' first term is used: continuous to what a double can say.
TEST(Lens, DerivativeOfAFisheyeIsContinuousOnItsAxis) {
  const Eigen::Matrix2d there = pixels_from_normalized(fisheye(), Vector2d::Zero());
  const Eigen::Matrix2d beside = pixels_from_normalized(fisheye(), Vector2d(2e-6, -1e-6));
  EXPECT_LT((there - beside).norm(), 1e-8);
  EXPECT_NEAR(there(0, 0), 250.0, 1e-12);
  EXPECT_NEAR(there(1, 1), 251.0, 1e-12);
}

}  // namespace
