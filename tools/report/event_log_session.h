// A session from the reasoner's event log alone: one JSON object a line, as `event_log` of the station file keeps it.
#pragma once

#include <string>
#include <string_view>

#include "tools/report/session.h"

namespace coach {

/// Lines that can't be read are counted in Session::problems. The names of parts are not in such a log.
Session ParseEventLog(std::string_view text);

}  // namespace coach
