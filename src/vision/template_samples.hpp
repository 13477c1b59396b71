#pragma once

#include <Eigen/Core>

#include "level_field.hpp"
#include "pilotfish/core/frame.hpp"
#include "pilotfish/vision/tag_pattern.hpp"
#include "tag_warp.hpp"

namespace pilotfish::vision {

/// Eight samples at once, which the compiler turns into SIMD instructions.
using Lanes = Eigen::Array<float, 8, 1>;

/// Pixels that are compared with the template, by column, so that eight of them can be taken at once.
struct TemplateSamples {
  static constexpr int kCapacity = 768;
  static constexpr int kNeighbours = 25;
  using Column = Eigen::Array<float, kCapacity, 1>;

  int count = 0;
  int reach = 1;                           ///< R: the template is known (2R + 1) x (2R + 1) cells around each sample
  Column gu, gv;                           ///< where the sample lies in the flat picture, see TagWarp
  Column gray;                             ///< [gray levels]
  bool inner_only = false;                 ///< no outer edges: the print may be cut close to them
  const LevelField* light = nullptr;       ///< if there is one: levels that differ from place to place
  Column black, white;                     ///< levels at the sample by `light` [gray levels]
  Column column_x, row_y;                  ///< middle of the sample's own cell, in tag coordinates
  std::array<Column, kNeighbours> colour;  ///< of the cells around it, row by row: 0 black, 1 white

  int lanes_begin(int block) const { return block * static_cast<int>(Lanes::SizeAtCompileTime); }
  int blocks() const { return (count + static_cast<int>(Lanes::SizeAtCompileTime) - 1) / Lanes::SizeAtCompileTime; }
};

/// Cells smaller than this are sampled pixel by pixel.
inline constexpr double kDenseBelow_px = 3.2;

/// Pixel by pixel a fit leaves so many times as much of what is not explained as by means of 3 x 3.
inline constexpr double kPixelResidual = 1.6;

/// A sample along edges is the mean of 3 x 3 pixels, weighted (1 2 1)/4 along rows and columns. Whatever shape a
/// camera's own blur has (square pixels, a digital sharpener), together with this it is nearly the Gaussian that the
/// fit assumes, and the sample carries the noise of a mean of seven pixels. It adds this variance to the blur along
/// rows and along columns.
inline constexpr double kSampleBlur_px2 = 0.5;

/// Samples on both sides of every edge of the template, at most `spread_px` from it, about `wanted` in all: only pixels
/// in the ramp of an edge determine its position.
void take_along_edges(const ImageView& image, const CameraModel& camera, const TagWarp& warp, const TagPattern& pattern,
                      double spread_px, int wanted, TemplateSamples& samples);

/// The pixels of a small tag, unsmoothed, and those around it as far as the white ring can be relied on: all of them,
/// or as many as there is room for, spread evenly.
void take_pixels(const ImageView& image, const CameraModel& camera, const TagWarp& warp, const TagPattern& pattern,
                 TemplateSamples& samples);

}  // namespace pilotfish::vision
