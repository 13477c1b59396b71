#include "pilotfish/base/base.hpp"

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "parameters.hpp"
#include "pilotfish/base/controller_link.hpp"
#include "pilotfish/base/serial_protocol.hpp"
#include "pilotfish/config/base_file.hpp"

namespace py = pybind11;
using namespace pilotfish;
using namespace pilotfish::base;
using namespace pilotfish::python;

namespace {

void bind_kinematics(py::module_& m) {
  bind_parameters<DriveGeometry>(m, "DriveGeometry", "Two driven wheels on one axle.");
  m.def(
      "wheel_speeds",
      [](const DriveGeometry& geometry, const Twist& twist) {
        const WheelSpeeds speeds = wheel_speeds(geometry, twist);
        return py::make_tuple(speeds.left_radps, speeds.right_radps);
      },
      py::arg("geometry"), py::arg("twist"), "(left_radps, right_radps)");
  m.def(
      "twist_of",
      [](const DriveGeometry& geometry, double left_radps, double right_radps) {
        return twist_of(geometry, {left_radps, right_radps});
      },
      py::arg("geometry"), py::kw_only(), py::arg("left_radps"), py::arg("right_radps"),
      "Twist of the base whose wheels turn with left_radps and right_radps [rad/s], positive: forwards: v = r "
      "(right + left) / 2, w = r (right - left) / b.");
  py::class_<WheelOdometry>(m, "WheelOdometry", "Where the wheels have rolled to.")
      .def(py::init<const DriveGeometry&, double>(), py::arg("geometry"), py::kw_only(), py::arg("max_wheel_radps"),
           "max_wheel_radps [rad/s]: what the wheels can do; readings that say more than twice that are no motion but "
           "a counter that began anew.")
      .def(
          "update",
          [](WheelOdometry& self, std::uint32_t time_ms, std::int32_t left_ticks, std::int32_t right_ticks) {
            return self.update({time_ms, left_ticks, right_ticks});
          },
          py::kw_only(), py::arg("time_ms"), py::arg("left_ticks"), py::arg("right_ticks"),
          "Twist since the reading before; None if it says nothing.")
      .def("forget", &WheelOdometry::forget, "The next reading is the first one again; the pose stays.")
      .def_property_readonly("jumps", &WheelOdometry::jumps, "number of readings that cannot be motion")
      .def_property_readonly(
          "pose",
          [](const WheelOdometry& self) {
            return py::make_tuple(self.pose().x_m, self.pose().y_m, self.pose().heading_rad);
          },
          "(x_m, y_m, heading_rad)");

  bind_parameters<WheelLimitsConfig>(m, "WheelLimitsConfig", "What the wheels are allowed, whoever asks.");
  m.def("limit", &base::limit, py::arg("limits"), py::arg("geometry"), py::kw_only(), py::arg("wanted"),
        py::arg("last"), py::arg("dt_s"), "`wanted`, as near as the limits allow, a time dt_s after `last`.");
}

void bind_guards(py::module_& m) {
  py::enum_<CommandVerdict> verdict(m, "CommandVerdict", "What became of a command.");
  verdict.value("accepted", CommandVerdict::accepted)
      .value("malformed", CommandVerdict::malformed)
      .value("base_session_wrong", CommandVerdict::base_session_wrong)
      .value("simulated", CommandVerdict::simulated)
      .value("replayed", CommandVerdict::replayed)
      .value("stale", CommandVerdict::stale)
      .value("expired", CommandVerdict::expired)
      .value("after_gap", CommandVerdict::after_gap)
      .value("session_ended", CommandVerdict::session_ended)
      .value("foreign", CommandVerdict::foreign)
      .value("sessions_full", CommandVerdict::sessions_full);
  py::enum_<LatchVerdict>(m, "LatchVerdict", "What became of a setpoint.")
      .value("stopped", LatchVerdict::stopped)
      .value("resumed", LatchVerdict::resumed)
      .value("already_running", LatchVerdict::already_running)
      .value("other_session", LatchVerdict::other_session)
      .value("replayed", LatchVerdict::replayed);
  bind_parameters<CommandGuardConfig>(m, "CommandGuardConfig", "How long a command, and a silent sender, count.");
  m.attr("SESSIONS") = CommandGuard::kSessions;
}

void bind_base(py::module_& m) {
  bind_parameters<SerialConfig>(m, "SerialConfig", "The line to the motor controller.");
  bind_parameters<BaseConfig>(m, "BaseConfig", "The wheels' process.");
  py::enum_<BaseState>(m, "BaseState", "What the wheels' process is doing.")
      .value("waiting", BaseState::waiting)
      .value("driving", BaseState::driving)
      .value("stopped", BaseState::stopped)
      .value("fault", BaseState::fault);
  py::class_<BaseOutput>(m, "BaseOutput", "The command for the wheels, and the reason for it.")
      .def_readonly("state", &BaseOutput::state, "BaseState: what the wheels' process is doing")
      .def_readonly("command", &BaseOutput::command, "Twist behind every limit; zero unless driving")
      .def_readonly("accepted_session", &BaseOutput::accepted_session, "0: none");
  py::class_<Base>(m, "Base", "Everything that decides the wheels' command; times are on a monotonic clock [us].")
      .def(py::init<const BaseConfig&, std::int64_t, bool>(), py::arg("config"), py::kw_only(), py::arg("session"),
           py::arg("simulated_allowed"),
           "session: this process's own, drawn at random, never 0; simulated_allowed: these are no real wheels.")
      .def(
          "command",
          [](Base& self, std::int64_t session, std::int64_t counter, std::int64_t base_session,
             std::int64_t valid_until_us, const Twist& twist, bool simulated, std::int64_t now_us,
             std::optional<std::int64_t> arrived_us) {
            return self.receive(ReceivedCommand{session, counter, base_session, {valid_until_us}, twist, simulated},
                                {arrived_us.value_or(now_us)}, {now_us});
          },
          py::kw_only(), py::arg("session"), py::arg("counter"), py::arg("base_session"), py::arg("valid_until_us"),
          py::arg("twist"), py::arg("simulated") = false, py::arg("now_us"), py::arg("arrived_us") = py::none(),
          "CommandVerdict of a command that reached this host at arrived_us [us] (by default now_us) and is handled "
          "at now_us. valid_until_us: its measurement is too old from then on; zeros need none.")
      .def(
          "setpoint",
          [](Base& self, std::int64_t session, std::int64_t counter, bool run, std::int64_t now_us) {
            return self.receive(ReceivedSetpoint{session, counter, run}, {now_us});
          },
          py::kw_only(), py::arg("session") = 0, py::arg("counter") = 0, py::arg("run"), py::arg("now_us"),
          "LatchVerdict of a setpoint: run=False latches a stop whoever says so; run=True must name the accepted "
          "session and a counter that rises.")
      .def("driver_works", &Base::driver_works, py::arg("works"), "The driver can or cannot be reached.")
      .def(
          "step", [](Base& self, std::int64_t now_us) { return self.step({now_us}); }, py::kw_only(), py::arg("now_us"),
          "BaseOutput for now_us [us]. Ask at every period, with every message, and at deadline_us.")
      .def_property_readonly(
          "deadline_us",
          [](const Base& self) -> std::optional<std::int64_t> {
            const auto deadline = self.deadline();
            return deadline ? std::optional(deadline->us) : std::nullopt;
          },
          "when step() must be asked again at the latest [us], because a command gets too old; None if nothing is "
          "accepted")
      .def_property_readonly("session", &Base::session,
                             "this process's own session, which commands name as base_session")
      .def_property_readonly("rejected", &Base::rejected, "what was refused, by name");
}

void bind_serial(py::module_& m) {
  m.attr("MAX_LINE") = kMaxLine;
  m.def(
      "crc8", [](const py::bytes& text) { return crc8(static_cast<std::string>(text)); }, py::arg("text"),
      "CRC-8 (polynomial 0x07, start 0) of the bytes, 0 to 255.");
  m.def(
      "set_point_line",
      [](std::uint16_t sequence, double left_radps, double right_radps) {
        return py::bytes(std::string(SetPointLine(sequence, {left_radps, right_radps}).text()));
      },
      py::kw_only(), py::arg("sequence"), py::arg("left_radps"), py::arg("right_radps"),
      "b\"$PFW,<sequence>,<left>,<right>*HH\\r\\n\": the line that sets the wheels' speeds [rad/s], positive: "
      "forwards; sent in mrad/s, what is not finite as zero.");
  m.def(
      "first_fault", [](std::uint16_t faults) { return std::string(first_fault(faults)); }, py::arg("faults"),
      "The name of the gravest of a controller's fault bits (ControllerLine.faults); empty: none.");
  py::class_<ControllerLine>(m, "ControllerLine", "What the controller says of the wheels.")
      .def_readonly("sequence", &ControllerLine::sequence,
                    "of the last good set-point line that the controller received")
      .def_readonly("faults", &ControllerLine::faults,
                    "bits: 1 watchdog, 2 motor, 4 overcurrent, 8 encoder, 16 supply, 32 emergency stop")
      .def_property_readonly(
          "time_ms", [](const ControllerLine& line) { return line.encoders.time_ms; },
          "the controller's clock [ms]; wraps around at 32 bits")
      .def_property_readonly(
          "left_ticks", [](const ControllerLine& line) { return line.encoders.left_ticks; },
          "encoder count of the left wheel; wraps around at 32 bits")
      .def_property_readonly(
          "right_ticks", [](const ControllerLine& line) { return line.encoders.right_ticks; },
          "encoder count of the right wheel; wraps around at 32 bits");
  py::class_<ControllerParser>(m, "ControllerParser", "Bytes in, lines out.")
      .def(py::init<>(), "Nothing received yet.")
      .def(
          "feed",
          [](ControllerParser& self, const py::bytes& bytes) {
            std::vector<ControllerLine> lines;
            for (const char byte : static_cast<std::string>(bytes))
              if (const auto line = self.feed(byte)) lines.push_back(*line);
            return lines;
          },
          py::arg("bytes"),
          "list of the ControllerLines that these bytes complete; what is no good line is counted in rejected.")
      .def_property_readonly(
          "rejected",
          [](const ControllerParser& self) {
            const ControllerParser::Rejected& rejected = self.rejected();
            return std::map<std::string, std::int64_t>{{"checksum", rejected.checksum},
                                                       {"malformed", rejected.malformed},
                                                       {"too_long", rejected.too_long},
                                                       {"cut_short", rejected.cut_short}};
          },
          "dict of lines refused: checksum, malformed, too_long, cut_short");
  py::class_<ControllerLink>(m, "ControllerLink", "Whether the motor controller receives our lines.")
      .def(py::init<double>(), py::kw_only(), py::arg("timeout_s"),
           "timeout_s [s]: so long an echo proves that the controller listens.")
      .def(
          "next_sequence", [](ControllerLink& self, std::int64_t now_us) { return self.next_sequence({now_us}); },
          py::kw_only(), py::arg("now_us"), "The number, 0 to 65535, for the line that is sent at now_us [us].")
      .def("echoed", &ControllerLink::echoed, py::arg("sequence"),
           "The controller says that this was the last good line.")
      .def(
          "alive", [](const ControllerLink& self, std::int64_t now_us) { return self.alive({now_us}); }, py::kw_only(),
          py::arg("now_us"), "True if a line sent within timeout_s before now_us [us] has been echoed.")
      .def("reset", &ControllerLink::reset, "Nothing has been echoed; numbers go on.");
}

}  // namespace

PYBIND11_MODULE(base, m) {
  py::module_::import("pilotfish.core");
  m.doc() = "The wheels' side: which session commands, what is allowed, what the motor controller receives.";
  bind_kinematics(m);
  bind_guards(m);
  bind_base(m);
  bind_serial(m);
  py::class_<config::BaseFile>(m, "BaseFile", "What pilotfish-base --config reads.")
      .def_readonly("name", &config::BaseFile::name, "the robot's name on the bus")
      .def_readonly("base", &config::BaseFile::base, "BaseConfig: limits, wheels, guards")
      .def_readonly("key_file", &config::BaseFile::key_file,
                    "for pilotfish.bus.load_key(); empty: nothing is authenticated")
      .def_property_readonly(
          "device", [](const config::BaseFile& file) { return file.driver.device; },
          "of the serial driver, e.g. /dev/ttyUSB0; empty with another driver");
  m.def("load_base", &config::load_base, py::arg("file"), py::call_guard<py::gil_scoped_release>(),
        "Throws ValueError naming the key.");

  add_reprs(m, {"BaseOutput", "ControllerLine", "BaseFile"});
}
