// A stranger's program on two of the shared libraries.
#include <cstdio>
#include <pilotfish/core/parameter.hpp>
#include <pilotfish/fuzzy/membership.hpp>
#include <pilotfish/vision/tag_family.hpp>

int main() {
  const pilotfish::fuzzy::MembershipFunction set = pilotfish::fuzzy::Triangle{0.0, 1.0, 2.0};
  std::printf("%.2f\n", membership(set, 0.5));  // half way up
  std::printf("%d\n", pilotfish::vision::TagFamily("tag36h11").size());
  try {
    pilotfish::vision::TagFamily("tag99h9");
  } catch (const pilotfish::ConfigError& error) {  // thrown in one library, caught by a type that all of them share
    std::printf("%s\n", error.key().c_str());
  }
}
