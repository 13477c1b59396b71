#include "tag_cells.hpp"

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagCircle49h12.h>
#include <apriltag/tagCustom48h12.h>
#include <apriltag/tagStandard41h12.h>
#include <apriltag/tagStandard52h13.h>

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>

#include "pilotfish/core/parameter.hpp"

namespace pilotfish::sim {
namespace {

// The renderer is the camera's opposite side and must not share code with vision/, which it is there to test;
// so the names of the families stand here once more.
struct Family {
  const char* name;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};
constexpr Family kFamilies[] = {
    {"tag36h11", tag36h11_create, tag36h11_destroy},
    {"tag36h10", tag36h10_create, tag36h10_destroy},
    {"tag25h9", tag25h9_create, tag25h9_destroy},
    {"tag16h5", tag16h5_create, tag16h5_destroy},
    {"tagStandard41h12", tagStandard41h12_create, tagStandard41h12_destroy},
    {"tagStandard52h13", tagStandard52h13_create, tagStandard52h13_destroy},
    {"tagCircle21h7", tagCircle21h7_create, tagCircle21h7_destroy},
    {"tagCircle49h12", tagCircle49h12_create, tagCircle49h12_destroy},
    {"tagCustom48h12", tagCustom48h12_create, tagCustom48h12_destroy},
};

const Family& find_family(const std::string& name) {
  std::string known;
  for (const Family& family : kFamilies) {
    if (name == family.name) return family;
    known += (known.empty() ? "" : ", ") + std::string(family.name);
  }
  throw ConfigError("leader.family", "'" + name + "' is not a family of tags; known: " + known);
}

/// image_u8_destroy() by hand: Debian's libapriltag does not export it.
void destroy(image_u8_t* image) {
  std::free(image->buf);
  std::free(image);
}

}  // namespace

std::vector<TagCells> tag_cells(const std::string& family, const std::vector<int>& ids) {
  const Family& entry = find_family(family);
  const std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)> tags(entry.create(), entry.destroy);
  if (!tags) throw std::bad_alloc();
  std::vector<TagCells> result;
  for (int id : ids) {
    if (id < 0 || id >= static_cast<int>(tags->ncodes))
      throw ConfigError("leader.tags", family + " has the ids 0 to " + std::to_string(tags->ncodes - 1) + ", not " +
                                           std::to_string(id));
    const std::unique_ptr<image_u8_t, void (*)(image_u8_t*)> image(apriltag_to_image(tags.get(), id), destroy);
    if (!image) throw std::bad_alloc();
    TagCells cells{image->width, tags->width_at_border, {}};
    for (int row = 0; row < image->height; ++row) {
      const std::uint8_t* first = image->buf + static_cast<std::ptrdiff_t>(row) * image->stride;
      cells.grays.insert(cells.grays.end(), first, first + image->width);
    }
    result.push_back(std::move(cells));
  }
  return result;
}

}  // namespace pilotfish::sim
