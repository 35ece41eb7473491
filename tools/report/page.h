// A report as one HTML file that needs nothing else: no network, no script; printable.
#pragma once

#include <string>

#include "tools/report/report.h"

namespace coach {

std::string PageHtml(const Report& report);

}  // namespace coach
