#include <chrono>
#include <string>
#include <string_view>

#include "arrays.hpp"
#include "exclusive.hpp"
#include "parameters.hpp"
#include "pilotfish/vision/leader_observer.hpp"
#include "pilotfish/vision/nearest_visible.hpp"
#include "pilotfish/vision/tag_family.hpp"
#include "tag_tracker.hpp"

namespace py = pybind11;
using namespace pilotfish;
using namespace pilotfish::python;
using namespace pilotfish::vision;

namespace {

TagMeasurements as_measurements(const std::vector<TagDetection>& tags) {
  if (tags.size() > kMaxTagsOnBody) throw py::value_error("a leader wears at most 12 tags");
  TagMeasurements measurements;
  for (const TagDetection& tag : tags) measurements.push_back({tag, Matrix8d::Zero(), {}});
  return measurements;
}

std::int64_t steady_now_ns() noexcept {
  return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

py::dict stage_times_us(const StageStopwatch& stages) {
  py::dict times;
  for (std::size_t i = 0; i < kStages; ++i) {
    const auto stage = static_cast<Stage>(i);
    times[py::str(std::string(to_string(stage)))] = static_cast<double>(stages.ns(stage)) / 1e3;
  }
  return times;
}

}  // namespace

PYBIND11_MODULE(vision, m) {
  m.doc() = "Tag detection and the leader's pose: Frame in, Observation out.";
  py::module_::import("pilotfish.core");

  py::class_<TagFamily>(m, "TagFamily", "One of libapriltag's families, for drawing its tags.")
      .def(py::init<const std::string&>(), py::arg("name"), py::call_guard<py::gil_scoped_release>(),
           "name: tag36h11, tag36h10, tag25h9, tag16h5, tagStandard41h12, tagStandard52h13, tagCircle21h7, "
           "tagCircle49h12 or tagCustom48h12. ConfigError (leader.family) on any other.")
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

  bind_parameters<TagDetectorConfig>(m, "TagDetectorConfig", "How tags are found and which are accepted.");
  py::class_<Detections>(m, "Detections", "Tags found in one picture and what was turned away, by gate.")
      .def_readonly("input", &Detections::input, "why the picture was not even looked at; Reason.none if it was")
      .def_readonly("tags", &Detections::tags, "sorted by id, then by decision margin, best first")
      .def_readonly("unsure", &Detections::unsure,
                    "turned away for wrong bits alone; LeaderObserver takes a closer look at them")
      .def_readonly("refused_ids", &Detections::refused_ids,
                    "list[int], sorted: ids of the tags that a gate turned away")
      .def_readonly("refused_hamming", &Detections::refused_hamming,
                    "number of tags with more corrected bits than max_hamming")
      .def_readonly("refused_margin", &Detections::refused_margin,
                    "number of tags with a decision margin below min_decision_margin");
  py::class_<TagDetector>(m, "TagDetector", "libapriltag behind a safe edge; one detector serves one thread.")
      .def(py::init<const std::string&, const TagDetectorConfig&>(), py::arg("family") = "tag36h11", py::kw_only(),
           py::arg("config") = TagDetectorConfig{}, py::call_guard<py::gil_scoped_release>(),
           "family: a name that TagFamily knows. ConfigError on an unknown one or a parameter out of range.")
      .def_property_readonly("family_size", &TagDetector::family_size, "ids run from 0 to family_size - 1")
      .def("detect", exclusive([](TagDetector& detector, const py::array& image) {
             const ImageView view = image_view(image);
             py::gil_scoped_release unlocked;
             return detector.detect(view);
           }),
           "image: (H, W) uint8", py::arg("image"));

  bind_parameters<TagGates>(m, "TagGates", "Which tags are accepted once they have been found.");
  py::class_<Appearance>(m, "Appearance", "How a template looks in a picture.")
      .def(py::init<>(), "What is expected of a picture of which nothing is known.")
      .def_readonly("black", &Appearance::black, "gray level in the middle of the tag")
      .def_readonly("white", &Appearance::white, "gray level in the middle of the tag")
      .def_readonly("blur_u_px2", &Appearance::blur_u_px2, "variance of the blur along rows, with the pixel's own 1/12")
      .def_readonly("blur_v_px2", &Appearance::blur_v_px2, "the same along columns");
  py::class_<TagMeasurement>(m, "TagMeasurement", "One tag, verified and measured in one picture.")
      .def_readonly("tag", &TagMeasurement::tag, "TagDetection: id, bits and the fitted corners [px]")
      .def_property_readonly(
          "covariance_px2", [](const TagMeasurement& measurement) { return to_array(measurement.covariance_px2); },
          "(8, 8) of the corners (u0, v0, u1, v1, ...)")
      .def_readonly("appearance", &TagMeasurement::appearance, "Appearance of its template: gray levels and blur");
  py::enum_<TagRefusal> refusal(m, "TagRefusal", "Why a tag that was looked at is no measurement.");
  for (const TagRefusalDescription& each : kTagRefusals) refusal.value(each.name, each.refusal, each.text);
  bind_tag_tracker(m);

  bind_parameters<LeaderPoseConfig>(m, "LeaderPoseConfig", "Which poses are accepted, and how exactly.");
  py::class_<LeaderPose>(m, "LeaderPose", "A pose cMo and how well it explains the corners.")
      .def_property_readonly(
          "cMo", [](const LeaderPose& pose) { return to_array(pose.best.cMo); }, "(4, 4)")
      .def_property_readonly(
          "other_cMo",
          [](const LeaderPose& pose) -> std::optional<py::array_t<double>> {
            if (!pose.other) return std::nullopt;
            return to_array(pose.other->cMo);
          },
          "(4, 4) of the second planar solution, or None")
      .def_property_readonly(
          "squared_error", [](const LeaderPose& pose) { return pose.best.squared_error; },
          "of the corners, in units of their covariance: chi-squared")
      .def_property_readonly(
          "reprojection_error_px", [](const LeaderPose& pose) { return pose.best.reprojection_error_px; },
          "RMS over all corners [px], in the picture as it is (distorted)")
      .def_readonly("ambiguity_ratio", &LeaderPose::ambiguity_ratio,
                    "error of the worse planar solution over the better one's, in standard deviations of the corners, "
                    "at least 1; near 1 the heading is ambiguous in one picture, 1e6 without a second solution")
      .def_property_readonly(
          "covariance", [](const LeaderPose& pose) { return to_array(pose.best.covariance); },
          "(6, 6) of the twist (v, w) in the camera frame that acts on cMo from the left");
  m.attr("MIN_BITS_INSIDE") = TagTracker::kMinBitsInside;
  m.attr("MIN_CELLS_INSIDE") = TagTracker::kMinCellsInside;
  m.def(
      "nearest_visible_distance_m",
      [](const CameraModel& camera, const CameraMounting& mounting, const LeaderBody& body) {
        return nearest_visible_distance_m(TagTracker(camera, body), mounting);
      },
      py::arg("camera"), py::arg("mounting"), py::arg("body"),
      "The nearest distance [m] between the turning centres at which a leader can be followed at all, to 5 mm: one of "
      "its tags, straight ahead of the camera and looking at it, has MIN_BITS_INSIDE of its bits and MIN_CELLS_INSIDE "
      "of its cells in the picture. inf if no tag is visible with 5 m or less in between.");
  m.def(
      "estimate_leader_pose",
      [](const CameraModel& camera, const LeaderBody& body, const std::vector<TagDetection>& tags,
         const LeaderPoseConfig& config) {
        const TagMeasurements measurements = as_measurements(tags);
        py::gil_scoped_release unlocked;
        return estimate_leader_pose(camera, body, measurements, config);
      },
      "One pose from all corners of all tags, each with a standard deviation of corner_sigma_px, or None if none\n"
      "converges in front of the camera.",
      py::kw_only(), py::arg("camera"), py::arg("body"), py::arg("tags"), py::arg("config") = LeaderPoseConfig{});
  m.def(
      "check_pose",
      [](const LeaderPose& pose, const LeaderBody& body, const std::vector<TagDetection>& tags,
         const LeaderPoseConfig& config) { return check_pose(pose.best, body, as_measurements(tags), config).reason; },
      "Reason.none if a pose passes the gates of its config, else what is wrong with it.", py::kw_only(),
      py::arg("pose"), py::arg("body"), py::arg("tags"), py::arg("config") = LeaderPoseConfig{});

  py::class_<LeaderObserverConfig> observer_config(m, "LeaderObserverConfig",
                                                   "How a leader is looked for and followed.");
  bind_attributes(m, observer_config);  // acquisition_range_m, heading, track
  observer_config
      .def(py::init([](double acquisition_range_m, const TagDetectorConfig& detector, const TagGates& gates,
                       const LeaderPoseConfig& pose, const HeadingFilterConfig& heading,
                       const LeaderTrackConfig& track) {
             return LeaderObserverConfig{acquisition_range_m, detector, gates, pose, heading, track};
           }),
           py::kw_only(), py::arg("acquisition_range_m") = LeaderObserverConfig{}.acquisition_range_m,
           py::arg("detector") = TagDetectorConfig{}, py::arg("gates") = TagGates{},
           py::arg("pose") = LeaderPoseConfig{}, py::arg("heading") = HeadingFilterConfig{},
           py::arg("track") = LeaderTrackConfig{},
           "Parts default to their own defaults. ConfigError names the key of a number out of range.")
      .def_readwrite("detector", &LeaderObserverConfig::detector, "TagDetectorConfig: how tags are found")
      .def_readwrite("gates", &LeaderObserverConfig::gates, "TagGates: which of them are accepted")
      .def_readwrite("pose", &LeaderObserverConfig::pose, "LeaderPoseConfig: which poses are accepted");
  py::class_<RejectionCounters> counters(m, "RejectionCounters", "Everything that was turned away since the start.");
  for (const RejectionCounters::Named& each : RejectionCounters::all())
    counters.def_readonly(each.member, each.count, each.text);
  py::class_<ObservationResult>(m, "ObservationResult",
                                "What one picture says about the leader: an observation, or the reason why none.")
      .def_readonly("observation", &ObservationResult::observation, "Observation of this frame, or None")
      .def_readonly("reason", &ObservationResult::reason, "Reason.none with an observation, else why there is none")
      .def_property_readonly(
          "detail", [](const ObservationResult& result) { return to_text(result.refused); },
          "what a gate compared, e.g. \"reprojection error 7.1 px, at most 3 px\"; empty where it compared no numbers");
  py::class_<LeaderObserver>(m, "LeaderObserver",
                             "Frame in, Observation out. It follows the leader from frame to frame.")
      .def(py::init<const CameraModel&, const CameraMounting&, const LeaderBody&, const LeaderObserverConfig&>(),
           py::kw_only(), py::arg("camera"), py::arg("mounting") = CameraMounting{}, py::arg("body"),
           py::arg_v("config", LeaderObserverConfig{}, "LeaderObserverConfig()"),
           py::call_guard<py::gil_scoped_release>(),
           "camera: of the frames; mounting: camera on the coordinator's base; body: the leader's tags. ConfigError if "
           "any part is not usable.")
      .def("observe", exclusive_unlocked(&LeaderObserver::observe), py::arg("frame"),
           "The ObservationResult of a Frame. A frame that cannot be used, or whose size differs from the "
           "calibration's, gives the reason. Times come from frame.utime [us].")
      .def("forget", exclusive(&LeaderObserver::forget),
           "The next frame is looked at as if nothing had been seen before.")
      .def_property("timed", exclusive([](const LeaderObserver& observer) { return observer.stages().runs(); }),
                    exclusive([](LeaderObserver& observer, bool timed) {
                      observer.time_stages(timed ? steady_now_ns : nullptr);
                    }),
                    "whether the stages of the next frames are timed, on this host's steady clock; False by default")
      .def_property_readonly(
          "stage_times_us", exclusive([](const LeaderObserver& observer) { return stage_times_us(observer.stages()); }),
          "{stage: [us]} of the last frame that could be used, all tags together: predict, detect, search, align, "
          "read, pose, heading. All zero unless timed.")
      .def_property_readonly("rejected", exclusive([](const LeaderObserver& observer) { return observer.rejected(); }),
                             "a copy of the counters");

  make_value(m, "LeaderObserverConfig");
  make_results<Detections, Appearance, TagMeasurement, RejectionCounters, ObservationResult, LeaderPose>();
  add_reprs(m, {"Detections", "Appearance", "TagMeasurement", "LeaderObserverConfig", "RejectionCounters",
                "ObservationResult"});
  add_repr(m, "TagFamily", {"size", "bits"});
  add_repr(m, "LeaderPose", {"cMo", "squared_error", "reprojection_error_px", "ambiguity_ratio"});
}
