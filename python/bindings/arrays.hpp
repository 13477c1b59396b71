#pragma once

// NumPy arrays at the boundary: images (H, W) uint8, poses (4, 4) float64. Wrong shapes are a ValueError that says what
// was expected and what came.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>

#include "pilotfish/core/frame.hpp"

namespace pilotfish::python {

namespace py = pybind11;

using ImageArray = py::array_t<std::uint8_t, py::array::c_style>;
using DoubleArray = py::array_t<double, py::array::c_style | py::array::forcecast>;

inline std::string shape_text(const py::array& array) {
  return py::str(array.attr("shape")).cast<std::string>() + " " + py::str(array.dtype()).cast<std::string>();
}

/// A gray image (H, W) uint8, C-contiguous; the view is valid while the array lives.
inline ImageView image_view(const py::array& array) {
  if (array.ndim() != 2 || !py::isinstance<ImageArray>(array))
    throw py::value_error("expected a C-contiguous gray image of shape (H, W) and dtype uint8, got " +
                          shape_text(array));
  const auto height = static_cast<int>(array.shape(0)), width = static_cast<int>(array.shape(1));
  return {static_cast<const std::uint8_t*>(array.data()), static_cast<std::size_t>(array.nbytes()), width, height,
          width};
}

inline ImageArray to_array(const ImageView& image) {
  ImageArray array({image.height, image.width});
  for (int v = 0; v < image.height; ++v)
    std::copy_n(image.data + static_cast<std::size_t>(v) * image.stride_bytes, image.width, array.mutable_data(v, 0));
  return array;
}

inline DoubleArray to_array(const Eigen::Isometry3d& pose) {
  DoubleArray array({4, 4});
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) array.mutable_at(row, column) = pose.matrix()(row, column);
  return array;
}

/// A homogeneous matrix (4, 4) whose rotation is orthonormal to 1e-6.
inline Eigen::Isometry3d to_pose(const DoubleArray& array) {
  if (array.ndim() != 2 || array.shape(0) != 4 || array.shape(1) != 4)
    throw py::value_error("expected a homogeneous matrix of shape (4, 4), got " + shape_text(array));
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) pose.matrix()(row, column) = array.at(row, column);
  const Eigen::Matrix3d defect = pose.linear() * pose.linear().transpose() - Eigen::Matrix3d::Identity();
  if (!(defect.cwiseAbs().maxCoeff() < 1e-6) || !(pose.linear().determinant() > 0.0))
    throw py::value_error("the upper left 3x3 block of the pose is not a rotation");
  return pose;
}

template <int Rows, int Columns>
DoubleArray to_array(const Eigen::Matrix<double, Rows, Columns>& matrix) {
  DoubleArray array({Rows, Columns});
  for (int row = 0; row < Rows; ++row)
    for (int column = 0; column < Columns; ++column) array.mutable_at(row, column) = matrix(row, column);
  return array;
}

template <int Rows, int Columns>
Eigen::Matrix<double, Rows, Columns> to_matrix(const DoubleArray& array, const std::string& name) {
  if (array.ndim() != 2 || array.shape(0) != Rows || array.shape(1) != Columns)
    throw py::value_error("expected " + name + " of shape (" + std::to_string(Rows) + ", " + std::to_string(Columns) +
                          "), got " + shape_text(array));
  Eigen::Matrix<double, Rows, Columns> matrix;
  for (int row = 0; row < Rows; ++row)
    for (int column = 0; column < Columns; ++column) matrix(row, column) = array.at(row, column);
  return matrix;
}

/// Corners (4, 2) in pixels.
inline DoubleArray to_array(const std::array<Eigen::Vector2d, 4>& corners) {
  DoubleArray array({4, 2});
  for (int i = 0; i < 4; ++i) {
    array.mutable_at(i, 0) = corners[i].x();
    array.mutable_at(i, 1) = corners[i].y();
  }
  return array;
}

inline std::array<Eigen::Vector2d, 4> to_corners(const DoubleArray& array) {
  if (array.ndim() != 2 || array.shape(0) != 4 || array.shape(1) != 2)
    throw py::value_error("expected corners of shape (4, 2), got " + shape_text(array));
  std::array<Eigen::Vector2d, 4> corners;
  for (int i = 0; i < 4; ++i) corners[i] = {array.at(i, 0), array.at(i, 1)};
  return corners;
}

}  // namespace pilotfish::python
