#include "pilotfish/vision/tag_family.hpp"

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
#include <new>
#include <stdexcept>
#include <string_view>

#include "pilotfish/core/parameter.hpp"

namespace pilotfish::vision {
namespace {

struct FamilyEntry {
  std::string_view name;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};

constexpr FamilyEntry kFamilies[] = {
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

/// image_u8_destroy(), which the header declares but Debian's library does not export.
void destroy_image(image_u8_t* image) {
  std::free(image->buf);
  std::free(image);
}

const FamilyEntry& find_family(const std::string& name) {
  for (const FamilyEntry& entry : kFamilies)
    if (entry.name == name) return entry;
  std::string known;
  for (const FamilyEntry& entry : kFamilies) known += (known.empty() ? "" : ", ") + std::string(entry.name);
  throw ConfigError("leader.family", "'" + name + "' is not a tag family; known are " + known);
}

}  // namespace

TagFamily::TagFamily(const std::string& name) : family_(find_family(name).create(), find_family(name).destroy) {
  if (!family_) throw std::bad_alloc();
}

int TagFamily::size() const { return static_cast<int>(family_->ncodes); }

int TagFamily::bits() const { return static_cast<int>(family_->nbits); }

int TagFamily::cells_at_border() const { return family_->width_at_border; }

TagBitmap TagFamily::bitmap(int id) const {
  if (id < 0 || id >= size())
    throw std::out_of_range(std::string(family_->name) + " has ids 0 to " + std::to_string(size() - 1) + ", not " +
                            std::to_string(id));
  const std::unique_ptr<image_u8_t, void (*)(image_u8_t*)> image(apriltag_to_image(get(), id), destroy_image);
  if (!image) throw std::bad_alloc();
  TagBitmap bitmap{image->width, {}};
  for (int row = 0; row < image->height; ++row) {
    const std::uint8_t* first = image->buf + static_cast<std::ptrdiff_t>(row) * image->stride;
    bitmap.pixels.insert(bitmap.pixels.end(), first, first + image->width);
  }
  return bitmap;
}

}  // namespace pilotfish::vision
