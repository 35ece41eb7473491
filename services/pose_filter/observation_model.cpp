#include "services/pose_filter/observation_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "services/pose_filter/observation_model.cpp"
// The first of these compiles this file once for each instruction set, so the order matters.
// clang-format off
#include <hwy/foreach_target.h>
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>
// clang-format on

#ifndef COACH_OBSERVATION_TERMS
#define COACH_OBSERVATION_TERMS
namespace coach {
/// What the kernels need of the options.
struct Terms {
  float tail;    ///< w / z_max
  float weight;  ///< 1 - w
  float lambda;  ///< 1/m
  bool full;
};
}  // namespace coach
#endif

HWY_BEFORE_NAMESPACE();
namespace coach {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, RenderedDepth::kPadding>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

/// Integral of the normal density to t, within 1.5e-7. [Abramowitz and Stegun 7.1.26]
/// @param gauss e^(-t^2 / 2)
HWY_INLINE V NormalIntegral(D d, V t, V gauss) {
  const V x = hn::Mul(hn::Abs(t), hn::Set(d, static_cast<float>(1 / std::numbers::sqrt2)));
  const V one = hn::Set(d, 1.0F);
  const V k = hn::Div(one, hn::MulAdd(hn::Set(d, 0.3275911F), x, one));
  V poly = hn::Set(d, 1.061405429F);
  poly = hn::MulAdd(poly, k, hn::Set(d, -1.453152027F));
  poly = hn::MulAdd(poly, k, hn::Set(d, 1.421413741F));
  poly = hn::MulAdd(poly, k, hn::Set(d, -0.284496736F));
  poly = hn::MulAdd(poly, k, hn::Set(d, 0.254829592F));
  const V upper = hn::Mul(hn::Mul(hn::Mul(poly, k), gauss), hn::Set(d, 0.5F));
  return hn::IfThenElse(hn::Lt(t, hn::Zero(d)), upper, hn::Sub(one, upper));
}

HWY_INLINE V Gauss(D d, V t) {
  const V limited = hn::Min(hn::Abs(t), hn::Set(d, 12.0F));
  return hn::Exp(d, hn::Mul(hn::Mul(limited, limited), hn::Set(d, -0.5F)));
}

struct Densities {
  V visible, occluded;
  M hidden;  ///< the reading is in front of the prediction
};

template <bool kFull>
HWY_INLINE Densities Evaluate(D d, const Terms& terms, const DepthEvidence& e, size_t at, V predicted) {
  const V tail = hn::Set(d, terms.tail);
  const V z = hn::LoadU(d, e.z.data() + at), inverse_sigma = hn::LoadU(d, e.inverse_sigma.data() + at);
  const V occluder = hn::LoadU(d, e.occluder.data() + at);
  const V t = hn::Mul(hn::Sub(predicted, z), inverse_sigma);
  const V gauss = Gauss(d, t);
  constexpr double kInverseRoot2Pi = 0.3989422804014327;
  const V peak = hn::Mul(inverse_sigma, hn::Set(d, terms.weight * static_cast<float>(kInverseRoot2Pi)));
  const V visible = hn::MulAdd(peak, gauss, tail);
  const M hidden = hn::Gt(t, hn::Set(d, 3.0F));
  if constexpr (kFull) {
    return {visible, hn::MulAdd(occluder, NormalIntegral(d, t, gauss), tail), hidden};
  } else {
    // The lower limit of the integral, Phi((-z + lambda sigma^2) / sigma), is 0 in single precision for every z that
    // counts as a reading.
    const V lambda = hn::Set(d, terms.lambda);
    const V shifted = hn::MulAdd(lambda, hn::LoadU(d, e.sigma.data() + at), t);
    const V integral = NormalIntegral(d, shifted, Gauss(d, shifted));
    const V truncation = hn::Sub(hn::Set(d, 1.0F), hn::Exp(d, hn::Neg(hn::Mul(lambda, predicted))));
    return {visible, hn::MulAdd(occluder, hn::Div(integral, truncation), tail), hidden};
  }
}

template <bool kFull, bool kMap>
double Sum(const Terms& terms, const DepthEvidence& e, const RenderedDepth& predicted, const float* map, float value) {
  const D d;
  const size_t lanes = hn::Lanes(d);
  const V one = hn::Set(d, 1.0F), empty = hn::Set(d, RenderedDepth::kEmpty), zero = hn::Zero(d);
  constexpr int kFactors = 8;  // each in 1e-4..1e4
  V sum = zero, product = one, occlusion = hn::Set(d, value);
  int factors = 0;
  const GridRectangle& area = predicted.area;
  for (int j = 0; j < area.height; ++j) {
    const float* row = predicted.row(j);
    const size_t first = static_cast<size_t>(area.y + j) * static_cast<size_t>(e.stride) + static_cast<size_t>(area.x);
    for (size_t x = 0; x < static_cast<size_t>(area.width); x += lanes) {
      const V depth = hn::LoadU(d, row + x);
      const M drawn = hn::Lt(depth, empty);
      if (hn::AllFalse(d, drawn)) continue;
      const M evidence = hn::And(drawn, hn::Gt(hn::LoadU(d, e.z.data() + first + x), zero));
      const Densities p = Evaluate<kFull>(d, terms, e, first + x, hn::IfThenElse(drawn, depth, one));
      if constexpr (kMap) occlusion = hn::LoadU(d, map + first + x);
      const V mixture = hn::MulAdd(occlusion, hn::Sub(p.occluded, p.visible), p.visible);
      const V ratio = hn::Mul(mixture, hn::LoadU(d, e.inverse_background.data() + first + x));
      const M counts = kFull ? hn::AndNot(p.hidden, evidence) : evidence;
      product = hn::Mul(product, hn::IfThenElse(counts, ratio, one));
      if (++factors == kFactors) {
        sum = hn::Add(sum, hn::Log(d, product));
        product = one;
        factors = 0;
      }
    }
  }
  sum = hn::Add(sum, hn::Log(d, product));
  return static_cast<double>(hn::GetLane(hn::SumOfLanes(d, sum)));
}

double LogLikelihood(const Terms& terms, const DepthEvidence& e, const RenderedDepth& predicted, const float* map,
                     float value) {
  if (terms.full) {
    return map ? Sum<true, true>(terms, e, predicted, map, value) : Sum<true, false>(terms, e, predicted, map, value);
  }
  return map ? Sum<false, true>(terms, e, predicted, map, value) : Sum<false, false>(terms, e, predicted, map, value);
}

void UpdateOcclusion(const Terms& terms, const DepthEvidence& e, const RenderedDepth& predicted, float* map) {
  const D d;
  const size_t lanes = hn::Lanes(d);
  const V one = hn::Set(d, 1.0F), empty = hn::Set(d, RenderedDepth::kEmpty), zero = hn::Zero(d);
  const GridRectangle& area = predicted.area;
  for (int j = 0; j < area.height; ++j) {
    const float* row = predicted.row(j);
    const size_t first = static_cast<size_t>(area.y + j) * static_cast<size_t>(e.stride) + static_cast<size_t>(area.x);
    for (size_t x = 0; x < static_cast<size_t>(area.width); x += lanes) {
      const V depth = hn::LoadU(d, row + x);
      const M drawn = hn::Lt(depth, empty);
      const M evidence = hn::And(drawn, hn::Gt(hn::LoadU(d, e.z.data() + first + x), zero));
      if (hn::AllFalse(d, evidence)) continue;
      const V safe = hn::IfThenElse(drawn, depth, one);
      const Densities p =
          terms.full ? Evaluate<true>(d, terms, e, first + x, safe) : Evaluate<false>(d, terms, e, first + x, safe);
      const V before = hn::LoadU(d, map + first + x);
      const V mixture = hn::MulAdd(before, hn::Sub(p.occluded, p.visible), p.visible);
      const V after = hn::Div(hn::Mul(before, p.occluded), mixture);
      hn::StoreU(hn::IfThenElse(evidence, after, before), d, map + first + x);
    }
  }
}

PointCounts Count(const DepthEvidence& e, const RenderedDepth& predicted) {
  const D d;
  const size_t lanes = hn::Lanes(d);
  const V empty = hn::Set(d, RenderedDepth::kEmpty), zero = hn::Zero(d), three = hn::Set(d, 3.0F);
  const GridRectangle& area = predicted.area;
  size_t drawn_count = 0, missing = 0, hidden = 0, beyond = 0;
  for (int j = 0; j < area.height; ++j) {
    const float* row = predicted.row(j);
    const size_t first = static_cast<size_t>(area.y + j) * static_cast<size_t>(e.stride) + static_cast<size_t>(area.x);
    for (size_t x = 0; x < static_cast<size_t>(area.width); x += lanes) {
      const V depth = hn::LoadU(d, row + x);
      const M drawn = hn::Lt(depth, empty);
      if (hn::AllFalse(d, drawn)) continue;
      const V z = hn::LoadU(d, e.z.data() + first + x);
      const M read = hn::And(drawn, hn::Gt(z, zero));
      const V t = hn::Mul(hn::Sub(depth, z), hn::LoadU(d, e.inverse_sigma.data() + first + x));
      drawn_count += hn::CountTrue(d, drawn);
      missing += hn::CountTrue(d, hn::AndNot(read, drawn));
      hidden += hn::CountTrue(d, hn::And(read, hn::Gt(t, three)));
      beyond += hn::CountTrue(d, hn::And(read, hn::Lt(t, hn::Neg(three))));
    }
  }
  return {static_cast<int>(drawn_count), static_cast<int>(drawn_count - missing - hidden - beyond),
          static_cast<int>(hidden), static_cast<int>(beyond), static_cast<int>(missing)};
}

}  // namespace HWY_NAMESPACE
}  // namespace coach
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace coach {

HWY_EXPORT(LogLikelihood);
HWY_EXPORT(UpdateOcclusion);
HWY_EXPORT(Count);

namespace {

Terms MakeTerms(const ObservationOptions& options, OcclusionForm form) {
  return {static_cast<float>(options.tail_weight / options.max_depth), static_cast<float>(1 - options.tail_weight),
          static_cast<float>(std::numbers::ln2 / options.half_length), form == OcclusionForm::kFull};
}

}  // namespace

ObservationModel::ObservationModel(const ObservationOptions& options, OcclusionForm form)
    : options_(options), form_(form) {}

void ObservationModel::Prepare(const cv::Mat& depth, double metres_per_unit, const PixelGrid& grid,
                               DepthEvidence& out) const {
  out.grid = grid;
  out.stride = grid.width;
  const size_t size = static_cast<size_t>(grid.width) * static_cast<size_t>(grid.height) + RenderedDepth::kPadding;
  for (auto* list : {&out.z, &out.sigma, &out.inverse_sigma, &out.occluder, &out.inverse_background}) {
    list->resize(size);
  }
  if (depth.empty()) {
    std::fill(out.z.begin(), out.z.end(), 0.0F);
    return;
  }
  if (out.table_metres_per_unit != metres_per_unit) {
    out.table_metres_per_unit = metres_per_unit;
    const double lambda = std::numbers::ln2 / options_.half_length;
    const auto last = static_cast<size_t>(std::clamp(std::ceil(options_.max_depth / metres_per_unit), 1.0, 65535.0));
    out.table.assign(last + 1, {});
    for (size_t raw = 1; raw <= last; ++raw) {
      const double z = std::min(options_.max_depth, static_cast<double>(raw) * metres_per_unit);
      if (z < kNearPlane) continue;
      const double sigma = Sigma(z);
      double occluder = (1 - options_.tail_weight) * lambda * std::exp(-lambda * z);
      if (form_ == OcclusionForm::kPaper) occluder *= std::exp(lambda * lambda * sigma * sigma / 2);
      const double background = options_.tail_weight / options_.max_depth + occluder;
      out.table[raw] = {static_cast<float>(z), static_cast<float>(sigma), static_cast<float>(1 / sigma),
                        static_cast<float>(occluder), static_cast<float>(1 / background)};
    }
  }
  const size_t last = out.table.size() - 1;
  size_t at = 0;
  for (int j = 0; j < grid.height; ++j) {
    const uint16_t* row = depth.ptr<uint16_t>(grid.ImageY(j));
    for (int i = 0; i < grid.width; ++i, ++at) {
      const auto& reading = out.table[std::min<size_t>(row[grid.ImageX(i)], last)];
      out.z[at] = reading.z;
      out.sigma[at] = reading.sigma;
      out.inverse_sigma[at] = reading.inverse_sigma;
      out.occluder[at] = reading.occluder;
      out.inverse_background[at] = reading.inverse_background;
    }
  }
}

double ObservationModel::LogLikelihood(const DepthEvidence& evidence, const RenderedDepth& predicted,
                                       const float* occlusion) const {
  return HWY_DYNAMIC_DISPATCH(LogLikelihood)(MakeTerms(options_, form_), evidence, predicted, occlusion, 0.0F);
}

double ObservationModel::LogLikelihood(const DepthEvidence& evidence, const RenderedDepth& predicted,
                                       float occlusion) const {
  return HWY_DYNAMIC_DISPATCH(LogLikelihood)(MakeTerms(options_, form_), evidence, predicted, nullptr, occlusion);
}

void ObservationModel::UpdateOcclusion(const DepthEvidence& evidence, const RenderedDepth& predicted,
                                       float* occlusion) const {
  HWY_DYNAMIC_DISPATCH(UpdateOcclusion)(MakeTerms(options_, form_), evidence, predicted, occlusion);
}

PointCounts CountPoints(const DepthEvidence& evidence, const RenderedDepth& predicted) {
  return HWY_DYNAMIC_DISPATCH(Count)(evidence, predicted);
}

}  // namespace coach
#endif  // HWY_ONCE
