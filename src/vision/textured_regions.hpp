#pragma once

#include "pilotfish/core/bounded_vector.hpp"
#include "pilotfish/core/frame.hpp"
#include "search_region.hpp"

namespace pilotfish::vision {

/// Parts of a picture that a small tag can be in, the most promising first.
using TexturedRegions = BoundedVector<SearchRegion, 8>;

/// A tag with cells of a few pixels has edges everywhere: every tile of 4 x 4 pixels of it holds both colours, or the
/// ramp between them, which before ordinary backgrounds is rare - a long edge crosses tiles in a row, not in an area.
/// Returns the parts of the picture in which 3 x 3 tiles have a contrast of `min_contrast` gray levels, or more where
/// the picture is noisy, with room for a tag around them; at most a quarter of the picture in all. Never allocates.
TexturedRegions textured_regions(const ImageView& image, int min_contrast) noexcept;

}  // namespace pilotfish::vision
