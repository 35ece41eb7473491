// The two words a service says to systemd (sd_notify's protocol, without the library).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace coach {

/// Sends e.g. "READY=1" to $NOTIFY_SOCKET. @returns false if there is no such socket or it does not take the word.
bool NotifySystemd(const std::string& word);

/// $WATCHDOG_USEC: the service is killed if "WATCHDOG=1" is not said this often, us.
std::optional<int64_t> WatchdogInterval();

}  // namespace coach
