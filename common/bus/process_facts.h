// What the system knows about this process.
#pragma once

#include <cstdint>
#include <string>

namespace coach {

std::string HostName();
int64_t WallTime();       ///< us since 1970
int64_t SteadyTime();     ///< us of a clock that never jumps
int64_t ResidentBytes();  ///< memory in use
/// Datagrams the kernel threw away because a UDP socket of this process was full (/proc/net/udp).
int64_t SocketDrops();

}  // namespace coach
