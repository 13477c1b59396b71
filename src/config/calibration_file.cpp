#include <fstream>
#include <iterator>
#include <pugixml.hpp>
#include <sstream>

#include "pilotfish/config/files.hpp"
#include "pilotfish/config/yaml_section.hpp"

namespace pilotfish::config {
namespace {

std::string read_text(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw ConfigError("calibration", "cannot read " + file.string());
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// OpenCV writes "%YAML:1.0", which is not a YAML directive; everything else in the file is YAML.
std::string without_directives(const std::string& text) {
  std::istringstream lines(text);
  std::string line, kept;
  while (std::getline(lines, line))
    if (line.empty() || line[0] != '%') kept += line + "\n";
  return kept;
}

/// OpenCV's calibration sample and ROS's camera_info share these keys; the many others they hold are theirs.
CameraModel from_opencv(const std::string& text, const std::filesystem::path& file) {
  YAML::Node root;
  try {
    root = YAML::Load(without_directives(text));
  } catch (const YAML::Exception& problem) {
    throw ConfigError("calibration", file.string() + " is not valid YAML: " + problem.what());
  }
  if (!root.IsMap()) throw ConfigError("calibration", file.string() + " is neither a mapping nor ViSP's XML");
  YamlSection section(root, "calibration", file);
  CameraModel camera;
  camera.width = section.integer("image_width", kMinFrameSide, kMaxFrameSide);
  camera.height = section.integer("image_height", kMinFrameSide, kMaxFrameSide);
  if (section.has("distortion_model") && section.text("distortion_model") != "plumb_bob")
    throw section.error("distortion_model",
                        "'" + section.text("distortion_model") + "' is not supported; plumb_bob is");
  const std::vector<double> matrix = section.section("camera_matrix").numbers("data");
  if (matrix.size() != 9) throw section.error("camera_matrix.data", "needs 9 numbers, row by row");
  camera.fx = matrix[0];
  camera.cx = matrix[2];
  camera.fy = matrix[4];
  camera.cy = matrix[5];
  const std::vector<double> distortion = section.section("distortion_coefficients").numbers("data");
  for (std::size_t i = 5; i < distortion.size(); ++i)
    if (distortion[i] != 0.0)
      throw section.error("distortion_coefficients",
                          "only k1, k2, p1, p2, k3 are supported; calibrate without "
                          "CALIB_RATIONAL_MODEL, CALIB_THIN_PRISM_MODEL, CALIB_TILTED_MODEL");
  double* const targets[] = {&camera.k1, &camera.k2, &camera.p1, &camera.p2, &camera.k3};
  for (std::size_t i = 0; i < std::min<std::size_t>(5, distortion.size()); ++i) *targets[i] = distortion[i];
  return camera;
}

double xml_number(const pugi::xml_node& parent, const char* key) {
  const pugi::xml_node node = parent.child(key);
  if (!node) throw ConfigError(std::string("calibration.") + key, "is missing in the XML");
  std::istringstream text(node.text().get());
  double value = 0.0;
  if (!(text >> value))
    throw ConfigError(std::string("calibration.") + key, "'" + std::string(node.text().get()) + "' is not a number");
  return value;
}

/// ViSP's perspectiveProjWithDistortion is u = u0 + px x (1 + kud r^2): our k1. (kdu is the approximate inverse, which
/// we do not need.)
CameraModel from_visp(const std::string& text, const std::filesystem::path& file) {
  pugi::xml_document document;
  if (const pugi::xml_parse_result parsed = document.load_string(text.c_str()); !parsed)
    throw ConfigError("calibration", file.string() + " is not valid XML: " + parsed.description());
  pugi::xml_node camera_node;
  for (const pugi::xml_node& node : document.document_element().children("camera")) {
    if (camera_node) throw ConfigError("calibration.camera", file.string() + " holds several cameras; keep one");
    camera_node = node;
  }
  if (!camera_node) throw ConfigError("calibration.camera", "no <camera> in " + file.string());
  CameraModel camera;
  camera.width = static_cast<int>(xml_number(camera_node, "image_width"));
  camera.height = static_cast<int>(xml_number(camera_node, "image_height"));
  pugi::xml_node best;
  for (const pugi::xml_node& model : camera_node.children("model")) {
    const std::string type = model.child("type").text().get();
    if (type == "perspectiveProjWithDistortion") best = model;
    if (type == "perspectiveProjWithoutDistortion" && !best) best = model;
  }
  if (!best)
    throw ConfigError("calibration.model",
                      "no perspectiveProjWithDistortion or perspectiveProjWithoutDistortion in " + file.string());
  camera.fx = xml_number(best, "px");
  camera.fy = xml_number(best, "py");
  camera.cx = xml_number(best, "u0");
  camera.cy = xml_number(best, "v0");
  if (best.child("kud")) camera.k1 = xml_number(best, "kud");
  return camera;
}

}  // namespace

CameraModel load_calibration(const std::filesystem::path& file) {
  const std::string text = read_text(file);
  const std::size_t first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  const bool is_xml = first != std::string::npos && text[first] == '<';
  const CameraModel camera = is_xml ? from_visp(text, file) : from_opencv(text, file);
  camera.validate();
  return camera;
}

}  // namespace pilotfish::config
