#pragma once

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace pilotfish::apps {

/// Prints what was asked for (--help, --version), or what is wrong with the command line, with what may be meant. The
/// exit code: kOk or kUsage.
int answer_usage(const CLI::App& app, const CLI::ParseError& error);

}  // namespace pilotfish::apps
