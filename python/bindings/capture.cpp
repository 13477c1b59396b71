#include <pybind11/stl/filesystem.h>
#include <pybind11/typing.h>

#include "arrays.hpp"
#include "exclusive.hpp"
#include "pilotfish/capture/frame_source.hpp"

namespace py = pybind11;
using namespace pilotfish;
using namespace pilotfish::capture;
using python::exclusive;
using python::exclusive_unlocked;

PYBIND11_MODULE(capture, m) {
  m.doc() = "Camera, video file, image folder: sources of frames.";
  py::module_::import("pilotfish.core");

  py::register_exception<CaptureError>(m, "CaptureError", PyExc_OSError).doc() =
      "A source cannot be opened; the message says why and what to do.";

  py::class_<FrameSource>(m, "FrameSource", "Pictures, one after the other; iterate, or call next().")
      .def("next", exclusive_unlocked(&FrameSource::next),
           "The next Frame (0 x 0 if the picture cannot be decoded). None: it has ended, or it is live and none came "
           "within 0.25 s.")
      .def_property_readonly("ended", exclusive(&FrameSource::ended), "True if there will be no more frames")
      .def_property_readonly("why_ended", exclusive(&FrameSource::why_ended),
                             "A line for the log; empty while it has not")
      .def_property_readonly("live", exclusive(&FrameSource::live), "True if frames come whether or not anyone asks")
      .def("describe", exclusive(&FrameSource::describe), "One line for the log")
      .def("__iter__", [](const py::object& self) { return py::typing::Iterator<Frame>(self); })
      .def("__next__", exclusive([](FrameSource& source) {
             while (true) {
               std::optional<Frame> frame;
               {
                 const py::gil_scoped_release release;
                 frame = source.next();
               }
               if (frame) return *frame;
               if (source.ended()) throw py::stop_iteration();
               if (PyErr_CheckSignals() != 0) throw py::error_already_set();  // Ctrl-C while a camera is silent
             }
           }));

  py::list suffixes;
  for (const std::string_view suffix : kPictureSuffixes) suffixes.append(std::string(suffix));
  m.attr("PICTURE_SUFFIXES") = py::frozenset(suffixes);  // of the files that open_images() reads, in small letters
  m.def(
      "open_images",
      [](const std::filesystem::path& directory, double frame_rate_hz) {
        return open_images(directory.string(), frame_rate_hz);
      },
      "A folder of pictures in natural order of their names, or in the order and at the times of its frames.csv. "
      "Without it they come at frame_rate_hz [Hz]. CaptureError if there are none.",
      py::arg("directory"), py::kw_only(), py::arg("frame_rate_hz") = 30.0, py::call_guard<py::gil_scoped_release>());
  m.def(
      "open_video", [](const std::filesystem::path& path) { return open_video(path.string()); },
      "A video file; frames carry its timestamps [us]. CaptureError if it cannot be opened.", py::arg("path"),
      py::call_guard<py::gil_scoped_release>());
  m.def("open_camera", &open_camera,
        "A V4L camera by number, at the calibration's size: width and height [px], frame_rate_hz [Hz]. CaptureError if "
        "it cannot be opened.",
        py::arg("index"), py::kw_only(), py::arg("width"), py::arg("height"), py::arg("frame_rate_hz") = 30.0,
        py::call_guard<py::gil_scoped_release>());
}
