#include "pilotfish/config/yaml_section.hpp"

#include <algorithm>
#include <limits>
#include <string_view>
#include <utility>

#include "pilotfish/core/number.hpp"

namespace pilotfish::config {
namespace {

constexpr const char* kRadians = "_rad";

std::string shown(const YAML::Node& node) {
  if (node.IsNull()) return "nothing";
  return node.IsScalar() ? "'" + node.Scalar() + "'" : (node.IsSequence() ? "a list" : "a mapping");
}

/// "010": eight to a reader of YAML 1.1, ten to one of YAML 1.2.
bool may_be_octal(std::string_view text) {
  if (!text.empty() && (text[0] == '+' || text[0] == '-')) text.remove_prefix(1);
  return text.size() > 1 && text[0] == '0' && text.find_first_not_of("0123456789") == std::string_view::npos;
}

constexpr const char* kMayBeOctal = " may be meant as octal; write the decimal number without zeros in front";

/// What a file is by the keys at its top, for whoever named the wrong one; empty if that does not tell.
std::string kind_of(const YAML::Node& root) {
  const auto has = [&](const char* key) { return root[key].IsDefined(); };
  if (has("robots")) return "a scenario";
  if (has("camera") && has("leader")) return "a coordinator's configuration";
  if (has("rules")) return "a fuzzy controller";
  if (has("tags")) return "a leader's body";
  if (has("wheels")) return "a configuration of pilotfish-base";
  if (has("calibration") || has("image_width")) return "a camera calibration";
  return "";
}

/// What may be wrong with a text that should be a number: "; ..." or nothing.
std::string hint_for_number(std::string text) {
  if (const std::size_t comma = text.find(','); comma != std::string::npos) {
    text[comma] = '.';
    if (number_from<double>(text)) return "; a decimal point is '.'";
  }
  const std::size_t end = text.find_first_not_of("+-.0123456789");
  if (end == std::string::npos || end == 0 || !number_from<double>(text.substr(0, end))) return "";
  if (text[end] == 'e' || text[end] == 'E') return "; it is too large or too small, or not written as 1.5e3";
  return "; without a unit, which the key names";
}

/// yaml-cpp's mark of a scalar that was written in quotes (YAML 1.2, 6.9.1: the non-specific tag "!").
bool in_quotes(const YAML::Node& node) { return node.IsScalar() && node.Tag() == "!"; }

constexpr const char* kInQuotes = " is a text, because it stands in quotes; write it without them";

/// Decimal, the whole of it ("640abc" is none), or one of YAML's words for infinity and NaN.
double as_number(const YAML::Node& node, const YamlSection& section, const std::string& key) {
  if (!node.IsScalar()) throw section.error(key, shown(node) + " is not a number");
  if (in_quotes(node)) throw section.error(key, shown(node) + kInQuotes);
  const std::string& text = node.Scalar();
  if (may_be_octal(text)) throw section.error(key, shown(node) + kMayBeOctal);
  if (const auto value = number_from<double>(text)) return *value;
  const bool negative = !text.empty() && text[0] == '-';
  const std::string word = text.substr(!text.empty() && (negative || text[0] == '+') ? 1 : 0);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (word == ".inf" || word == ".Inf" || word == ".INF") return negative ? -kInfinity : kInfinity;
  if (word == ".nan" || word == ".NaN" || word == ".NAN") return std::numeric_limits<double>::quiet_NaN();
  throw section.error(key, shown(node) + " is not a number" + hint_for_number(text));
}

/// "x_deg" -> "x_rad": reading the one counts as reading the other.
std::string radians_key(const std::string& key) {
  const bool in_degrees = key.size() > 4 && key.compare(key.size() - 4, 4, "_deg") == 0;
  return in_degrees ? key.substr(0, key.size() - 3) + "rad" : std::string();
}

}  // namespace

YamlSection YamlSection::parse(const TextFile& file) {
  const YAML::Node root = parse_yaml(file.text, file.key, file.path);
  if (!root.IsMap()) throw ConfigError(file.key, file.path.string() + " is not a YAML mapping (key: value)");
  return {root, "", file.path};
}

YamlSection::YamlSection(const YAML::Node& node, std::string path, std::filesystem::path file)
    : node_(node), path_(std::move(path)), file_(std::move(file)) {}

bool YamlSection::is_angle(const std::string& key) {
  const std::string suffix = kRadians;
  return key.size() > suffix.size() && key.compare(key.size() - suffix.size(), suffix.size(), suffix) == 0;
}

std::string YamlSection::degrees_key(const std::string& key) {
  return is_angle(key) ? key.substr(0, key.size() - 3) + "deg" : std::string();
}

std::string YamlSection::dotted(const std::string& key) const { return pilotfish::dotted(path_, key); }

ConfigError YamlSection::error(const std::string& key, const std::string& problem) const {
  return {dotted(key), problem + " (in " + file_.string() + ")"};
}

bool YamlSection::has(const std::string& key) const { return !key.empty() && node_[key].IsDefined(); }

bool YamlSection::optional(const std::string& key) {
  asked_.insert(key);
  return has(key);
}

std::vector<std::string> YamlSection::keys() const {
  std::vector<std::string> result;
  for (const auto& entry : node_) result.push_back(entry.first.IsScalar() ? entry.first.Scalar() : "(not a text)");
  return result;
}

YAML::Node YamlSection::require(const std::string& key) {
  asked_.insert(key);
  if (has(key)) return node_[key];
  const std::string kind = path_.empty() ? kind_of(node_) : "";
  throw error(key, "is missing" + (kind.empty() ? kind : "; this file looks like " + kind));
}

double YamlSection::number(const std::string& key, double min, double max) {
  const YAML::Node node = require(key);
  const double value = as_number(node, *this, key);
  if (const auto problem = outside(value, min, max)) throw error(key, *problem);
  return value;
}

double YamlSection::angle(const std::string& key_rad, double min_rad, double max_rad) {
  const std::string key_deg = degrees_key(key_rad);
  if (has(key_rad) && has(key_deg)) throw error(key_deg, "is given in radians as well; keep one of the two");
  if (has(key_deg)) return radians(number(key_deg, degrees(min_rad), degrees(max_rad)));
  return number(key_rad, min_rad, max_rad);
}

int YamlSection::integer(const std::string& key, int min, int max) {
  const YAML::Node node = require(key);
  if (in_quotes(node)) throw error(key, shown(node) + kInQuotes);
  if (node.IsScalar() && may_be_octal(node.Scalar())) throw error(key, shown(node) + kMayBeOctal);
  const auto value = node.IsScalar() ? number_from<int>(node.Scalar()) : std::nullopt;
  if (!value) throw error(key, shown(node) + " is not a whole number");
  if (const auto problem = outside(*value, min, max)) throw error(key, *problem);
  return *value;
}

bool YamlSection::boolean(const std::string& key) {
  const YAML::Node node = require(key);
  if (in_quotes(node)) throw error(key, shown(node) + kInQuotes);
  bool value = false;
  if (!YAML::convert<bool>::decode(node, value)) throw error(key, shown(node) + " is not true or false");
  return value;
}

std::string YamlSection::text(const std::string& key) {
  const YAML::Node node = require(key);
  if (!node.IsScalar()) throw error(key, shown(node) + " is not a text");
  return node.Scalar();
}

std::vector<double> YamlSection::numbers(const std::string& key) {
  const YAML::Node node = require(key);
  if (!node.IsSequence()) throw error(key, shown(node) + " is not a list of numbers");
  std::vector<double> values;
  for (const YAML::Node& element : node) values.push_back(as_number(element, *this, key));
  return values;
}

std::vector<std::string> YamlSection::texts(const std::string& key) {
  const YAML::Node node = require(key);
  if (!node.IsSequence()) throw error(key, shown(node) + " is not a list");
  std::vector<std::string> values;
  for (const YAML::Node& element : node) {
    if (!element.IsScalar()) throw error(key, shown(element) + " is not a text");
    values.push_back(element.Scalar());
  }
  return values;
}

std::filesystem::path YamlSection::file_path(const std::string& key) {
  const std::filesystem::path path = text(key);
  return path.is_absolute() ? path : file_.parent_path() / path;
}

TextFile YamlSection::file(const std::string& key) { return read_text_file(file_path(key), dotted(key)); }

YamlSection YamlSection::section(const std::string& key) {
  const YAML::Node node = require(key);
  if (!node.IsMap()) throw error(key, shown(node) + " is not a mapping (key: value)");
  return {node, dotted(key), file_};
}

std::vector<YamlSection> YamlSection::sections(const std::string& key) {
  const YAML::Node node = require(key);
  if (!node.IsSequence()) throw error(key, shown(node) + " is not a list");
  std::vector<YamlSection> result;
  for (std::size_t i = 0; i < node.size(); ++i) {
    const std::string element = key + "[" + std::to_string(i) + "]";
    if (!node[i].IsMap()) throw error(element, shown(node[i]) + " is not a mapping (key: value)");
    result.emplace_back(node[i], dotted(element), file_);
  }
  return result;
}

Vector3 YamlSection::vector3(const std::string& key, double min, double max) {
  const std::vector<double> values = numbers(key);
  if (values.size() != 3) throw error(key, "needs three numbers, got " + std::to_string(values.size()));
  for (double value : values)
    if (const auto problem = outside(value, min, max)) throw error(key, *problem);
  return {values[0], values[1], values[2]};
}

void YamlSection::finish() const {
  std::set<std::string> seen;
  for (const auto& entry : node_) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "(not a text)";
    if (!seen.insert(key).second) throw error(key, "is given twice");
    if (asked_.count(key) != 0 || asked_.count(radians_key(key)) != 0) continue;
    std::string known;
    for (const std::string& asked : asked_) known += (known.empty() ? "" : ", ") + asked;
    throw error(key, "is not a known key here; known: " + known);
  }
}

}  // namespace pilotfish::config
