#include "pilotfish/bus/bus.hpp"

#include <pybind11/functional.h>

#include "arrays.hpp"
#include "pilotfish/bus/log_reader.hpp"

namespace py = pybind11;
using namespace pilotfish;
using namespace pilotfish::bus;

namespace {

void bind_reports(py::module_& m) {
  py::class_<CommandReport>(m, "CommandReport", "pilotfish.command_t, out and in.")
      .def(py::init([](std::int64_t utime, std::int64_t session, std::int64_t counter, std::int64_t base_session,
                       const Twist& command, bool simulated, Status status, Reason reason) {
             return CommandReport{utime, session, counter, base_session, command, simulated, status, reason};
           }),
           py::kw_only(), py::arg("utime"), py::arg("session") = 0, py::arg("counter") = 0, py::arg("base_session") = 0,
           py::arg("command") = Twist{}, py::arg("simulated") = false,
           py::arg_v("status", Status::searching, "pilotfish.core.Status.searching"),
           py::arg_v("reason", Reason::none, "pilotfish.core.Reason.none"))
      .def_readwrite("utime", &CommandReport::utime)
      .def_readwrite("session", &CommandReport::session)
      .def_readwrite("counter", &CommandReport::counter)
      .def_readwrite("base_session", &CommandReport::base_session)
      .def_readwrite("command", &CommandReport::command)
      .def_readwrite("simulated", &CommandReport::simulated)
      .def_readwrite("status", &CommandReport::status)
      .def_readwrite("reason", &CommandReport::reason);

  py::class_<SetpointReport>(
      m, "SetpointReport",
      "pilotfish.setpoint_t, out and in. A stop that cannot be believed in anything else comes in "
      "with session and counter 0.")
      .def(py::init([](std::int64_t utime, std::int64_t session, std::int64_t counter, const Setpoint& setpoint) {
             return SetpointReport{utime, session, counter, setpoint};
           }),
           py::kw_only(), py::arg("utime"), py::arg("session") = 0, py::arg("counter") = 0,
           py::arg_v("setpoint", Setpoint{}, "pilotfish.core.Setpoint()"))
      .def_readwrite("utime", &SetpointReport::utime)
      .def_readwrite("session", &SetpointReport::session)
      .def_readwrite("counter", &SetpointReport::counter)
      .def_readwrite("setpoint", &SetpointReport::setpoint);

  py::class_<BaseReport> base(m, "BaseReport", "pilotfish.base_t, out and in.");
  py::enum_<BaseReport::State>(base, "State")
      .value("waiting", BaseReport::State::waiting)
      .value("driving", BaseReport::State::driving)
      .value("stopped", BaseReport::State::stopped)
      .value("fault", BaseReport::State::fault);
  base.def(py::init([](std::int64_t utime, std::int64_t session, std::int64_t counter, std::int64_t obeys,
                       const Twist& command, std::optional<Twist> measured, bool stopped, BaseReport::State state,
                       std::string text, Counters rejected) {
             return BaseReport{utime,    session, counter, obeys,           command,
                               measured, stopped, state,   std::move(text), std::move(rejected)};
           }),
           py::kw_only(), py::arg("utime"), py::arg("session") = 0, py::arg("counter") = 0, py::arg("obeys") = 0,
           py::arg("command") = Twist{}, py::arg("measured") = py::none(), py::arg("stopped") = false,
           py::arg_v("state", BaseReport::State::waiting, "BaseReport.State.waiting"), py::arg("text") = "",
           py::arg("rejected") = Counters{})
      .def_readwrite("utime", &BaseReport::utime)
      .def_readwrite("session", &BaseReport::session)
      .def_readwrite("counter", &BaseReport::counter)
      .def_readwrite("obeys", &BaseReport::obeys)
      .def_readwrite("command", &BaseReport::command)
      .def_readwrite("measured", &BaseReport::measured)
      .def_readwrite("stopped", &BaseReport::stopped)
      .def_readwrite("state", &BaseReport::state)
      .def_readwrite("text", &BaseReport::text)
      .def_readwrite("rejected", &BaseReport::rejected);

  py::class_<StageReport>(m, "StageReport", "How long a stage of the control loop took: pilotfish.stage_t.")
      .def(py::init([](std::string name, const std::array<std::int32_t, 11>& counts, double max_ms) {
             return StageReport{std::move(name), counts, max_ms};
           }),
           py::kw_only(), py::arg("name"), py::arg("counts") = std::array<std::int32_t, 11>{}, py::arg("max_ms") = 0.0)
      .def_readwrite("name", &StageReport::name)
      .def_readwrite("counts", &StageReport::counts)
      .def_readwrite("max_ms", &StageReport::max_ms);

  py::class_<ObservationReport>(m, "ObservationReport", "What goes out as pilotfish.observation_t.")
      .def(py::init(
               [](std::int64_t utime, const std::optional<Observation>& observation, Reason reason, double latency_s) {
                 return ObservationReport{utime, observation, reason, latency_s};
               }),
           py::kw_only(), py::arg("utime"), py::arg("observation") = py::none(),
           py::arg_v("reason", Reason::none, "pilotfish.core.Reason.none"), py::arg("latency_s") = 0.0)
      .def_readwrite("utime", &ObservationReport::utime)
      .def_readwrite("observation", &ObservationReport::observation)
      .def_readwrite("reason", &ObservationReport::reason)
      .def_readwrite("latency_s", &ObservationReport::latency_s);

  py::class_<StatusReport>(m, "StatusReport", "pilotfish.status_t, out and in.")
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
           py::arg("processing_ms") = 0.0, py::arg("rejected") = std::map<std::string, std::int64_t>{})
      .def_readwrite("utime", &StatusReport::utime)
      .def_readwrite("status", &StatusReport::status)
      .def_readwrite("reason", &StatusReport::reason)
      .def_readwrite("error_m", &StatusReport::error_m)
      .def_readwrite("error_change_m", &StatusReport::error_change_m)
      .def_readwrite("output", &StatusReport::output)
      .def_readwrite("strengths", &StatusReport::strengths)
      .def_readwrite("session", &StatusReport::session)
      .def_readwrite("setpoint_counter", &StatusReport::setpoint_counter)
      .def_readwrite("setpoint", &StatusReport::setpoint)
      .def_readwrite("trust", &StatusReport::trust)
      .def_readwrite("leader_radial_mps", &StatusReport::leader_radial_mps)
      .def_readwrite("leader_tangential_mps", &StatusReport::leader_tangential_mps)
      .def_readwrite("leader_turn_rate_radps", &StatusReport::leader_turn_rate_radps)
      .def_readwrite("own_motion", &StatusReport::own_motion)
      .def_readwrite("announcement", &StatusReport::announcement)
      .def_readwrite("latency_s", &StatusReport::latency_s)
      .def_readwrite("latency_from_exposure", &StatusReport::latency_from_exposure)
      .def_readwrite("configured_latency_s", &StatusReport::configured_latency_s)
      .def_readwrite("frame_rate_hz", &StatusReport::frame_rate_hz)
      .def_readwrite("processing_ms", &StatusReport::processing_ms)
      .def_readwrite("missed_deadlines", &StatusReport::missed_deadlines)
      .def_readwrite("clock_epochs", &StatusReport::clock_epochs)
      .def_readwrite("stages", &StatusReport::stages)
      .def_readwrite("rejected", &StatusReport::rejected);

  py::class_<PoseReport>(m, "PoseReport", "What goes out as bot_core.pose_t.")
      .def(py::init([](std::int64_t utime, double x_m, double y_m, double heading_rad, const Twist& velocity) {
             return PoseReport{utime, x_m, y_m, heading_rad, velocity};
           }),
           py::kw_only(), py::arg("utime"), py::arg("x_m"), py::arg("y_m"), py::arg("heading_rad"),
           py::arg("velocity") = Twist{})
      .def_readwrite("utime", &PoseReport::utime)
      .def_readwrite("x_m", &PoseReport::x_m)
      .def_readwrite("y_m", &PoseReport::y_m)
      .def_readwrite("heading_rad", &PoseReport::heading_rad)
      .def_readwrite("velocity", &PoseReport::velocity);

  py::class_<MotionReport>(m, "MotionReport", "A robot's twist at a time: pilotfish.motion_t.")
      .def(py::init([](std::int64_t utime, const Twist& twist) {
             return MotionReport{utime, twist};
           }),
           py::kw_only(), py::arg("utime"), py::arg("twist") = Twist{})
      .def_readwrite("utime", &MotionReport::utime)
      .def_readwrite("twist", &MotionReport::twist);
}

void bind_encoded_image(py::module_& m) {
  py::class_<EncodedImage>(m, "EncodedImage",
                           "A picture as it came: its header is checked, its pixels are not decoded.")
      .def_readonly("utime", &EncodedImage::utime)
      .def_readonly("width", &EncodedImage::width)
      .def_readonly("height", &EncodedImage::height)
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

  py::register_exception<BusError>(m, "BusError", PyExc_OSError);
  m.attr("DEFAULT_URL") = kDefaultUrl;
  m.def("channel", &channel, "Channel of a robot: ('robot1', 'COMMAND') -> 'ROBOT1_COMMAND'.", py::arg("robot"),
        py::arg("what"));
  bind_reports(m);
  py::class_<Key>(m, "Key", "What commands and setpoints are authenticated with: load_key().");
  m.def("load_key", &load_key, py::arg("path"),
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
      .def_property_readonly("url", &Bus::url)
      .def_property_readonly("receive_buffer_bytes", &Bus::receive_buffer_bytes,
                             "What the kernel grants; 0 if the provider has no socket")
      .def_property_readonly("rejected", &Bus::rejected, "dict: messages dropped, by kind")
      .def("set_key", &Bus::set_key, py::arg("key"),
           "Commands and setpoints carry a MAC from now on, and are refused without a right one; stops never are.")
      .def("publish_command", py::overload_cast<const std::string&, const CommandReport&>(&Bus::publish),
           py::arg("robot"), py::arg("report"), Release())
      .def("publish_observation", py::overload_cast<const std::string&, const ObservationReport&>(&Bus::publish),
           py::arg("robot"), py::arg("report"), Release())
      .def("publish_status", py::overload_cast<const std::string&, const StatusReport&>(&Bus::publish),
           py::arg("robot"), py::arg("report"), Release())
      .def("publish_pose", py::overload_cast<const std::string&, const PoseReport&>(&Bus::publish), py::arg("robot"),
           py::arg("report"), Release())
      .def("publish_motion", py::overload_cast<const std::string&, const MotionReport&>(&Bus::publish),
           py::arg("robot"), py::arg("report"), Release())
      .def("publish_base", py::overload_cast<const std::string&, const BaseReport&>(&Bus::publish), py::arg("robot"),
           py::arg("report"), Release())
      .def("publish_setpoint", py::overload_cast<const std::string&, const SetpointReport&>(&Bus::publish),
           py::arg("robot"), py::arg("report"), Release(), "Raises ValueError if the setpoint is out of bounds.")
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
           Release())
      .def("next", &LogReader::next, Release(), "The next Frame (0 x 0 if corrupt), None at the end.")
      .def("__len__", &LogReader::size)
      .def_property_readonly("damaged", &LogReader::damaged, "damaged places in the file that were skipped")
      .def("__iter__", [](py::object self) { return self; })
      .def("__next__", [](LogReader& reader) {
        std::optional<Frame> frame;
        {
          const py::gil_scoped_release release;
          frame = reader.next();
        }
        if (!frame) throw py::stop_iteration();
        return *frame;
      });
}
