#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <vector>

#include "pilotfish/blackbox/black_box.hpp"
#include "pilotfish/jpeg/jpeg.hpp"

namespace py = pybind11;
using namespace pilotfish;
using blackbox::BlackBox;

namespace {

/// The end of a box waits for the disk, two seconds at most: other threads go on meanwhile.
struct Released {
  void operator()(BlackBox* box) const {
    const py::gil_scoped_release unlocked;
    delete box;
  }
};
using Holder = std::unique_ptr<BlackBox, Released>;

}  // namespace

PYBIND11_MODULE(blackbox, m) {
  for (const char* module : {"pilotfish.core", "pilotfish.coordinator"}) py::module_::import(module);
  m.doc() = "A bounded ring of files with everything that a replay of a run needs.";

  using Release = py::call_guard<py::gil_scoped_release>;
  py::class_<BlackBox, Holder>(m, "BlackBox", "Record each call of the coordinator right after it, in their order.")
      .def(py::init([](const config::BlackBoxConfig& config, const std::string& robot, const Coordinator& core,
                       const config::ConfigBundle& bundle, std::int64_t session, const std::string& command_line) {
             const py::gil_scoped_release unlocked;
             return Holder(new BlackBox(config, blackbox::Start{robot, session, command_line, bundle}, core));
           }),
           py::arg("config"), py::kw_only(), py::arg("robot"), py::arg("coordinator"), py::arg("bundle"),
           py::arg("session") = 0, py::arg("command_line") = "", "ValueError if nothing can be written there.")
      .def(
          "frame",
          [](BlackBox& box, std::int64_t utime, std::int64_t known_age_us, std::int64_t now_us,
             const StepResult& result, const Coordinator& core, bool coarse_search) {
            Frame frame;
            frame.utime = utime;
            frame.known_age_us = known_age_us;
            frame.coarse_search = coarse_search;
            box.frame(frame, {now_us}, result, core);
          },
          py::arg("utime"), py::arg("known_age_us"), py::arg("now_us"), py::arg("result"), py::arg("coordinator"),
          py::arg("coarse_search") = false, Release(),
          "Right after a step() with a frame exposed at utime [us] that arrived at now_us [us], known to be "
          "known_age_us [us] old then; result: StepResult; coordinator: after the call.")
      .def("setpoint", &BlackBox::setpoint, py::arg("setpoint"), py::arg("taken"), py::arg("coordinator"), Release(),
           "Right after set_setpoint(). taken: what the coordinator returned; coordinator: after the call.")
      .def("ego_motion", &BlackBox::ego_motion, py::arg("utime"), py::arg("twist"), py::arg("taken"),
           py::arg("coordinator"), Release(),
           "Right after set_ego_motion(utime, twist). taken: what the coordinator returned; coordinator: after the "
           "call.")
      .def("leader_intent", &BlackBox::leader_intent, py::arg("utime"), py::arg("twist"), py::arg("taken"),
           py::arg("coordinator"), Release(),
           "Right after set_leader_intent(utime, twist). taken: what the coordinator returned; coordinator: after "
           "the call.")
      .def(
          "sent",
          [](BlackBox& box, const HeldCommand& held, std::int64_t now_us, Reason missing, Status status, Reason reason,
             const Twist& command, std::int64_t session, std::int64_t counter) {
            box.sent(held, {now_us}, missing, {status, reason, command}, session, counter);
          },
          py::arg("held"), py::kw_only(), py::arg("now_us"), py::arg("missing"), py::arg("status"), py::arg("reason"),
          py::arg("command"), py::arg("session") = 0, py::arg("counter") = 0, Release(),
          "A command that was sent at now_us [us]: what the sender held, and what it knew to be missing, made this "
          "status, reason and command.")
      .def(
          "message",
          [](BlackBox& box, const std::string& channel, const py::bytes& data) {
            const std::string_view bytes = data;
            const py::gil_scoped_release unlocked;
            box.message(channel, bytes.data(), bytes.size());
          },
          py::arg("channel"), py::arg("data"), "A message as it went over the bus: its channel and its encoded bytes.")
      .def("picture", &BlackBox::picture, py::arg("frame"), Release(),
           "A picture that came raw; at picture_rate_hz it is kept as a JPEG of quality 95, for people.")
      .def_property_readonly(
          "written", [](const BlackBox& box) { return box.counters().written; },
          "events the operating system has taken")
      .def_property_readonly(
          "dropped", [](const BlackBox& box) { return box.counters().dropped; },
          "events that did not fit into the queue: the disk is too slow")
      .def_property_readonly(
          "lost", [](const BlackBox& box) { return box.counters().lost; }, "events the disk refused")
      .def_property_readonly(
          "files", [](const BlackBox& box) { return box.counters().files; }, "number of files begun")
      .def_property_readonly("trouble", &BlackBox::trouble, "the disk's last refusal, in words");

  m.def("program_description", &blackbox::program_description, "Only the same program gives the same bits.");
  m.def(
      "decode_jpeg",
      [](const py::bytes& data, int width, int height, std::int64_t utime) -> std::optional<Frame> {
        const std::string_view bytes = data;
        const py::gil_scoped_release unlocked;
        auto pixels = jpeg::decode(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), {width, height});
        if (!pixels) return std::nullopt;
        return Frame::from_pixels(utime, width, height, std::move(*pixels));
      },
      "The Frame that the coordinator made of that JPEG; None if it was refused.", py::arg("data"), py::kw_only(),
      py::arg("width"), py::arg("height"), py::arg("utime"));
}
