// Parts of the trackers that can be left out or exchanged, by name, to measure what each brings.
#pragma once

#include <string>
#include <vector>

#include "services/pose_filter/full_filter.h"
#include "services/pose_filter/paper_filter.h"

namespace coach {

/// bodies, contour, particles, rivals, links, collision, camera, recovery, identities, surfaces.
const std::vector<std::string>& CureNames();

/// Options of the full mode without one of them. @throws std::invalid_argument for another name.
FullFilterOptions Without(const std::string& cure, FullFilterOptions options = {});

/// input (the paper's choice), observation or fused (its section IV-C). @throws std::invalid_argument for another name.
ColourUse ColourUseByName(const std::string& name);

}  // namespace coach
