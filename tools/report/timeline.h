// One trial on a line of time: phases; for every connection what was true, what was believed and what was announced;
// mistakes; what the robot said and did; the operator; how well each part was tracked.
#pragma once

#include <string>

#include "tools/report/session.h"
#include "tools/report/trials.h"

namespace coach {

/// An SVG picture, 1080 units wide.
std::string TimelineSvg(const Trial& trial, const Session& session);
/// What its signs mean, as HTML.
std::string TimelineLegend();

}  // namespace coach
