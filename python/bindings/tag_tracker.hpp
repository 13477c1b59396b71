#pragma once

// vision.TagTracker and what its stages hand on.

#include <string>
#include <variant>

#include "arrays.hpp"
#include "pilotfish/vision/tag_tracker.hpp"
#include "repr.hpp"

namespace pilotfish::python {

namespace py = pybind11;

/// As Python sees an outcome: the value or the refusal.
template <class T>
std::variant<T, vision::TagRefusal> value_or_refusal(const vision::TagOutcome<T>& outcome) {
  if (outcome) return *outcome;
  return outcome.refusal;
}

/// What `work` returns, with Python's other threads running meanwhile: it must not touch Python.
template <class Work>
auto unlocked(const Work& work) {
  const py::gil_scoped_release released;
  return work();
}

inline std::size_t tag_with(const vision::TagTracker& tracker, int id) {
  const std::optional<std::size_t> tag = tracker.find(id);
  if (!tag) throw py::key_error("the body does not wear tag " + std::to_string(id));
  return *tag;
}

inline void bind_tag_tracker(py::module_& m) {
  using namespace vision;
  py::class_<TagPrediction>(m, "TagPrediction",
                            "Where a tag must be in a picture: what TagTracker.search() begins with.")
      .def_readonly("tag", &TagPrediction::tag, "place of the tag among the body's tags")
      .def_property_readonly(
          "nHt", [](const TagPrediction& prediction) { return to_array(prediction.nHt); },
          "(3, 3): tag coordinates, in which the square's corners are at +-1, to the undistorted plane Z = 1")
      .def_readonly("search_px", &TagPrediction::search_px, "how far from there it may be [px]");
  py::class_<UnevenLight>(m, "UnevenLight", "A shadow or a reflection on a tag; lengths are in half sides of it.")
      .def_property_readonly(
          "shape", [](const UnevenLight& light) { return light.shape == UnevenLight::Shape::edge ? "edge" : "spot"; },
          "\"edge\": place is (angle across it [rad], offset, width); \"spot\": (x, y, radius)")
      .def_readonly("black_step", &UnevenLight::black_step, "of black where it has its full share [gray levels]")
      .def_readonly("contrast_step", &UnevenLight::contrast_step, "of the contrast there [gray levels]")
      .def_readonly("place", &UnevenLight::place, "(3,), see shape")
      .def(
          "share_at",
          [](const UnevenLight& light, const std::array<double, 2>& tag) {
            return light.share_at({tag[0], tag[1]});
          },
          py::arg("tag"), "Its share, 0 to 1, at a place in tag coordinates (2,).")
      .def("mean_share", &UnevenLight::mean_share, "Its share over the tag.");
  py::class_<Registration>(m, "Registration", "A template laid over a picture so that it fits best; not read yet.")
      .def_property_readonly(
          "nHt", [](const Registration& fit) { return to_array(fit.nHt); },
          "(3, 3): tag coordinates, in which the square's corners are at +-1, to the undistorted plane Z = 1")
      .def_property_readonly(
          "corners_px", [](const Registration& fit) { return to_array(fit.corners_px); },
          "(4, 2) [px]: bottom left, bottom right, top right, top left, as one reads the tag; of a bent sheet where "
          "they\n"
          "were if it were flat, as its middle is")
      .def_property_readonly(
          "bend", [](const Registration& fit) { return to_array(fit.bend); },
          "(3,): curvatures xx, xy, yy of the sheet, in half sides of the tag over the radius; zero for a flat one")
      .def_property_readonly(
          "covariance_px2", [](const Registration& fit) { return to_array(fit.covariance_px2); },
          "(8, 8) of the corners (u0, v0, u1, v1, ...)")
      .def_readonly("appearance", &Registration::appearance, "Appearance: gray levels and blur")
      .def_readonly("light", &Registration::light,
                    "UnevenLight: a shadow or a reflection on the tag, or None; appearance has its mean levels")
      .def_readonly("cell_px", &Registration::cell_px, "shorter side of a cell [px]")
      .def_readonly("residual_rms", &Registration::residual_rms,
                    "RMS of what the template does not explain [gray levels]")
      .def_readonly("outlier_share", &Registration::outlier_share, "of the pixels used, those that it does not explain")
      .def_readonly("pixels", &Registration::pixels, "how many were used");
  py::class_<TagTracker>(m, "TagTracker",
                         "Measures the tags of one body in a picture, each where it must be: search, align, read.\n"
                         "track() does the three in a row; each can be called by itself. Remembers nothing.")
      .def(
          py::init<const CameraModel&, const LeaderBody&, const TagDetectorConfig&, const TagGates&>(), py::kw_only(),
          py::arg("camera"), py::arg("body"), py::arg_v("detector", TagDetectorConfig{}, "TagDetectorConfig()"),
          py::arg_v("gates", TagGates{}, "TagGates()"), py::call_guard<py::gil_scoped_release>(),
          "camera: of the pictures; body: the tags; of detector max_hamming and min_decision_margin count. ConfigError "
          "on a camera, family, id or gate that is none.")
      .def(
          "predict",
          [](const TagTracker& tracker, int id, const DoubleArray& cMo) {
            return tracker.predict(tag_with(tracker, id), to_pose(cMo));
          },
          "The TagPrediction of a tag if the body is at cMo (4, 4), or None if it is behind the camera or not turned\n"
          "towards it. KeyError on an id that the body does not wear.",
          py::arg("id"), py::kw_only(), py::arg("cMo"))
      .def(
          "predict_at",
          [](const TagTracker& tracker, int id, const DoubleArray& corners_px, double search_px) {
            return tracker.predict(tag_with(tracker, id), to_corners(corners_px), search_px);
          },
          "The TagPrediction of a tag whose corners, (4, 2) [px], are known about. KeyError on an id that the body "
          "does\n"
          "not wear.",
          py::arg("id"), py::kw_only(), py::arg("corners_px"), py::arg("search_px") = 0.0)
      .def(
          "search",
          [](const TagTracker& tracker, const py::array& image,
             const TagPrediction& prediction) -> std::variant<DoubleArray, TagRefusal> {
            const TagOutcome<Eigen::Matrix3d> found =
                unlocked([&, view = image_view(image)] { return tracker.search(view, prediction); });
            if (found) return to_array(*found);
            return found.refusal;
          },
          "The prediction's nHt (3, 3), shifted to where the template matches best, or the TagRefusal. image: (H, W)\n"
          "uint8.",
          py::arg("image"), py::arg("prediction"))
      .def(
          "align",
          [](const TagTracker& tracker, const py::array& image, int id, const DoubleArray& nHt,
             const Appearance& expected) {
            return value_or_refusal(
                unlocked([&, view = image_view(image), tag = tag_with(tracker, id),
                          from = to_matrix<3, 3>(nHt, "nHt")] { return tracker.align(view, tag, from, expected); }));
          },
          "The Registration: the template fitted from nHt (3, 3), which may be off by a third of a cell; or the\n"
          "TagRefusal. KeyError on an id that the body does not wear.",
          py::arg("image"), py::arg("id"), py::kw_only(), py::arg("nHt"),
          py::arg_v("expected", Appearance{}, "Appearance()"))
      .def(
          "read",
          [](const TagTracker& tracker, const py::array& image, int id, const Registration& registration) {
            return value_or_refusal(unlocked([&, view = image_view(image), tag = tag_with(tracker, id)] {
              return tracker.read(view, tag, registration);
            }));
          },
          "The TagMeasurement if the fitted tag is that one and passes the gates, else the TagRefusal. KeyError on an\n"
          "id that the body does not wear.",
          py::arg("image"), py::arg("id"), py::kw_only(), py::arg("registration"))
      .def(
          "track",
          [](const TagTracker& tracker, const py::array& image, const TagPrediction& prediction,
             const Appearance& expected) {
            return value_or_refusal(
                unlocked([&, view = image_view(image)] { return tracker.track(view, prediction, expected); }));
          },
          "search(), align() and read() in a row: a TagMeasurement, or the TagRefusal. image: (H, W) uint8.",
          py::arg("image"), py::arg("prediction"), py::kw_only(), py::arg_v("expected", Appearance{}, "Appearance()"));
  add_reprs(m, {"TagPrediction", "Registration"});
}

}  // namespace pilotfish::python
