#include <pybind11/eigen.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "arrays.hpp"
#include "parameters.hpp"
#include "pilotfish/core/angles.hpp"
#include "pilotfish/core/camera_model.hpp"
#include "pilotfish/core/leader_body.hpp"
#include "pilotfish/core/monotonic.hpp"
#include "pilotfish/core/observation.hpp"
#include "pilotfish/core/read_file.hpp"
#include "pilotfish/core/session_guard.hpp"
#include "pilotfish/core/setpoint.hpp"
#include "pilotfish/core/status.hpp"
#include "pilotfish/core/twist.hpp"
#include "range_scan.hpp"

namespace py = pybind11;
using namespace pilotfish;
using namespace pilotfish::python;

namespace {

/// Our ConfigError becomes pilotfish.errors.ConfigError, a ValueError that has the key: in every module, whichever of
/// them is asked.
void translate_config_errors() {
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const ConfigError& error) {
      const py::object type = py::module_::import("pilotfish.errors").attr("ConfigError");
      py::object raised = type(error.what());
      raised.attr("key") = error.key();
      PyErr_SetObject(type.ptr(), raised.ptr());
    }
  });
}

void bind_session_guard(py::module_& m) {
  py::enum_<SequenceVerdict>(m, "SequenceVerdict", "What a SequenceGuard says of a message.")
      .value("accepted", SequenceVerdict::accepted)
      .value("wrong_session", SequenceVerdict::wrong_session)
      .value("not_rising", SequenceVerdict::not_rising);
  py::class_<SequenceGuard>(m, "SequenceGuard", "Within one session, counters only rise; session 0 is never accepted.")
      .def(py::init<std::int64_t>(), py::arg("session") = 0, "session: whose messages are accepted; 0: none")
      .def("accept", &SequenceGuard::accept, py::arg("session"), py::arg("counter"),
           "SequenceVerdict of a message. Accepted only with this session and a counter above last_counter; a refused "
           "message changes nothing.")
      .def("check", &SequenceGuard::check, py::arg("session"), py::arg("counter"), "What accept() would say.")
      .def_property_readonly("session", &SequenceGuard::session, "the session whose messages are accepted; 0: none")
      .def_property_readonly("last_counter", &SequenceGuard::last_counter,
                             "counter of the last message accepted; 0: none yet");

  py::enum_<SetpointVerdict> verdict(m, "SetpointVerdict", "What a SetpointGate says of a message.");
  for (SetpointVerdict value : {SetpointVerdict::accepted, SetpointVerdict::stopped, SetpointVerdict::wrong_session,
                                SetpointVerdict::replayed, SetpointVerdict::too_near, SetpointVerdict::out_of_bounds})
    verdict.value(std::string(to_string(value)).substr(std::string_view("setpoint_").size()).c_str(), value);
  verdict.def_property_readonly(
      "counted_as", [](SetpointVerdict v) { return std::string(to_string(v)); },
      "name under which the refusal is counted, e.g. setpoint_replayed");
  py::class_<SetpointDecision>(m, "SetpointDecision", "What a SetpointGate makes of a message.")
      .def_readonly("verdict", &SetpointDecision::verdict, "SetpointVerdict: what the gate says of the message")
      .def_readonly("setpoint", &SetpointDecision::setpoint, "to be kept from now on");
  py::class_<SetpointGate>(
      m, "SetpointGate",
      "A stop is accepted from anyone and latched; everything else needs the session, a counter that "
      "rises, and a distance that is not too small.")
      .def(py::init<std::int64_t, double>(), py::kw_only(), py::arg("session"), py::arg("stop_distance_m"),
           "session: the coordinator's own; stop_distance_m: no smaller distance is accepted [m]")
      .def("decide", &SetpointGate::decide, py::kw_only(), py::arg("session"), py::arg("counter"), py::arg("asked"),
           py::arg("kept"),
           "SetpointDecision about a message that asks for `asked` while `kept` is kept. A stop counts whatever its "
           "numbers.")
      .def_property_readonly("session", &SetpointGate::session, "the coordinator's session, which setpoints must name")
      .def_property_readonly("last_counter", &SetpointGate::last_counter,
                             "counter of the last setpoint accepted; 0: none yet");
}

}  // namespace

PYBIND11_MODULE(core, m) {
  translate_config_errors();
  m.doc() = "Types shared by all modules: Frame, CameraModel, LeaderBody, Observation, Twist, Status.";

  m.def("wrap_angle", &wrap_angle, py::arg("angle_rad"), "The same angle in (-pi, pi].");
  m.def(
      "monotonic_now_us", [] { return monotonic_now().us; },
      "Now, on the clock of every age and validity (CLOCK_BOOTTIME) [us]: a command sent now for 50 ms has "
      "valid_until_us = monotonic_now_us() + 50_000 on the base's own computer.");

  py::class_<Twist>(m, "Twist", "Unicycle velocity in the base frame: linear_mps forward, angular_radps to the left.")
      .def(py::init([](double linear_mps, double angular_radps) {
             return Twist{linear_mps, angular_radps};
           }),
           py::kw_only(), py::arg("linear_mps") = 0.0, py::arg("angular_radps") = 0.0,
           "linear_mps: forward speed [m/s]; angular_radps: turn rate [rad/s], positive to the left. Not checked here.")
      .def_readwrite("linear_mps", &Twist::linear_mps, "forward speed [m/s], in the robot's base frame")
      .def_readwrite("angular_radps", &Twist::angular_radps, "turn rate [rad/s], positive: to the left")
      .def(
          "__eq__", [](const Twist& a, const Twist& b) { return a == b; }, py::is_operator());

  bind_parameters<Setpoint>(m, "Setpoint",
                            "What to keep: distance_m (d_p), bearing_rad (theta_pd); run=False stands still.")
      .def_static(
          "unchecked",
          [](double distance_m, double bearing_rad, bool run) {
            return Setpoint{distance_m, bearing_rad, run};
          },
          py::kw_only(), py::arg("distance_m") = 1.0, py::arg("bearing_rad") = 0.0, py::arg("run") = true,
          "A setpoint whose numbers need not be in range, as it might come off a wire; a coordinator must refuse it.");
  m.attr("MAX_BEARING_RAD") = kMaxBearing_rad;  // of a setpoint, to either side
  bind_session_guard(m);

  py::enum_<Status> status(
      m, "Status",
      "What the coordinator is doing; only tracking and coasting may move the robot, and lost may turn it in place.");
  for (Status value :
       {Status::searching, Status::tracking, Status::coasting, Status::lost, Status::stopped, Status::invalid_input})
    status.value(std::string(to_string(value)).c_str(), value);

  py::enum_<Reason> reason(m, "Reason", "Why; str(reason) is the enumerator, reason.text a sentence.");
  for (const ReasonDescription& each : kReasons) reason.value(each.name.data(), each.reason, each.text.data());
  reason.def_property_readonly(
      "text", [](Reason value) { return std::string(to_string(value)); }, "the reason as a sentence for people");

  py::class_<Frame>(m, "Frame", "One gray picture and the instant of its exposure.")
      .def(py::init([](const py::array& image, std::int64_t utime) {
             const ImageView view = image_view(image);
             const py::gil_scoped_release unlocked;
             return Frame::from_pixels(utime, view.width, view.height, {view.data, view.data + view.size_bytes});
           }),
           "image: (H, W) uint8, copied; utime: exposure time in microseconds", py::arg("image"), py::kw_only(),
           py::arg("utime"))
      .def_static(
          "unchecked",
          [](const py::bytes& data, int width, int height, int stride_bytes, std::int64_t utime) {
            const std::string_view bytes = data;
            Frame frame = Frame::from_pixels(utime, width, height, {bytes.begin(), bytes.end()});
            frame.image.stride_bytes = stride_bytes;
            return frame;
          },
          "A frame whose claimed size need not fit its bytes, as it might come off a wire; step() must refuse it.",
          py::arg("data"), py::kw_only(), py::arg("width"), py::arg("height"), py::arg("stride_bytes"),
          py::arg("utime"))
      .def_readonly("utime", &Frame::utime, "exposure time [us], on the clock of whoever took the picture")
      .def_readwrite("known_age_us", &Frame::known_age_us,
                     "What is known to have passed between exposure and arrival; can only make a frame older.")
      .def_readwrite("coarse_search", &Frame::coarse_search,
                     "Where the whole picture has to be searched, it is searched at half the resolution.")
      .def_property_readonly(
          "width", [](const Frame& frame) { return frame.image.width; }, "claimed width [px]")
      .def_property_readonly(
          "height", [](const Frame& frame) { return frame.image.height; }, "claimed height [px]")
      .def_property_readonly(
          "image",
          [](const Frame& frame) {
            if (check(frame.image) != Reason::none) throw py::value_error("the frame's pixels cannot be read safely");
            return to_array(frame.image);
          },
          "(H, W) uint8, a copy")
      .def_property_readonly(
          "defect", [](const Frame& frame) { return check(frame.image); },
          "Reason.none if the pixels can be read safely")
      .def(
          "__eq__",
          [](const Frame& a, const Frame& b) {
            if (&a == &b) return true;
            if (a.utime != b.utime || a.known_age_us != b.known_age_us || a.coarse_search != b.coarse_search)
              return false;
            return check(a.image) == Reason::none && check(b.image) == Reason::none &&
                   are_equal(to_array(a.image), to_array(b.image));
          },
          py::is_operator(), "Of one time, with the same pixels.");

  py::enum_<Lens>(m, "Lens", "How a lens bends directions.")
      .value("brown_conrady", Lens::brown_conrady)
      .value("kannala_brandt", Lens::kannala_brandt);
  py::class_<CameraModel>(
      m, "CameraModel",
      "A camera with a Brown-Conrady lens (OpenCV's calibrateCamera: k1, k2, p1, p2, k3) or a Kannala-Brandt one "
      "(OpenCV's fisheye module: k1, k2, k3, k4); (0, 0) is the top-left pixel's centre.")
      .def(py::init([](int width, int height, double fx, double fy, double cx, double cy, double k1, double k2,
                       double p1, double p2, double k3, double k4, Lens lens, double readout_s) {
             CameraModel camera{width, height, fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, lens, readout_s};
             camera.validate();
             return camera;
           }),
           py::kw_only(), py::arg("width"), py::arg("height"), py::arg("fx"), py::arg("fy"), py::arg("cx"),
           py::arg("cy"), py::arg("k1") = 0.0, py::arg("k2") = 0.0, py::arg("p1") = 0.0, py::arg("p2") = 0.0,
           py::arg("k3") = 0.0, py::arg("k4") = 0.0,
           py::arg_v("lens", Lens::brown_conrady, "pilotfish.core.Lens.brown_conrady"), py::arg("readout_s") = 0.0,
           "width, height, fx, fy, cx, cy in pixels. ConfigError (camera.fx: ...) on sizes or intrinsics that no "
           "camera has.")
      .def_readonly("width", &CameraModel::width, "[px], of the images that were calibrated")
      .def_readonly("height", &CameraModel::height, "[px], of the images that were calibrated")
      .def_readonly("fx", &CameraModel::fx, "focal length along rows [px]")
      .def_readonly("fy", &CameraModel::fy, "focal length along columns [px]")
      .def_readonly("cx", &CameraModel::cx, "principal point, from the centre of the leftmost pixels [px]")
      .def_readonly("cy", &CameraModel::cy, "principal point, from the centre of the topmost pixels [px]")
      .def_readonly("readout_s", &CameraModel::readout_s,
                    "from the exposure of the first row to that of the last [s]: rolling shutter; 0: all at once")
      .def_readonly("lens", &CameraModel::lens, "Lens: which of the two models")
      .def_readonly("k1", &CameraModel::k1, "radial distortion of r^2, ViSP's kud; of a fisheye, of the angle squared")
      .def_readonly("k2", &CameraModel::k2, "radial distortion of r^4; of a fisheye, of the angle^4")
      .def_readonly("p1", &CameraModel::p1, "tangential distortion: y' gains p1 (r^2 + 2 y^2)")
      .def_readonly("p2", &CameraModel::p2, "tangential distortion: x' gains p2 (r^2 + 2 x^2)")
      .def_readonly("k3", &CameraModel::k3, "radial distortion of r^6; of a fisheye, of the angle^6")
      .def_readonly("k4", &CameraModel::k4, "of a fisheye alone: radial distortion of the angle^8")
      .def(
          "project", [](const CameraModel& camera, const Eigen::Vector3d& point_m) { return project(camera, point_m); },
          "Point in the camera frame [m] to pixels (2,), or None if it is not in front.", py::arg("point_m"))
      .def(
          "normalize",
          [](const CameraModel& camera, const Eigen::Vector2d& pixel) { return normalize_pixel(camera, pixel); },
          "Pixels (2,) to the undistorted normalised image plane (2,).", py::arg("pixel"));

  bind_parameters<CameraMounting>(m, "CameraMounting", "Where the camera sits on the robot.")
      .def_property_readonly(
          "bMc", [](const CameraMounting& mounting) { return to_array(base_from_camera(mounting)); },
          "(4, 4): camera frame to base frame");
  bind_parameters<BodyTag>(m, "BodyTag", "One tag on a robot.")
      .def_property_readonly(
          "oMt", [](const BodyTag& tag) { return to_array(body_from_tag(tag)); },
          "(4, 4): tag frame to the leader's base frame")
      .def_property_readonly(
          "corners_m",
          [](const BodyTag& tag) {
            const auto corners = corners_on_body(tag);
            DoubleArray array({4, 3});
            for (int i = 0; i < 4; ++i)
              for (int k = 0; k < 3; ++k) array.mutable_at(i, k) = corners[i][k];
            return array;
          },
          "(4, 3): bottom left, bottom right, top right, top left, in the leader's base frame");

  py::class_<LeaderBody>(m, "LeaderBody", "A leader: the tags it wears and where.")
      .def(py::init([](const std::vector<BodyTag>& tags, const std::string& family, const std::string& name) {
             LeaderBody body{name, family, tags};
             body.validate();
             return body;
           }),
           py::arg("tags"), py::kw_only(), py::arg("family") = "tag36h11", py::arg("name") = "leader",
           "tags: list of BodyTag, 1 to 12. ConfigError: no tag, too many, an id twice, a number out of range.")
      .def_readonly("name", &LeaderBody::name, "name of the leader, for people")
      .def_readonly("family", &LeaderBody::family, "name of the AprilTag family of all its tags")
      .def_readonly("tags", &LeaderBody::tags, "list of BodyTag, a copy");

  py::class_<TagDetection>(m, "TagDetection",
                           "One tag in one picture; corners (4, 2) [px] from the bottom left, "
                           "counter-clockwise as one reads the tag.")
      .def(py::init([](int id, const DoubleArray& corners_px, int hamming, double decision_margin) {
             return TagDetection{id, hamming, decision_margin, to_corners(corners_px)};
           }),
           py::kw_only(), py::arg("id"), py::arg("corners_px"), py::arg("hamming") = 0,
           py::arg("decision_margin") = 0.0,
           "corners_px: (4, 2) [px] from the bottom left, counter-clockwise as one reads the tag. ValueError on "
           "another shape.")
      .def_readonly("id", &TagDetection::id, "number of the tag in its family")
      .def_readonly("hamming", &TagDetection::hamming, "corrected bits")
      .def_readonly("decision_margin", &TagDetection::decision_margin,
                    "AprilTag's: mean contrast of the bits, in gray levels")
      .def_property_readonly(
          "corners_px", [](const TagDetection& tag) { return to_array(tag.corners_px); },
          "(4, 2) [px]: bottom left, bottom right, top right, top left, as one reads the tag; (0, 0) is the top-left "
          "pixel's centre");

  py::enum_<FoundBy>(m, "FoundBy", "How the leader's tags were found in a frame.")
      .value("track", FoundBy::track)
      .value("region", FoundBy::region)
      .value("frame", FoundBy::frame);
  py::class_<RelativeMeasurement>(m, "RelativeMeasurement", "What one frame says by itself.")
      .def(py::init([](double distance_m, double bearing_rad, double heading_rad, const DoubleArray& covariance) {
             return RelativeMeasurement{{distance_m, bearing_rad, heading_rad},
                                        to_matrix<3, 3>(covariance, "covariance")};
           }),
           py::kw_only(), py::arg("distance_m"), py::arg("bearing_rad"), py::arg("heading_rad"), py::arg("covariance"),
           "covariance: (3, 3) of (distance_m, bearing_rad, heading_rad). ValueError on another shape.")
      .def_property_readonly(
          "distance_m", [](const RelativeMeasurement& r) { return r.pose.distance_m; },
          "d [m], between the base origins, of this frame alone")
      .def_property_readonly(
          "bearing_rad", [](const RelativeMeasurement& r) { return r.pose.bearing_rad; },
          "theta [rad], positive: the leader is to the left, of this frame alone")
      .def_property_readonly(
          "heading_rad", [](const RelativeMeasurement& r) { return r.pose.heading_rad; },
          "psi [rad], the leader's heading relative to the coordinator's, of this frame alone")
      .def_property_readonly(
          "covariance", [](const RelativeMeasurement& r) { return to_array(r.covariance); },
          "(3, 3) of (distance_m, bearing_rad, heading_rad)");
  const Eigen::Matrix3d zero = Eigen::Matrix3d::Zero();
  py::class_<Observation>(m, "Observation", "The leader, measured in one frame.")
      .def(py::init([](std::int64_t utime, double distance_m, double bearing_rad, double heading_rad,
                       const DoubleArray& covariance, std::vector<TagDetection> tags,
                       const std::optional<RelativeMeasurement>& measured, double heading_ambiguity,
                       const std::optional<DoubleArray>& cMo, const std::optional<DoubleArray>& other_cMo,
                       double ambiguity_ratio, double reprojection_error_px, double min_decision_margin,
                       FoundBy found_by) {
             Observation observation;
             observation.utime = utime;
             observation.distance_m = distance_m;
             observation.bearing_rad = bearing_rad;
             observation.heading_rad = heading_rad;
             observation.covariance = to_matrix<3, 3>(covariance, "covariance");
             observation.measured =
                 measured.value_or(RelativeMeasurement{{distance_m, bearing_rad, heading_rad}, observation.covariance});
             observation.heading_ambiguity = heading_ambiguity;
             if (cMo) observation.cMo = to_pose(*cMo);
             if (other_cMo) observation.other_cMo = to_pose(*other_cMo);
             observation.ambiguity_ratio = ambiguity_ratio;
             observation.reprojection_error_px = reprojection_error_px;
             observation.min_decision_margin = min_decision_margin;
             observation.found_by = found_by;
             if (tags.size() > kMaxTagsOnBody) throw py::value_error("an observation has at most 12 tags");
             for (TagDetection& tag : tags) observation.tags.push_back(std::move(tag));
             return observation;
           }),
           py::kw_only(), py::arg("utime"), py::arg("distance_m"), py::arg("bearing_rad") = 0.0,
           py::arg("heading_rad") = 0.0, py::arg_v("covariance", to_array(zero), "numpy.zeros((3, 3))"),
           py::arg("tags") = std::vector<TagDetection>{}, py::arg("measured") = py::none(),
           py::arg("heading_ambiguity") = 0.0, py::arg("cMo") = py::none(), py::arg("other_cMo") = py::none(),
           py::arg("ambiguity_ratio") = 1.0, py::arg("reprojection_error_px") = 0.0,
           py::arg("min_decision_margin") = 0.0, py::arg_v("found_by", FoundBy::frame, "pilotfish.core.FoundBy.frame"),
           "measured: default, the same as the filtered numbers.")
      .def_readonly("utime", &Observation::utime, "exposure of the frame [us]")
      .def_readonly("distance_m", &Observation::distance_m,
                    "d = hypot(x, y) [m] of the leader's base origin in the coordinator's base frame")
      .def_readonly("bearing_rad", &Observation::bearing_rad, "theta = atan2(y, x) [rad], positive: to the left")
      .def_readonly("heading_rad", &Observation::heading_rad,
                    "psi [rad], the leader's heading relative to the coordinator's, filtered over the frames")
      .def_property_readonly(
          "covariance", [](const Observation& o) { return to_array(o.covariance); },
          "(3, 3) of (distance_m, bearing_rad, heading_rad)")
      .def_property_readonly(
          "cMo", [](const Observation& o) { return to_array(o.cMo); },
          "(4, 4): leader's base frame to camera frame [m], of this frame alone")
      .def_readonly("measured", &Observation::measured, "of this frame alone: what a filter of your own should be fed")
      .def_readonly("heading_ambiguity", &Observation::heading_ambiguity,
                    "how strongly the headings so far indicate another one than heading_rad, 0 to 1")
      .def_property_readonly(
          "other_cMo",
          [](const Observation& o) -> std::optional<py::array_t<double>> {
            if (!o.other_cMo) return std::nullopt;
            return to_array(*o.other_cMo);
          },
          "(4, 4) of the other planar solution, or None")
      .def_readonly("reprojection_error_px", &Observation::reprojection_error_px, "RMS over all corners used [px]")
      .def_readonly("ambiguity_ratio", &Observation::ambiguity_ratio,
                    "error of the worse planar solution over the better one's, in standard deviations of the corners, "
                    "at least 1; near 1 the heading is ambiguous in one picture, 1e6 without a second solution")
      .def_readonly("min_decision_margin", &Observation::min_decision_margin,
                    "smallest decision margin of the tags used, in gray levels")
      .def_readonly("found_by", &Observation::found_by, "FoundBy: how the tags were found")
      .def_property_readonly(
          "tags", [](const Observation& o) { return std::vector<TagDetection>(o.tags.begin(), o.tags.end()); },
          "list of TagDetection: the tags used, 12 at most");

  bind_range_scan(m);
  m.def(
      "read_file",
      [](const std::filesystem::path& file, std::size_t max_bytes) {
        const FileRead read = [&] {
          const py::gil_scoped_release unlocked;
          return read_file(file, max_bytes);
        }();
        if (!read.bytes) throw std::invalid_argument(read.problem);
        return py::bytes(*read.bytes);
      },
      "The bytes of a regular file; ValueError says why not. Never blocks on a pipe, never reads a device.",
      py::arg("file"), py::arg("max_bytes"));
  m.def(
      "relative_pose",
      [](const DoubleArray& bMo) {
        const RelativePose pose = relative_pose(to_pose(bMo));
        return std::make_tuple(pose.distance_m, pose.bearing_rad, pose.heading_rad);
      },
      "(distance_m, bearing_rad, heading_rad) of a leader whose base has the pose bMo (4, 4).", py::arg("bMo"));

  make_value(m, "LeaderBody", {"tags", "family", "name"});
  make_value(m, "CameraModel", {"width", "height", "fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"});
  make_value(m, "TagDetection", {"id", "corners_px", "hamming", "decision_margin"});
  make_value(m, "RelativeMeasurement", {"distance_m", "bearing_rad", "heading_rad", "covariance"});
  make_value(
      m, "Observation",
      {"utime", "distance_m", "bearing_rad", "heading_rad", "covariance", "tags", "measured", "heading_ambiguity",
       "cMo", "other_cMo", "ambiguity_ratio", "reprojection_error_px", "min_decision_margin", "found_by"});
  make_value(m, "RangeScan", {"utime", "first_rad", "step_rad", "ranges_m"});
  add_copies(m.attr("Twist"));
  add_copies(m.attr("Frame"), {"image", "utime"});
  make_results<SetpointDecision>();
  add_reprs(
      m, {"Twist", "SetpointDecision", "CameraModel", "LeaderBody", "TagDetection", "SequenceGuard", "SetpointGate"});
  add_repr(m, "RangeScan", {"utime", "first_rad", "step_rad", "ranges_m"});
  add_repr(m, "Frame", {"utime", "width", "height"});
  add_repr(m, "RelativeMeasurement", {"distance_m", "bearing_rad", "heading_rad"});
  add_repr(m, "Observation",
           {"utime", "distance_m", "bearing_rad", "heading_rad", "found_by", "reprojection_error_px", "tags"});
}
