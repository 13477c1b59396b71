#include "pilotfish/visp/conversions.hpp"

#include <cstring>

#include "pilotfish/core/parameter.hpp"

namespace pilotfish::visp {

Frame frame_of(const vpImage<unsigned char>& image, std::int64_t utime) {
  Frame frame;
  frame.utime = utime;
  frame.image = {image.bitmap, image.getSize(), static_cast<int>(image.getWidth()), static_cast<int>(image.getHeight()),
                 static_cast<int>(image.getWidth())};
  return frame;
}

vpImage<unsigned char> image_of(const Frame& frame) {
  if (check(frame.image) != Reason::none) return {};
  const ImageView& view = frame.image;
  vpImage<unsigned char> image(static_cast<unsigned int>(view.height), static_cast<unsigned int>(view.width));
  for (int v = 0; v < view.height; ++v)
    std::memcpy(image[v], view.data + static_cast<std::ptrdiff_t>(v) * view.stride_bytes,
                static_cast<std::size_t>(view.width));
  return image;
}

CameraModel camera_model_of(const vpCameraParameters& camera, int width, int height) {
  const auto kind = camera.get_projModel();
  if (kind != vpCameraParameters::perspectiveProjWithoutDistortion &&
      kind != vpCameraParameters::perspectiveProjWithDistortion)
    throw ConfigError("camera.distortion",
                      "is ViSP's Kannala-Brandt model; only its two perspective models are known here");
  CameraModel model;
  model.width = width;
  model.height = height;
  model.fx = camera.get_px();
  model.fy = camera.get_py();
  model.cx = camera.get_u0();
  model.cy = camera.get_v0();
  if (kind == vpCameraParameters::perspectiveProjWithDistortion) model.k1 = camera.get_kud();
  model.validate();
  return model;
}

vpCameraParameters camera_parameters_of(const CameraModel& camera) {
  if (camera.lens != Lens::brown_conrady)
    throw ConfigError("camera.distortion", "is a fisheye's; only ViSP's two perspective models are known here");
  if (camera.k2 != 0.0 || camera.k3 != 0.0 || camera.p1 != 0.0 || camera.p2 != 0.0)
    throw ConfigError("camera.distortion", "has more than k1, for which ViSP's model has no room");
  vpCameraParameters parameters;
  // k_du undoes k_ud to first order: x (1 + k r^2) (1 - k r^2) = x + O(r^4). ViSP's tag pose uses k_du.
  if (camera.k1 != 0.0)
    parameters.initPersProjWithDistortion(camera.fx, camera.fy, camera.cx, camera.cy, camera.k1, -camera.k1);
  else
    parameters.initPersProjWithoutDistortion(camera.fx, camera.fy, camera.cx, camera.cy);
  return parameters;
}

Eigen::Isometry3d isometry_of(const vpHomogeneousMatrix& motion) {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  for (unsigned int row = 0; row < 3; ++row)
    for (unsigned int column = 0; column < 4; ++column) result(row, column) = motion[row][column];
  return result;
}

vpHomogeneousMatrix homogeneous_of(const Eigen::Isometry3d& motion) {
  vpHomogeneousMatrix result;
  for (unsigned int row = 0; row < 3; ++row)
    for (unsigned int column = 0; column < 4; ++column) result[row][column] = motion(row, column);
  return result;
}

}  // namespace pilotfish::visp
