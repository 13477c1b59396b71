#include "description.hpp"

#include <nlohmann/json.hpp>

#include "pilotfish/coordinator/leader_choice.hpp"
#include "pilotfish/core/number.hpp"

namespace pilotfish::config {
namespace {

using Json = nlohmann::ordered_json;
using Type = KeyDescription::Type;

constexpr std::size_t kMaxListed = kMaxLeaders - 1;

std::string range(const KeyDescription& key) {
  switch (key.type) {
    case Type::boolean: return "true, false";
    case Type::number:
    case Type::integer:
    case Type::vector3: return as_yaml(key.min) + " to " + as_yaml(key.max);
    case Type::text: break;
  }
  std::string choices;
  for (const std::string& choice : key.choices) choices += (choices.empty() ? "" : ", ") + choice;
  return choices.empty() ? "text" : choices;
}

bool is_angle(const std::string& key) { return key.size() > 4 && key.compare(key.size() - 4, 4, "_rad") == 0; }

Json schema_of(const KeyDescription& key, double scale) {
  Json schema;
  const auto number = [&](const char* type) {
    return Json{{"type", type}, {"minimum", key.min * scale}, {"maximum", key.max * scale}};
  };
  switch (key.type) {
    case Type::number: schema = number("number"); break;
    case Type::integer: schema = number("integer"); break;
    case Type::boolean: schema = {{"type", "boolean"}}; break;
    case Type::vector3:
      schema = {{"type", "array"}, {"items", number("number")}, {"minItems", 3}, {"maxItems", 3}};
      break;
    case Type::text: schema = {{"type", "string"}}; break;
  }
  if (!key.choices.empty()) schema["enum"] = key.choices;
  schema["description"] = key.text;
  // The default as the value that it is; in degrees, it would be rounded.
  if (scale == 1.0 && !key.required && !key.fallback.empty())
    schema["default"] = key.type == Type::text ? Json(key.fallback) : Json::parse(key.fallback);
  return schema;
}

Json empty_object() { return {{"type", "object"}, {"properties", Json::object()}, {"additionalProperties", false}}; }

Json list_of(const Json& items) {
  return {{"type", "array"}, {"items", items}, {"minItems", 0}, {"maxItems", kMaxListed}};
}

/// The object that a dotted path names, made where it is not there yet; after "name[]", one element of that list.
Json& object_at(Json& root, const std::string& path) {
  Json* object = &root;
  std::istringstream parts(path);
  for (std::string part; std::getline(parts, part, '.');) {
    Json& properties = (*object)["properties"];
    const bool list = part.size() > 2 && part.compare(part.size() - 2, 2, "[]") == 0;
    if (list) part.resize(part.size() - 2);
    if (!properties.contains(part)) properties[part] = list ? list_of(empty_object()) : empty_object();
    object = list ? &properties[part]["items"] : &properties[part];
  }
  return *object;
}

}  // namespace

void describe_law(ConfigDescription& description, const control::LawDescription& law) {
  SectionDescription section{"control." + law.name, law.text + ".", {}};
  for (const control::LawParameter& each : law.parameters)
    section.keys.push_back({each.key, Type::number, as_yaml(each.value), each.min, each.max, each.text, false, {}});
  description.push_back(std::move(section));
}

std::string as_markdown(const ConfigDescription& description) {
  std::ostringstream out;
  for (const SectionDescription& section : description) {
    out << "\n## " << (section.path.empty() ? "Top level" : "`" + section.path + "`") << "\n\n";
    if (!section.text.empty()) out << section.text << "\n\n";
    out << "| key | default | range | meaning |\n|---|---|---|---|\n";
    for (const KeyDescription& key : section.keys)
      out << "| `" << key.key << "` | " << (key.required ? "required" : key.fallback) << " | " << range(key) << " | "
          << key.text << " |\n";
  }
  return out.str();
}

std::string as_json_schema(const std::string& title, const ConfigDescription& description) {
  Json root = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", title}};
  root.update(empty_object());
  for (const SectionDescription& section : description)
    for (const KeyDescription& key : section.keys) {
      const std::size_t dot = key.key.rfind('.');
      const std::string below = dot == std::string::npos ? "" : key.key.substr(0, dot);
      const std::string path =
          section.path.empty() || below.empty() ? section.path + below : dotted(section.path, below);
      const std::string name = key.key.substr(dot == std::string::npos ? 0 : dot + 1);
      Json& object = object_at(root, path);
      object["properties"][name] = schema_of(key, 1.0);
      if (is_angle(name)) object["properties"][name.substr(0, name.size() - 3) + "deg"] = schema_of(key, degrees(1.0));
      if (key.required) object["required"].push_back(name);
    }
  return root.dump(2) + "\n";
}

}  // namespace pilotfish::config
