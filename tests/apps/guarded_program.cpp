#include <stdexcept>
#include <string>

#include "guarded.hpp"

int main(int argc, char** argv) {
  return pilotfish::apps::guarded("program", [&] {
    const std::string what = argc > 1 ? argv[1] : "";
    if (what == "exception") throw std::runtime_error("no more paper");
    if (what == "number") throw 7;
    return 3;
  });
}
