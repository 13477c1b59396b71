#include "pilotfish/bus/bus.hpp"

#include <pybind11/functional.h>
#include <pybind11/typing.h>

#include "arrays.hpp"
#include "exclusive.hpp"
#include "pilotfish/bus/log_reader.hpp"
#include "repr.hpp"

namespace py = pybind11;
using namespace pilotfish;
using namespace pilotfish::bus;

namespace {

/// What LCM calls the type of a number in a status.
template <class Value>
const char* wire_type(Value StatusReport::*) {
  static_assert(std::is_arithmetic_v<Value>);
  if (std::is_same_v<Value, bool>) return "boolean";
  if (std::is_same_v<Value, double>) return "double";
  return sizeof(Value) == 1 ? "int8_t" : "int64_t";
}

void bind_reports(py::module_& m) {
  py::class_<CommandReport>(m, "CommandReport", "pilotfish.command_t, out and in.")
      .def(
          py::init([](std::int64_t utime, std::int64_t session, std::int64_t counter, std::int64_t base_session,
                      std::int64_t valid_until_us, const Twist& command, bool simulated, Status status, Reason reason) {
            return CommandReport{utime,   session,   counter, base_session, valid_until_us,
                                 command, simulated, status,  reason};
          }),
          py::kw_only(), py::arg("utime"), py::arg("session") = 0, py::arg("counter") = 0, py::arg("base_session") = 0,
          py::arg("valid_until_us") = 0, py::arg("command") = Twist{}, py::arg("simulated") = false,
          py::arg_v("status", Status::searching, "pilotfish.core.Status.searching"),
          py::arg_v("reason", Reason::none, "pilotfish.core.Reason.none"),
          "Fields by keyword, as the attributes of the same name.")
      .def_readwrite("utime", &CommandReport::utime,
                     "exposure [us] of the image it answers; of the last one, when none came")
      .def_readwrite("session", &CommandReport::session,
                     "the sender's, see new_session_id(); 0: no receiver accepts it")
      .def_readwrite("counter", &CommandReport::counter, "one more with every command sent in this session")
      .def_readwrite("base_session", &CommandReport::base_session,
                     "of the wheels' process, as the sender has received it; 0: none")
      .def_readwrite("valid_until_us", &CommandReport::valid_until_us,
                     "its measurement is too old from then on, by the clock of the wheels' process [us]; 0 for zeros")
      .def_readwrite("command", &CommandReport::command, "Twist for the wheels, in the robot's base frame")
      .def_readwrite("simulated", &CommandReport::simulated, "True: never for real wheels")
      .def_readwrite("status", &CommandReport::status, "Status of the coordinator")
      .def_readwrite("reason", &CommandReport::reason, "Reason for the status");

  py::class_<SetpointReport>(
      m, "SetpointReport",
      "pilotfish.setpoint_t, out and in. A stop that cannot be accepted in anything else comes in "
      "with session and counter 0.")
      .def(py::init([](std::int64_t utime, std::int64_t session, std::int64_t counter, const Setpoint& setpoint) {
             return SetpointReport{utime, session, counter, setpoint};
           }),
           py::kw_only(), py::arg("utime"), py::arg("session") = 0, py::arg("counter") = 0,
           py::arg_v("setpoint", Setpoint{}, "pilotfish.core.Setpoint()"),
           "Fields by keyword, as the attributes of the same name.")
      .def_readwrite("utime", &SetpointReport::utime, "when it was sent [us]")
      .def_readwrite("session", &SetpointReport::session, "of the coordinator it is meant for")
      .def_readwrite("counter", &SetpointReport::counter, "higher than every one that this session has accepted")
      .def_readwrite("setpoint", &SetpointReport::setpoint, "Setpoint to keep");

  py::class_<BaseReport> base(m, "BaseReport", "pilotfish.base_t, out and in.");
  py::enum_<BaseReport::State>(base, "State", "What the wheels' process is doing; base_t's STATE_ numbers.")
      .value("waiting", BaseReport::State::waiting)
      .value("driving", BaseReport::State::driving)
      .value("stopped", BaseReport::State::stopped)
      .value("fault", BaseReport::State::fault);
  base.def(py::init([](std::int64_t utime, std::int64_t session, std::int64_t counter, std::int64_t monotonic_us,
                       std::int64_t accepted_session, const Twist& command, std::optional<Twist> measured, bool stopped,
                       BaseReport::State state, std::string text, Counters rejected) {
             return BaseReport{utime,    session, counter, monotonic_us,    accepted_session,   command,
                               measured, stopped, state,   std::move(text), std::move(rejected)};
           }),
           py::kw_only(), py::arg("utime"), py::arg("session") = 0, py::arg("counter") = 0, py::arg("monotonic_us") = 0,
           py::arg("accepted_session") = 0, py::arg("command") = Twist{}, py::arg("measured") = py::none(),
           py::arg("stopped") = false, py::arg_v("state", BaseReport::State::waiting, "BaseReport.State.waiting"),
           py::arg("text") = "", py::arg("rejected") = Counters{},
           "Fields by keyword, as the attributes of the same name.")
      .def_readwrite("utime", &BaseReport::utime, "when it was sent [us]")
      .def_readwrite("session", &BaseReport::session, "of the wheels' process; commands name it")
      .def_readwrite("counter", &BaseReport::counter, "one more with every report of this session")
      .def_readwrite("monotonic_us", &BaseReport::monotonic_us,
                     "the clock of the wheels' process when it was sent [us]; 0: not known")
      .def_readwrite("accepted_session", &BaseReport::accepted_session,
                     "the session whose commands are accepted; 0: none")
      .def_readwrite("command", &BaseReport::command, "Twist commanded to the wheels, after every limit")
      .def_readwrite("measured", &BaseReport::measured,
                     "Twist that the wheels did, from their encoders; None if not measured")
      .def_readwrite("stopped", &BaseReport::stopped, "True while a stop is latched")
      .def_readwrite("state", &BaseReport::state, "State: what the wheels' process is doing")
      .def_readwrite("text", &BaseReport::text, "a line for people; at most 80 letters travel")
      .def_readwrite("rejected", &BaseReport::rejected, "dict of refusals by name; at most 16 travel");

  py::class_<StageReport>(m, "StageReport", "How long a stage of the control loop took: pilotfish.stage_t.")
      .def(py::init([](std::string name, const std::array<std::int32_t, 11>& counts, double max_ms) {
             return StageReport{std::move(name), counts, max_ms};
           }),
           py::kw_only(), py::arg("name"), py::arg("counts") = std::array<std::int32_t, 11>{}, py::arg("max_ms") = 0.0,
           "Fields by keyword, as the attributes of the same name.")
      .def_readwrite("name", &StageReport::name, "name of the stage, at most 12 letters")
      .def_readwrite(
          "counts", &StageReport::counts,
          "11 counts: how often less than 0.25, 0.5, 1, ... 128 ms (and not less than the one before), or longer")
      .def_readwrite("max_ms", &StageReport::max_ms, "the longest time [ms]");

  py::class_<ObservationReport>(m, "ObservationReport", "What goes out as pilotfish.observation_t.")
      .def(py::init(
               [](std::int64_t utime, const std::optional<Observation>& observation, Reason reason, double latency_s) {
                 return ObservationReport{utime, observation, reason, latency_s};
               }),
           py::kw_only(), py::arg("utime"), py::arg("observation") = py::none(),
           py::arg_v("reason", Reason::none, "pilotfish.core.Reason.none"), py::arg("latency_s") = 0.0,
           "Fields by keyword, as the attributes of the same name.")
      .def_readwrite("utime", &ObservationReport::utime, "exposure of the frame [us]")
      .def_readwrite("observation", &ObservationReport::observation, "Observation of that frame, or None")
      .def_readwrite("reason", &ObservationReport::reason, "why there is no observation; Reason.none if there is")
      .def_readwrite("latency_s", &ObservationReport::latency_s, "from the frame's arrival to this message [s]");

  py::class_<StatusReport> binding(m, "StatusReport", "pilotfish.status_t, out and in.");
  binding
      .def(py::init([](std::int64_t utime, Status status, Reason reason, double error_m, double error_change_m,
                       double output, const std::array<double, kStatusRules>& strengths, const Setpoint& setpoint,
                       double frame_rate_hz, double processing_ms, std::map<std::string, std::int64_t> rejected) {
             StatusReport report;
             report.utime = utime;
             report.status = status;
             report.reason = reason;
             report.error_m = error_m;
             report.error_change_m = error_change_m;
             report.output = output;
             report.strengths = strengths;
             report.setpoint = setpoint;
             report.frame_rate_hz = frame_rate_hz;
             report.processing_ms = processing_ms;
             report.rejected = std::move(rejected);
             return report;
           }),
           py::kw_only(), py::arg("utime"), py::arg_v("status", Status::searching, "pilotfish.core.Status.searching"),
           py::arg_v("reason", Reason::none, "pilotfish.core.Reason.none"), py::arg("error_m") = 0.0,
           py::arg("error_change_m") = 0.0, py::arg("output") = 0.0,
           py::arg("strengths") = std::array<double, kStatusRules>{},
           py::arg_v("setpoint", Setpoint{}, "pilotfish.core.Setpoint()"), py::arg("frame_rate_hz") = 0.0,
           py::arg("processing_ms") = 0.0, py::arg("rejected") = std::map<std::string, std::int64_t>{},
           "Fields by keyword, as the attributes of the same name; the others are set afterwards.")
      .def_readwrite("utime", &StatusReport::utime, "exposure [us] of the image this answers")
      .def_readwrite("status", &StatusReport::status, "Status: what the coordinator is doing")
      .def_readwrite("reason", &StatusReport::reason, "Reason for the status")
      .def_readwrite("detail", &StatusReport::detail,
                     "the reason's numbers, for people; sent with the text, not received")
      .def_readwrite(
          "strengths", &StatusReport::strengths,
          "56 strengths of the rules (Table I) in [0, 1], row by row: E from NB to PB, within it EC from NB to PB")
      .def_readwrite("setpoint", &StatusReport::setpoint, "Setpoint that is kept")
      .def_readwrite("stages", &StatusReport::stages, "list of StageReport; at most 6 travel")
      .def_readwrite("rejected", &StatusReport::rejected,
                     "dict of refusals by name; as many as fit travel with one message, the others with the next");
  StatusReport::fields([&](const StatusField& field, auto member) {
    const std::string unit = *field.unit == 0 ? "" : " [" + std::string(field.unit) + "]";
    binding.def_readwrite(field.name, member, (field.text + unit).c_str());
  });
  m.def(
      "status_fields",
      [] {
        std::vector<std::tuple<std::string, std::string, std::string, std::string>> rows;
        StatusReport::fields([&](const StatusField& field, auto member) {
          rows.emplace_back(field.name, wire_type(member), field.unit, field.text);
        });
        return rows;
      },
      "(name, type, unit, text) of every number of a status_t, in its order; type: as in the .lcm file.");

  py::class_<PoseReport>(m, "PoseReport", "What goes out as bot_core.pose_t.")
      .def(py::init([](std::int64_t utime, double x_m, double y_m, double heading_rad, const Twist& velocity) {
             return PoseReport{utime, x_m, y_m, heading_rad, velocity};
           }),
           py::kw_only(), py::arg("utime"), py::arg("x_m"), py::arg("y_m"), py::arg("heading_rad"),
           py::arg("velocity") = Twist{}, "Fields by keyword, as the attributes of the same name.")
      .def_readwrite("utime", &PoseReport::utime, "time of the pose [us]")
      .def_readwrite("x_m", &PoseReport::x_m, "in the world frame [m]")
      .def_readwrite("y_m", &PoseReport::y_m, "in the world frame [m]")
      .def_readwrite("heading_rad", &PoseReport::heading_rad, "from the world's x axis [rad], positive: to the left")
      .def_readwrite("velocity", &PoseReport::velocity, "Twist in the robot's base frame");

  py::class_<MotionReport>(m, "MotionReport", "A robot's twist at a time: pilotfish.motion_t.")
      .def(py::init([](std::int64_t utime, const Twist& twist) {
             return MotionReport{utime, twist};
           }),
           py::kw_only(), py::arg("utime"), py::arg("twist") = Twist{},
           "Fields by keyword, as the attributes of the same name.")
      .def_readwrite("utime", &MotionReport::utime, "time of the twist [us]")
      .def_readwrite("twist", &MotionReport::twist, "Twist in the robot's base frame");
}

void bind_encoded_image(py::module_& m) {
  py::class_<EncodedImage>(m, "EncodedImage",
                           "A picture as it came: its header is checked, its pixels are not decoded.")
      .def_readonly("utime", &EncodedImage::utime, "exposure time [us], on the clock of whoever took the picture")
      .def_readonly("width", &EncodedImage::width, "claimed width [px]")
      .def_readonly("height", &EncodedImage::height, "claimed height [px]")
      .def_property_readonly(
          "arrival_us", [](const EncodedImage& image) { return image.arrival.us; },
          "when it reached this host, on CLOCK_BOOTTIME");
  m.def(
      "decode",
      [](const EncodedImage& image, std::optional<std::pair<int, int>> expected_size) {
        std::string_view rejection;
        const auto frame = expected_size ? decode(image, {expected_size->first, expected_size->second}, rejection)
                                         : decode(image, rejection);
        if (!frame) throw py::value_error(std::string(rejection));
        return *frame;
      },
      py::arg("image"), py::kw_only(), py::arg("expected_size") = py::none(), py::call_guard<py::gil_scoped_release>(),
      "The Frame of an EncodedImage; expected_size: (width, height). Raises ValueError with the reason.");
}

}  // namespace

PYBIND11_MODULE(bus, m) {
  m.doc() = "LCM in and out, checked at this edge.";
  py::module_::import("pilotfish.core");

  py::register_exception<BusError>(m, "BusError", PyExc_OSError).doc() =
      "The bus or a log cannot be opened; the message says what to do.";
  m.attr("DEFAULT_URL") = kDefaultUrl;
  m.def("channel", &channel, "Channel of a robot: ('robot1', 'COMMAND') -> 'ROBOT1_COMMAND'.", py::arg("robot"),
        py::arg("what"));
  bind_reports(m);
  py::class_<Key>(m, "Key", "What commands and setpoints are authenticated with: load_key().");
  m.def("load_key", &load_key, py::arg("path"), py::call_guard<py::gil_scoped_release>(),
        "From a file of 64 hex digits that only its owner may read; raises ValueError.");
  m.def(
      "message_mac",
      [](const Key& key, const std::string& channel_name, const py::bytes& encoded) {
        const std::string bytes = encoded;
        const Mac mac = message_mac(key, channel_name, bytes.data(), bytes.size());
        return py::bytes(reinterpret_cast<const char*>(mac.data()), mac.size());
      },
      py::arg("key"), py::arg("channel"), py::arg("encoded"), "The MAC of an encoded command_t or setpoint_t.");
  m.def("new_session_id", &new_session_id, "A positive number drawn at random.");
  bind_encoded_image(m);

  using Release = py::call_guard<py::gil_scoped_release>;
  py::class_<Bus>(m, "Bus", "A connection to the LCM network: what comes in is checked, or counted in `rejected`.")
      .def(py::init<const std::string&>(), py::arg("url") = "", Release(),
           "url: empty for $LCM_DEFAULT_URL, else DEFAULT_URL. Raises BusError saying what to do.")
      .def_property_readonly("url", &Bus::url, "the URL that is in use")
      .def_property_readonly("receive_buffer_bytes", &Bus::receive_buffer_bytes,
                             "What the kernel grants; 0 if the provider has no socket")
      .def_property_readonly("rejected", &Bus::rejected, "dict: messages dropped, by kind")
      .def("set_key", &Bus::set_key, py::arg("key"),
           "Commands and setpoints carry a MAC from now on, and are refused without a right one; stops never are.")
      .def("publish_command", py::overload_cast<const std::string&, const CommandReport&>(&Bus::publish),
           py::arg("robot"), py::arg("report"), Release(),
           "Sends a CommandReport on NAME_COMMAND. Numbers that are not finite go out as a zero command, and are "
           "counted. ConfigError on a name that is no channel.")
      .def("publish_observation", py::overload_cast<const std::string&, const ObservationReport&>(&Bus::publish),
           py::arg("robot"), py::arg("report"), Release(),
           "Sends an ObservationReport on NAME_OBSERVATION. ConfigError on a name that is no channel.")
      .def("publish_status", py::overload_cast<const std::string&, const StatusReport&>(&Bus::publish),
           py::arg("robot"), py::arg("report"), Release(),
           "Sends a StatusReport on NAME_STATUS. ConfigError on a name that is no channel.")
      .def("publish_pose", py::overload_cast<const std::string&, const PoseReport&>(&Bus::publish), py::arg("robot"),
           py::arg("report"), Release(), "Sends a PoseReport on NAME_POSE. ConfigError on a name that is no channel.")
      .def("publish_motion", py::overload_cast<const std::string&, const MotionReport&>(&Bus::publish),
           py::arg("robot"), py::arg("report"), Release(),
           "Sends a MotionReport on NAME_MOTION. ConfigError on a name that is no channel.")
      .def("publish_base", py::overload_cast<const std::string&, const BaseReport&>(&Bus::publish), py::arg("robot"),
           py::arg("report"), Release(), "Sends a BaseReport on NAME_BASE. ConfigError on a name that is no channel.")
      .def("publish_setpoint", py::overload_cast<const std::string&, const SetpointReport&>(&Bus::publish),
           py::arg("robot"), py::arg("report"), Release(), "Raises ValueError if the setpoint is out of bounds.")
      .def("publish_ranges", py::overload_cast<const std::string&, const RangeScan&>(&Bus::publish), py::arg("robot"),
           py::arg("scan"), Release(),
           "Sends a RangeScan as a bot_core.planar_lidar_t on NAME_RANGES; one that is not usable is counted instead.")
      .def("publish_image", &Bus::publish_image, py::arg("channel"), py::arg("frame"), Release(),
           "Raw if four of them fit into the receive buffer, else as JPEG of quality 95.")
      .def("on_image", &Bus::on_image, py::arg("channel"), py::arg("handler"), Release(), "handler(frame)")
      .def("on_encoded_image", &Bus::on_encoded_image, py::arg("channel"), py::arg("handler"), Release(),
           "handler(encoded_image): nothing is decoded until decode(encoded_image)")
      .def("on_setpoint", &Bus::on_setpoint, py::arg("robot"), py::arg("handler"), Release(), "handler(report)")
      .def("on_command", &Bus::on_command, py::arg("robot"), py::arg("handler"), Release(), "handler(report)")
      .def("on_status", &Bus::on_status, py::arg("robot"), py::arg("handler"), Release(), "handler(report)")
      .def("on_base", &Bus::on_base, py::arg("robot"), py::arg("handler"), Release(), "handler(report)")
      .def("on_pose", &Bus::on_pose, py::arg("robot"), py::arg("handler"), Release(),
           "handler(report): what NAME_POSE says of the robot's speed and turn rate")
      .def("on_ranges", &Bus::on_ranges, py::arg("robot"), py::arg("handler"), Release(), "handler(scan): a RangeScan")
      .def("on_motion", &Bus::on_motion, py::arg("robot"), py::arg("handler"), Release(), "handler(report)")
      .def_property_readonly(
          "arrival_us", [](const Bus& bus) { return bus.arrival().us; },
          "when the message being handled reached this host, on CLOCK_BOOTTIME")
      .def("handle", &Bus::handle, py::arg("timeout_ms"), Release(),
           "Waits up to timeout_ms, then calls the handlers for all messages that have come; returns how "
           "many. A "
           "handler's exception comes out here.");

  py::class_<LogReader>(m, "LogReader",
                        "The images of one channel in a file written by lcm-logger; iterate, or next().")
      .def(py::init<const std::string&, const std::string&>(), py::arg("path"), py::kw_only(), py::arg("channel"),
           Release(),
           "path: a file written by lcm-logger; channel: of its images. BusError if it cannot be read as a log or has "
           "nothing on that channel.")
      .def("next", python::exclusive_unlocked(&LogReader::next), "The next Frame (0 x 0 if corrupt), None at the end.")
      .def("__len__", python::exclusive(&LogReader::size))
      .def_property_readonly("damaged", python::exclusive(&LogReader::damaged),
                             "damaged places in the file that were skipped")
      .def("__iter__", [](const py::object& self) { return py::typing::Iterator<Frame>(self); })
      .def("__next__", python::exclusive([](LogReader& reader) {
             std::optional<Frame> frame;
             {
               const py::gil_scoped_release release;
               frame = reader.next();
             }
             if (!frame) throw py::stop_iteration();
             return *frame;
           }));

  python::add_reprs(m, {"CommandReport", "SetpointReport", "BaseReport", "StageReport", "ObservationReport",
                        "StatusReport", "PoseReport", "MotionReport", "EncodedImage"});
}
