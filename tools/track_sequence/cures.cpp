#include "tools/track_sequence/cures.h"

#include <functional>
#include <stdexcept>
#include <utility>

namespace coach {
namespace {

using Switch = std::pair<std::string, std::function<void(FullFilterOptions&)>>;

const std::vector<Switch>& Switches() {
  static const std::vector<Switch> switches{
      {"bodies", [](FullFilterOptions& o) { o.follow_bodies = false; }},
      {"contour",
       [](FullFilterOptions& o) {
         o.refinement.contour_points = o.body.refinement.contour_points = 0;
         o.search.contour = o.surface_search.contour = false;
       }},
      {"particles", [](FullFilterOptions& o) { o.particles = 0; }},
      {"rivals", [](FullFilterOptions& o) { o.test_rivals = false; }},
      {"links", [](FullFilterOptions& o) { o.link_probability = 2; }},
      {"collision", [](FullFilterOptions& o) { o.collision_cost = 0; }},
      {"camera", [](FullFilterOptions& o) { o.follow_camera = false; }},
      {"recovery", [](FullFilterOptions& o) { o.searches = 0; }},
      {"identities", [](FullFilterOptions& o) { o.exchange_margin = 1e9; }},
      {"surfaces", [](FullFilterOptions& o) { o.surface_search_period = 0; }},
  };
  return switches;
}

}  // namespace

const std::vector<std::string>& CureNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const Switch& s : Switches()) all.push_back(s.first);
    return all;
  }();
  return names;
}

FullFilterOptions Without(const std::string& cure, FullFilterOptions options) {
  std::string known;
  for (const auto& [name, leave_out] : Switches()) {
    if (name == cure) {
      leave_out(options);
      return options;
    }
    known += " " + name;
  }
  throw std::invalid_argument("cure: found " + cure + ", expected one of" + known);
}

ColourUse ColourUseByName(const std::string& name) {
  if (name == "input") return ColourUse::kInput;
  if (name == "observation") return ColourUse::kObservation;
  if (name == "fused") return ColourUse::kFusedPoses;
  throw std::invalid_argument("colour: found " + name + ", expected input, observation or fused");
}

}  // namespace coach
