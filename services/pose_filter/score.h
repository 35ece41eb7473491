// How well a part at a pose explains the image: the full observation model over the pixels that the part is predicted
// to cover.
#pragma once

#include "services/pose_filter/observation.h"
#include "services/pose_filter/owner_map.h"

namespace coach {

/// What one pixel says of a surface predicted at depth d.
enum class PixelVerdict { kHidden, kInlier, kSeeThrough, kWrongColour, kNoReading };

struct PixelEvidence {
  PixelVerdict verdict;
  float log_likelihood;  ///< nats, against the background
};

/// The full observation model of a pixel (tracking.md), with colour. A reading clearly nearer than the surface is
/// something in front and worth exactly 0. A pixel of another colour gets nothing for a matching depth: a hand holds a
/// part at the part's own depth; if it is a little nearer it is a finger on the part. What hides it can't be the table.
/// @param z reading, m, 0: none. @param on_table tells (lazily) whether the reading lies on the table. @param
/// has_colour whether colours are known at all. @param own_colour pixel is in the part's class.
/// @param likely_depth tells (lazily) what depth a pixel without a reading most likely has, m, 0: unknown.
template <typename OnTable, typename LikelyDepth>
inline PixelEvidence JudgePixel(float d, float z, float sigma, bool has_colour, bool own_colour,
                                const OnTable& on_table, const LikelyDepth& likely_depth) {
  constexpr float kDepthGain = 5.5f, kSeeThrough = -5.3f, kColourGain = 2.0f, kColourMiss = -2.0f, kFloor = 0.006f;
  const bool wrong = has_colour && !own_colour;
  if (z <= 0) {
    if (!has_colour) return {PixelVerdict::kNoReading, 0};
    if (!wrong) return {PixelVerdict::kNoReading, kColourGain};
    const float likely = likely_depth();
    return likely > 0 && likely < d - kFloor - 3 * sigma
               ? PixelEvidence{PixelVerdict::kHidden, 0}
               : PixelEvidence{PixelVerdict::kWrongColour, 0.5f * kColourMiss};
  }
  const float r = z - d, gate = kFloor + 3 * sigma;
  if (r < -gate)
    return on_table() ? PixelEvidence{PixelVerdict::kSeeThrough, kSeeThrough} : PixelEvidence{PixelVerdict::kHidden, 0};
  if (r > gate) return {PixelVerdict::kSeeThrough, kSeeThrough + (wrong ? kColourMiss : 0)};
  if (wrong)
    return r < -0.7f * sigma ? PixelEvidence{PixelVerdict::kHidden, 0}
                             : PixelEvidence{PixelVerdict::kWrongColour, kColourMiss};
  const float t = r / sigma, depth = kDepthGain - 0.5f * t * t;
  return {PixelVerdict::kInlier, (depth > kSeeThrough ? depth : kSeeThrough) + (has_colour ? kColourGain : 0)};
}

/// Pixels by what they say, and the sum. Counts are samples of the tile.
struct Score {
  double log_likelihood = 0;  ///< nats, over the samples, times step^2: as if every pixel had been looked at
  int covered = 0;            ///< samples inside the image where the part would be seen if nothing were in front
  int hidden = 0;             ///< something in front: another part or a measured surface
  int inlier = 0;             ///< measured where predicted, in the part's colour
  int see_through = 0;        ///< measured behind, or the table in front
  int wrong_colour = 0;       ///< at the right depth or without a reading, and of another colour
  int no_reading = 0;         ///< no depth, in the part's colour

  Score& operator+=(const Score& other);
  int open() const { return covered - hidden; }
  /// Share of the open samples that agree in depth (or have no reading) and in colour, 0..1.
  double agreement() const;
};

/// @param part index in the owner map, whose other parts may hide this one.
Score ScoreTile(const DepthTile& tile, const Observation& observation, const OwnerMap& owners, int part,
                uint8_t class_bit);

/// Share of pixels that are in a class, 0..1.
double ShareOfClass(const std::vector<Eigen::Vector2i>& pixels, const Observation& observation, uint8_t class_bit);

}  // namespace coach
