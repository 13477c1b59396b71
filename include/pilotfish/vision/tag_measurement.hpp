#pragma once

#include <optional>

#include "pilotfish/api.hpp"
#include "pilotfish/core/leader_body.hpp"
#include "pilotfish/core/observation.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/vision/rejection_counters.hpp"
#include "pilotfish/vision/tag_registration.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::vision {

/// Which tags are accepted once they have been found. Defaults: docs/vision.md shows the data they come from.
struct TagGates {
  double min_cell_px = 0.9;               ///< shorter side of a cell
  double max_blur_cells = 0.8;            ///< standard deviation of the blur, in cells
  double max_normalised_residual = 0.12;  ///< RMS of what the template does not explain, as a part of its contrast
  static const std::vector<Parameter<TagGates>>& parameters();
};

/// One tag, verified and measured in this very frame.
struct TagMeasurement {
  TagDetection tag;                            ///< id, bits and the fitted corners [px]
  Matrix8d covariance_px2 = Matrix8d::Zero();  ///< of the corners (u0, v0, u1, v1, ...)
  Appearance appearance;                       ///< Appearance of its template: gray levels and blur
};
using TagMeasurements = BoundedVector<TagMeasurement, kMaxTagsOnBody>;

/// What a stage of the tracker has to say of a tag: a value, or why there is none.
template <class T>
struct TagOutcome {
  std::optional<T> value;                      ///< nothing if it was refused
  TagRefusal refusal = TagRefusal::not_found;  ///< why

  TagOutcome(const T& found) : value(found) {}
  TagOutcome(TagRefusal why) : refusal(why) {}
  explicit operator bool() const { return value.has_value(); }  ///< there is one
  const T& operator*() const { return *value; }                 ///< only if there is one
  const T* operator->() const { return &*value; }               ///< only if there is one
};

}  // namespace pilotfish::vision
PILOTFISH_API_END
