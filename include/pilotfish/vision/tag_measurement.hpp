#pragma once

#include <optional>

#include "pilotfish/api.hpp"
#include "pilotfish/core/leader_body.hpp"
#include "pilotfish/core/observation.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/refused_value.hpp"
#include "pilotfish/vision/rejection_counters.hpp"
#include "pilotfish/vision/tag_registration.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::vision {

/// Which tags are accepted once they have been found. Defaults: docs/vision.md shows the data they come from.
struct TagGates {
  PILOTFISH_PARAMETERS(TagGates);
  PILOTFISH_PARAMETER(double, min_cell_px, 0.9, 0.5, 50.0, "shorter side of a tag's cell below which it is refused");
  PILOTFISH_PARAMETER(double, max_blur_cells, 0.8, 0.1, 2.0,
                      "standard deviation of the blur, in cells of the tag, above which it is refused");
  PILOTFISH_PARAMETER(
      double, max_normalised_residual, 0.12, 0.01, 1.0,
      "RMS difference of picture and template, as a part of the contrast, above which a tag is refused");
};

/// One tag, verified and measured in this very frame.
struct TagMeasurement {
  TagDetection tag;                            ///< id, bits and the fitted corners [px]
  Matrix8d covariance_px2 = Matrix8d::Zero();  ///< of the corners (u0, v0, u1, v1, ...)
  Appearance appearance;                       ///< Appearance of its template: gray levels and blur
};
using TagMeasurements = BoundedVector<TagMeasurement, kMaxTagsOnBody>;

/// The result of a stage of the tracker for a tag: a value, or why there is none.
template <class T>
struct TagOutcome {
  std::optional<T> value;                      ///< nothing if it was refused
  TagRefusal refusal = TagRefusal::not_found;  ///< why
  RefusedValue refused;                        ///< what the gate compared, if it compared numbers

  TagOutcome(const T& found) : value(found) {}                                                        ///< a value
  TagOutcome(TagRefusal why, const RefusedValue& compared = {}) : refusal(why), refused(compared) {}  ///< none
  explicit operator bool() const { return value.has_value(); }                                        ///< there is one
  const T& operator*() const { return *value; }    ///< only if there is one
  const T* operator->() const { return &*value; }  ///< only if there is one
};

}  // namespace pilotfish::vision
PILOTFISH_API_END
