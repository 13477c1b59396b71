#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "pilotfish/api.hpp"

struct apriltag_family;  // libapriltag's, a C struct

PILOTFISH_API_BEGIN
namespace pilotfish::vision {

/// A tag as it is printed, one byte a cell (0 black, 255 white), row by row.
struct TagBitmap {
  int cells = 0;                     ///< per side, with everything that belongs to the tag
  std::vector<std::uint8_t> pixels;  ///< cells * cells bytes
};

/// One of libapriltag's families, owned: tag36h11, tag36h10, tag25h9, tag16h5, tagStandard41h12,
/// tagStandard52h13, tagCircle21h7, tagCircle49h12, tagCustom48h12.
class TagFamily {
 public:
  /// Throws ConfigError ("leader.family") on a name that is none of these.
  explicit TagFamily(const std::string& name);

  int size() const;             ///< ids run from 0 to size() - 1
  int bits() const;             ///< of one code
  int cells_at_border() const;  ///< side, in cells, of the square whose corners are detected and whose side is `size_m`
  /// Throws std::out_of_range on an id that the family does not have.
  TagBitmap bitmap(int id) const;

  apriltag_family* get() const { return family_.get(); }  ///< lives as long as this

 private:
  std::unique_ptr<apriltag_family, void (*)(apriltag_family*)> family_;
};

}  // namespace pilotfish::vision
PILOTFISH_API_END
