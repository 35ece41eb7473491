#include "common/bus/systemd_notify.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>

namespace coach {

bool NotifySystemd(const std::string& word) {
  const char* path = std::getenv("NOTIFY_SOCKET");
  sockaddr_un to{};
  if (!path || !path[0] || std::strlen(path) >= sizeof to.sun_path) return false;
  to.sun_family = AF_UNIX;
  std::strcpy(to.sun_path, path);
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + std::strlen(path));
  if (path[0] == '@') to.sun_path[0] = '\0';  // abstract socket
  const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return false;
  const bool sent =
      sendto(fd, word.data(), word.size(), MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&to), length) >= 0;
  close(fd);
  return sent;
}

std::optional<int64_t> WatchdogInterval() {
  const char* text = std::getenv("WATCHDOG_USEC");
  const int64_t interval = text ? std::atoll(text) : 0;
  if (interval <= 0) return std::nullopt;
  return interval;
}

}  // namespace coach
