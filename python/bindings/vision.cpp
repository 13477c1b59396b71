#include <string_view>

#include "arrays.hpp"
#include "parameters.hpp"
#include "pilotfish/vision/leader_observer.hpp"
#include "pilotfish/vision/tag_family.hpp"

namespace py = pybind11;
using namespace pilotfish;
using namespace pilotfish::python;
using namespace pilotfish::vision;

PYBIND11_MODULE(vision, m) {
  m.doc() = "Tag detection and the leader's pose: Frame in, Observation out.";
  py::module_::import("pilotfish.core");

  py::class_<TagFamily>(m, "TagFamily", "One of libapriltag's families, for drawing its tags.")
      .def(py::init<const std::string&>(), py::arg("name"))
      .def_property_readonly("size", &TagFamily::size, "ids run from 0 to size - 1")
      .def_property_readonly("bits", &TagFamily::bits, "of one code")
      .def_property_readonly("cells_at_border", &TagFamily::cells_at_border,
                             "side, in cells, of the square whose corners are detected")
      .def(
          "bitmap",
          [](const TagFamily& family, int id) {
            const TagBitmap bitmap = family.bitmap(id);
            return to_array({bitmap.pixels.data(), bitmap.pixels.size(), bitmap.cells, bitmap.cells, bitmap.cells});
          },
          "(N, N) uint8, a cell each: 0 black, 255 white. IndexError on an id that the family does not have.",
          py::arg("id"));

  bind_parameters<TagDetectorConfig>(m, "TagDetectorConfig", "How tags are found and which are believed.");
  py::class_<Detections>(m, "Detections", "Tags found in one picture and what was turned away, by gate.")
      .def_readonly("input", &Detections::input, "why the picture was not even looked at; Reason.none if it was")
      .def_readonly("tags", &Detections::tags, "sorted by id, then by decision margin, best first")
      .def_readonly("refused_ids", &Detections::refused_ids)
      .def_readonly("refused_hamming", &Detections::refused_hamming)
      .def_readonly("refused_margin", &Detections::refused_margin);
  py::class_<TagDetector>(m, "TagDetector", "libapriltag behind a safe edge; one detector serves one thread.")
      .def(py::init<const std::string&, const TagDetectorConfig&>(), py::arg("family") = "tag36h11", py::kw_only(),
           py::arg("config") = TagDetectorConfig{})
      .def_property_readonly("family_size", &TagDetector::family_size)
      .def(
          "detect",
          [](TagDetector& detector, const py::array& image) {
            const ImageView view = image_view(image);
            py::gil_scoped_release unlocked;
            return detector.detect(view);
          },
          "image: (H, W) uint8", py::arg("image"))
      .def(
          "detect_unchecked",
          [](TagDetector& detector, const py::bytes& data, int width, int height, int stride_bytes) {
            const std::string_view bytes = data;
            const ImageView view{reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), width, height,
                                 stride_bytes};
            py::gil_scoped_release unlocked;
            return detector.detect(view);
          },
          "A picture whose claimed size need not fit its bytes, as it might come off a wire.", py::arg("data"),
          py::kw_only(), py::arg("width"), py::arg("height"), py::arg("stride_bytes"));

  bind_parameters<LeaderPoseConfig>(m, "LeaderPoseConfig", "Which poses are believed, and how exactly.");
  py::class_<LeaderPose>(m, "LeaderPose", "A pose cMo and how well it explains the corners.")
      .def_property_readonly(
          "cMo", [](const LeaderPose& pose) { return to_array(pose.cMo); }, "(4, 4)")
      .def_readonly("reprojection_error_px", &LeaderPose::reprojection_error_px)
      .def_readonly("ambiguity_ratio", &LeaderPose::ambiguity_ratio)
      .def_property_readonly(
          "covariance", [](const LeaderPose& pose) { return to_array(pose.covariance); },
          "(6, 6) of the twist (v, w) in the camera frame that acts on cMo from the left");
  m.def("estimate_leader_pose", &estimate_leader_pose,
        "One pose from all corners of all tags, or None if none converges in front of the camera.", py::kw_only(),
        py::arg("camera"), py::arg("body"), py::arg("tags"), py::arg("config") = LeaderPoseConfig{},
        py::call_guard<py::gil_scoped_release>());
  m.def("is_credible", &is_credible, "Whether a pose passes the gates of its config.", py::kw_only(), py::arg("pose"),
        py::arg("body"), py::arg("tags"), py::arg("config") = LeaderPoseConfig{});

  py::class_<LeaderObserverConfig>(m, "LeaderObserverConfig")
      .def(py::init([](const TagDetectorConfig& detector, const LeaderPoseConfig& pose) {
             return LeaderObserverConfig{detector, pose};
           }),
           py::kw_only(), py::arg("detector") = TagDetectorConfig{}, py::arg("pose") = LeaderPoseConfig{})
      .def_readwrite("detector", &LeaderObserverConfig::detector)
      .def_readwrite("pose", &LeaderObserverConfig::pose);
  py::class_<RejectionCounters>(m, "RejectionCounters", "Everything that was turned away since the start.")
      .def_readonly("frames_invalid", &RejectionCounters::frames_invalid)
      .def_readonly("hamming", &RejectionCounters::hamming)
      .def_readonly("margin", &RejectionCounters::margin)
      .def_readonly("foreign_id", &RejectionCounters::foreign_id)
      .def_readonly("duplicate_id", &RejectionCounters::duplicate_id)
      .def_readonly("pose", &RejectionCounters::pose);
  py::class_<Sight>(m, "Sight", "What one picture says about the leader: an observation, or the reason why none.")
      .def_readonly("observation", &Sight::observation)
      .def_readonly("reason", &Sight::reason);
  py::class_<LeaderObserver>(m, "LeaderObserver", "Frame in, Observation out.")
      .def(py::init<const CameraModel&, const CameraMounting&, const LeaderBody&, const LeaderObserverConfig&>(),
           py::kw_only(), py::arg("camera"), py::arg("mounting") = CameraMounting{}, py::arg("body"),
           py::arg_v("config", LeaderObserverConfig{}, "LeaderObserverConfig()"))
      .def("observe", &LeaderObserver::observe, py::arg("frame"), py::call_guard<py::gil_scoped_release>())
      .def_property_readonly(
          "rejected", [](const LeaderObserver& observer) { return observer.rejected(); }, "a copy of the counters");
}
