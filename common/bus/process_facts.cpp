#include "common/bus/process_facts.h"

#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

namespace coach {
namespace {

template <class Clock>
int64_t Microseconds() {
  return std::chrono::duration_cast<std::chrono::microseconds>(Clock::now().time_since_epoch()).count();
}

std::set<std::string> SocketInodes() {
  std::set<std::string> inodes;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", error)) {
    const std::string target = std::filesystem::read_symlink(entry.path(), error).string();  // socket:[12345]
    if (target.rfind("socket:[", 0) == 0) inodes.insert(target.substr(8, target.size() - 9));
  }
  return inodes;
}

}  // namespace

std::string HostName() {
  char name[256] = "";
  gethostname(name, sizeof name - 1);
  return name[0] ? name : "localhost";
}

int64_t WallTime() { return Microseconds<std::chrono::system_clock>(); }
int64_t SteadyTime() { return Microseconds<std::chrono::steady_clock>(); }

int64_t ResidentBytes() {
  std::ifstream in("/proc/self/statm");
  int64_t total = 0, resident = 0;
  in >> total >> resident;
  return resident * sysconf(_SC_PAGESIZE);
}

int64_t SocketDrops() {
  const std::set<std::string> own = SocketInodes();
  std::ifstream in("/proc/self/net/udp");
  std::string line;
  std::getline(in, line);  // the head of the table
  int64_t drops = 0;
  while (std::getline(in, line)) {
    std::istringstream fields(line);
    std::string field, inode;
    for (int i = 0; i < 10 && fields >> field; ++i) inode = field;  // inode is the 10th
    if (!own.contains(inode)) continue;
    while (fields >> field) {  // drops is the last
    }
    drops += std::stoll(field);
  }
  return drops;
}

}  // namespace coach
