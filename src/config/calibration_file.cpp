#include <algorithm>
#include <pugixml.hpp>
#include <sstream>
#include <string_view>

#include "pilotfish/config/files.hpp"
#include "pilotfish/config/yaml_section.hpp"
#include "pilotfish/core/number.hpp"

namespace pilotfish::config {
namespace {

/// OpenCV writes "%YAML:1.0", which is not a YAML directive; everything else in the file is YAML.
std::string without_directives(const std::string& text) {
  std::istringstream lines(text);
  std::string line, kept;
  while (std::getline(lines, line))
    if (line.empty() || line[0] != '%') kept += line + "\n";
  return kept;
}

/// fx 0 cx, 0 fy cy, 0 0 1: there is no place in our model for a skew, or for anything else.
void check_matrix(const std::vector<double>& matrix, const YamlSection& section) {
  if (matrix.size() != 9) throw section.error("camera_matrix.data", "needs 9 numbers, row by row");
  const auto must_be = [&](std::size_t i, double wanted, const char* what) {
    if (matrix[i] == wanted) return;
    std::ostringstream problem;
    problem << matrix[i] << " is not allowed for " << what << "; only " << wanted << " is";
    throw section.error("camera_matrix.data[" + std::to_string(i) + "]", problem.str());
  };
  must_be(1, 0.0, "the skew (pixels are rectangular)");
  for (std::size_t i : {std::size_t{3}, std::size_t{6}, std::size_t{7}}) must_be(i, 0.0, "this element");
  must_be(8, 1.0, "the last element");
}

/// The numbers of a matrix that OpenCV or ROS has written: the size that stands beside them is theirs. Neither has
/// more than 14 of distortion.
std::vector<double> matrix_numbers(YamlSection matrix) {
  constexpr int kLongest = 14;
  std::vector<double> numbers = matrix.numbers("data");
  if (!matrix.has("rows") && !matrix.has("cols")) return numbers;
  const int rows = matrix.integer("rows", 0, kLongest), columns = matrix.integer("cols", 0, kLongest);
  if (static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns) != numbers.size())
    throw matrix.error("data", "holds " + std::to_string(numbers.size()) + " numbers, not the " +
                                   std::to_string(rows * columns) + " of rows: " + std::to_string(rows) +
                                   " and cols: " + std::to_string(columns));
  return numbers;
}

/// By the names that ROS gives them in its camera_info.
Lens lens_from(YamlSection& section) {
  const std::string name = section.text("distortion_model");
  if (name == "plumb_bob") return Lens::brown_conrady;
  if (name == "equidistant") return Lens::kannala_brandt;
  throw section.error("distortion_model",
                      "'" + name +
                          "' is not supported; plumb_bob is (k1, k2, p1, p2, k3), and equidistant (a fisheye: "
                          "k1, k2, k3, k4)");
}

/// OpenCV's calibration sample and ROS's camera_info share these keys; the many others they hold are theirs.
CameraModel from_opencv(const std::string& text, const std::filesystem::path& file) {
  const YAML::Node root = parse_yaml(without_directives(text), "calibration", file);
  if (!root.IsMap()) throw ConfigError("calibration", file.string() + " is neither a mapping nor ViSP's XML");
  YamlSection section(root, "calibration", file);
  CameraModel camera;
  camera.width = section.integer("image_width", kMinFrameSide, kMaxFrameSide);
  camera.height = section.integer("image_height", kMinFrameSide, kMaxFrameSide);
  if (section.has("distortion_model")) camera.lens = lens_from(section);
  const std::vector<double> matrix = matrix_numbers(section.section("camera_matrix"));
  check_matrix(matrix, section);
  if (section.has("readout_s")) camera.readout_s = section.number("readout_s", 0.0, CameraModel::kMaxReadout_s);
  camera.fx = matrix[0];
  camera.cx = matrix[2];
  camera.fy = matrix[4];
  camera.cy = matrix[5];
  const std::vector<double> distortion = matrix_numbers(section.section("distortion_coefficients"));
  if (camera.lens == Lens::kannala_brandt) {
    if (distortion.size() != 4)
      throw section.error(
          "distortion_coefficients",
          "needs the four numbers k1, k2, k3, k4 of an equidistant lens, has " + std::to_string(distortion.size()));
    double* const of_a_fisheye[] = {&camera.k1, &camera.k2, &camera.k3, &camera.k4};
    for (std::size_t i = 0; i < distortion.size(); ++i) *of_a_fisheye[i] = distortion[i];
    return camera;
  }
  for (std::size_t i = 5; i < distortion.size(); ++i)
    if (distortion[i] != 0.0)
      throw section.error("distortion_coefficients",
                          "only k1, k2, p1, p2, k3 are supported; calibrate without "
                          "CALIB_RATIONAL_MODEL, CALIB_THIN_PRISM_MODEL, CALIB_TILTED_MODEL");
  double* const targets[] = {&camera.k1, &camera.k2, &camera.p1, &camera.p2, &camera.k3};
  for (std::size_t i = 0; i < std::min<std::size_t>(5, distortion.size()); ++i) *targets[i] = distortion[i];
  return camera;
}

template <class Value>
Value xml_number(const pugi::xml_node& parent, const char* key) {
  const pugi::xml_node node = parent.child(key);
  const std::string dotted = std::string("calibration.") + key;
  if (!node) throw ConfigError(dotted, "is missing in the XML");
  std::string_view text = node.text().get();
  constexpr std::string_view kSpace = " \t\r\n";
  text.remove_prefix(std::min(text.find_first_not_of(kSpace), text.size()));
  text = text.substr(0, text.find_last_not_of(kSpace) + 1);
  if (const auto value = number_from<Value>(text)) return *value;
  throw ConfigError(dotted,
                    "'" + std::string(text) + "' is not a " + (std::is_same_v<Value, int> ? "whole " : "") + "number");
}

/// ViSP's perspectiveProjWithDistortion is u = u0 + px x (1 + kud r^2): our k1. (kdu is the approximate inverse, which
/// we do not need.)
CameraModel from_visp(const std::string& text, const std::filesystem::path& file) {
  pugi::xml_document document;
  if (const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size()); !parsed)
    throw ConfigError("calibration", file.string() + " is not valid XML: " + parsed.description());
  pugi::xml_node camera_node;
  for (const pugi::xml_node& node : document.document_element().children("camera")) {
    if (camera_node) throw ConfigError("calibration.camera", file.string() + " holds several cameras; keep one");
    camera_node = node;
  }
  if (!camera_node) throw ConfigError("calibration.camera", "no <camera> in " + file.string());
  CameraModel camera;
  camera.width = xml_number<int>(camera_node, "image_width");
  camera.height = xml_number<int>(camera_node, "image_height");
  pugi::xml_node best;
  for (const pugi::xml_node& model : camera_node.children("model")) {
    const std::string type = model.child("type").text().get();
    if (type == "perspectiveProjWithDistortion") best = model;
    if (type == "perspectiveProjWithoutDistortion" && !best) best = model;
  }
  if (!best)
    throw ConfigError("calibration.model",
                      "no perspectiveProjWithDistortion or perspectiveProjWithoutDistortion in " + file.string());
  camera.fx = xml_number<double>(best, "px");
  camera.fy = xml_number<double>(best, "py");
  camera.cx = xml_number<double>(best, "u0");
  camera.cy = xml_number<double>(best, "v0");
  if (camera_node.child("readout_s")) camera.readout_s = xml_number<double>(camera_node, "readout_s");
  if (best.child("kud")) camera.k1 = xml_number<double>(best, "kud");
  return camera;
}

}  // namespace

CameraModel load_calibration(const std::filesystem::path& file) {
  return parse_calibration(read_text_file(file, "calibration"));
}

CameraModel parse_calibration(const TextFile& file) {
  const std::string& text = file.text;
  const std::size_t first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  const bool is_xml = first != std::string::npos && text[first] == '<';
  const CameraModel camera = is_xml ? from_visp(text, file.path) : from_opencv(text, file.path);
  camera.validate();
  return camera;
}

}  // namespace pilotfish::config
