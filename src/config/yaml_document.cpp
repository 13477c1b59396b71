#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <sstream>

#include "pilotfish/config/text_file.hpp"
#include "pilotfish/config/yaml_section.hpp"

// From a text to the one YAML document that it holds.

namespace pilotfish::config {
namespace {

/// yaml-cpp walks into a nested list for as long as it goes on (some 0.2 s per 100 kB) before it gives up at 500
/// levels; nothing here nests more than six deep. Brackets in comments and quotes count as well, which
/// makes no difference in practice.
constexpr int kMaxNesting = 64;

int deepest_bracket(const std::string& text) {
  int depth = 0, deepest = 0;
  for (const char c : text) {
    if (c == '[' || c == '{') deepest = std::max(deepest, ++depth);
    if ((c == ']' || c == '}') && depth > 0) --depth;
  }
  return deepest;
}

/// Takes no notice of what a document holds.
class Skip : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}
};

/// Is there more behind the first document? YAML::LoadAll would tell, but it goes on for ever where the parser stands
/// still: " ,\n%" is, to yaml-cpp 0.7, an empty document without end, and then another one.
bool goes_on(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  Skip skip;
  return parser.HandleNextDocument(skip) && parser.HandleNextDocument(skip);
}

}  // namespace

YAML::Node parse_yaml(const std::string& text, const std::string& key, const std::filesystem::path& path) {
  check_utf8(text, key, path);
  if (deepest_bracket(text) > kMaxNesting)
    throw ConfigError(key, path.string() + " is not valid YAML: brackets in brackets, more than " +
                               std::to_string(kMaxNesting) + " deep");
  try {
    YAML::Node node = YAML::Load(text);
    if (goes_on(text)) throw ConfigError(key, path.string() + " holds more than one YAML document (---)");
    return node;
  } catch (const YAML::Exception& problem) {
    const bool tab = text.find("\n\t") != std::string::npos;
    throw ConfigError(key, path.string() + " is not valid YAML: " + problem.what() +
                               (tab ? "; there are tabs in front of lines: indent with spaces" : ""));
  }
}

}  // namespace pilotfish::config
