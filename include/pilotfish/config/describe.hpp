#pragma once

#include <string>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::config {

/// Every key of the coordinator's file with default, range and text, as Markdown tables, made from the same parameter
/// tables that read and check the file. docs/configuration.md is this text; a test compares them.
std::string describe_config();
/// The same as a JSON schema (draft 2020-12), with which an editor completes and checks the file.
std::string describe_config_as_json_schema();

}  // namespace pilotfish::config
PILOTFISH_API_END
