#include "rolling_shutter.hpp"

#include <array>

namespace pilotfish::vision {
namespace {

constexpr double kLongest_s = 0.2;  // what moved for longer did not move evenly
// Of a leader that was not seen just before, relative to the camera: robots turn, and hardly pitch.
constexpr double kUnknownAcross_radps = 0.5, kUnknownUp_radps = 0.1;

double middle_row(const TagMeasurements& tags) {
  double sum = 0.0;
  for (const TagMeasurement& tag : tags)
    for (const Eigen::Vector2d& corner : tag.tag.corners_px) sum += corner.y();
  return sum / (4.0 * static_cast<double>(tags.size()));
}

void move_back(const CameraModel& camera, const BodyTag& tag, const Before& before, const std::array<double, 4>& tau_s,
               TagMeasurement& measured) {
  const std::array<Eigen::Vector3d, 4> corners_o = corners_on_body(tag);
  std::array<double, 4> share{};
  std::array<Eigen::Vector2d, 4> moved_px;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::optional<Eigen::Vector2d> was_px = project(camera, before.cMo * corners_o[i]);
    const double period_s = before.since_s + tau_s[i];
    if (!was_px || period_s < 0.5 * before.since_s) return;
    share[i] = tau_s[i] / period_s;
    moved_px[i] = (1.0 - share[i]) * measured.tag.corners_px[i] + share[i] * *was_px;
  }
  measured.tag.corners_px = moved_px;  // all of them or none
  for (Eigen::Index i = 0; i < 8; ++i)
    for (Eigen::Index j = 0; j < 8; ++j) {
      const double a = share[static_cast<std::size_t>(i / 2)], b = share[static_cast<std::size_t>(j / 2)];
      measured.covariance_px2(i, j) *= (1.0 - a) * (1.0 - b) + a * b;
    }
}

/// One unknown velocity for all corners: rank one in each direction.
void widen(const CameraModel& camera, const std::array<double, 4>& tau_s, TagMeasurement& measured) {
  const double across_px = kUnknownAcross_radps * camera.fx, up_px = kUnknownUp_radps * camera.fy;  // per second
  for (Eigen::Index i = 0; i < 4; ++i)
    for (Eigen::Index j = 0; j < 4; ++j) {
      const double both_s2 = tau_s[static_cast<std::size_t>(i)] * tau_s[static_cast<std::size_t>(j)];
      measured.covariance_px2(2 * i, 2 * j) += both_s2 * across_px * across_px;
      measured.covariance_px2(2 * i + 1, 2 * j + 1) += both_s2 * up_px * up_px;
    }
}

}  // namespace

TagMeasurements at_one_instant(const CameraModel& camera, const LeaderBody& body, const TagMeasurements& tags,
                               const std::optional<Before>& before) noexcept {
  if (!(camera.readout_s > 0.0) || tags.empty()) return tags;
  TagMeasurements result = tags;
  const double middle_px = middle_row(tags);
  const bool known = before && before->since_s > 0.0 && before->since_s < kLongest_s;
  for (TagMeasurement& measured : result) {
    std::array<double, 4> tau_s{};
    for (std::size_t i = 0; i < 4; ++i)
      tau_s[i] = camera.readout_s * (measured.tag.corners_px[i].y() - middle_px) / camera.height;
    const BodyTag* tag = body.find(measured.tag.id);
    if (known && tag != nullptr)
      move_back(camera, *tag, *before, tau_s, measured);
    else
      widen(camera, tau_s, measured);
  }
  return result;
}

}  // namespace pilotfish::vision
