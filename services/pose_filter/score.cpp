#include "services/pose_filter/score.h"

#include <algorithm>

namespace coach {

double Score::agreement() const { return open() > 0 ? static_cast<double>(inlier + no_reading) / open() : 0; }

Score& Score::operator+=(const Score& other) {
  log_likelihood += other.log_likelihood;
  covered += other.covered;
  hidden += other.hidden;
  inlier += other.inlier;
  see_through += other.see_through;
  wrong_colour += other.wrong_colour;
  no_reading += other.no_reading;
  return *this;
}

Score ScoreTile(const DepthTile& tile, const Observation& observation, const OwnerMap& owners, int part,
                uint8_t class_bit) {
  Score score;
  double sum = 0;
  const bool has_colour = observation.class_map != nullptr;
  for (int j = 0; j < tile.height; ++j) {
    const int y = tile.y0 + j * tile.step;
    for (int i = 0; i < tile.width; ++i) {
      const float d = tile.At(i, j);
      if (d == 0) continue;
      const int x = tile.x0 + i * tile.step;
      ++score.covered;
      const float other = owners.OtherDepth(x, y, part);
      if (other > 0 && other < d + 0.006f) {  // two surfaces are never in one place
        ++score.hidden;
        continue;
      }
      const float z = observation.Depth(x, y);
      const PixelEvidence e = JudgePixel(
          d, z, static_cast<float>(DepthSigma(d)), has_colour, observation.Classes(x, y) & class_bit,
          [&] { return observation.OnTable(x, y, z); }, [&] { return observation.LikelyDepth(x, y); });
      sum += e.log_likelihood;
      switch (e.verdict) {
        case PixelVerdict::kHidden:
          ++score.hidden;
          break;
        case PixelVerdict::kInlier:
          ++score.inlier;
          break;
        case PixelVerdict::kSeeThrough:
          ++score.see_through;
          break;
        case PixelVerdict::kWrongColour:
          ++score.wrong_colour;
          break;
        case PixelVerdict::kNoReading:
          ++score.no_reading;
          break;
      }
    }
  }
  score.log_likelihood = sum * tile.step * tile.step;
  return score;
}

double ShareOfClass(const std::vector<Eigen::Vector2i>& pixels, const Observation& observation, uint8_t class_bit) {
  const auto own = std::count_if(pixels.begin(), pixels.end(), [&](const Eigen::Vector2i& p) {
    return (observation.Classes(p.x(), p.y()) & class_bit) != 0;
  });
  return pixels.empty() ? 0 : static_cast<double>(own) / static_cast<double>(pixels.size());
}

}  // namespace coach
