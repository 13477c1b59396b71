#pragma once

#include <filesystem>
#include <string>

#include "pilotfish/api.hpp"
#include "pilotfish/fuzzy/rule_base.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::config {

/// A controller written in fuzzylite's language (FLL, as of fuzzylite 6 and pyfuzzylite 8): one engine of two inputs,
/// the error first and its change second, one output and one rule block. Not yet validated. Throws ConfigError with the
/// line for everything that is not supported, rather than ignore it: only Triangle, Trapezoid, Ramp, Rectangle,
/// Binary and Gaussian terms of height 1; Minimum, Maximum and Centroid; one rule without hedge, `or` or weight for
/// each cell. `default` and `lock-previous` may have any value (some rule fires for every input), and so may the
/// resolution of the centroid, which is exact here. Inputs saturate here, so `lock-range: false` passes only where that
/// changes nothing. file: for messages; key: what named it, for messages on the whole of it.
fuzzy::Controller read_fll(const std::string& text, const std::filesystem::path& file, const std::string& key = "file");

/// In FLL, with every digit: read_fll() gives the same controller. Throws ConfigError if a name is no FLL identifier.
std::string to_fll(const fuzzy::Controller& controller);

/// In the form of data/fuzzy/*.yaml, with every digit. There the variables are called E, EC and U, whatever their
/// names.
std::string to_yaml(const fuzzy::Controller& controller);

}  // namespace pilotfish::config
PILOTFISH_API_END
