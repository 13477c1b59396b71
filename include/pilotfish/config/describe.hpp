#pragma once

#include <string>

namespace pilotfish::config {

/// Every key of the coordinator's file with default, range and text, as Markdown tables, made from the same parameter
/// tables that read and check the file. docs/configuration.md is this text; a test compares them.
std::string describe_config();

}  // namespace pilotfish::config
