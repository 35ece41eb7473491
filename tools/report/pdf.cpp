#include "tools/report/pdf.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace coach {
namespace {

namespace fs = std::filesystem;

constexpr auto kPatience = std::chrono::seconds(60);

fs::path Browser() {
  const char* path = std::getenv("PATH");
  for (const char* name : {"chromium", "chromium-browser", "google-chrome", "google-chrome-stable"}) {
    std::istringstream folders(path ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');) {
      const fs::path program = fs::path(folder) / name;
      if (access(program.c_str(), X_OK) == 0) return program;
    }
  }
  throw std::runtime_error("a PDF needs Chromium: sudo apt install chromium");
}

/// A folder that goes with its holder.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "coach-report-XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error(name + ": can't be made");
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::string FileUrl(const fs::path& file) {
  constexpr const char* kHex = "0123456789ABCDEF";
  std::string url = "file://";
  for (const char c : fs::absolute(file).string()) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) || std::string("/-_.~").find(c) != std::string::npos) {
      url += c;
    } else {
      url += {'%', kHex[byte >> 4], kHex[byte & 15]};
    }
  }
  return url;
}

int Run(std::vector<std::string> arguments) {
  std::vector<char*> argv;
  for (std::string& a : arguments) argv.push_back(a.data());
  argv.push_back(nullptr);
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("the browser can't be started");
  if (child == 0) {
    setpgid(0, 0);
    const int nothing = open("/dev/null", O_RDWR | O_CLOEXEC);
    for (const int stream : {0, 1, 2}) dup2(nothing, stream);
    execv(argv[0], argv.data());
    _exit(127);
  }
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > deadline) {
      kill(-child, SIGKILL);
      waitpid(child, &status, 0);
      throw std::runtime_error("the browser did not print the page within a minute");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

void PrintPdf(const fs::path& html, const fs::path& pdf) {
  const fs::path browser = Browser();
  const TemporaryFolder profile;
  fs::remove(pdf);
  std::vector<std::string> arguments{browser.string(),
                                     "--headless",
                                     "--disable-gpu",
                                     "--no-first-run",
                                     "--disable-background-networking",
                                     "--disable-dev-shm-usage",
                                     "--user-data-dir=" + profile.path().string(),
                                     "--no-pdf-header-footer",
                                     "--print-to-pdf-no-header",
                                     "--print-to-pdf=" + fs::absolute(pdf).string()};
  if (geteuid() == 0)
    arguments.push_back("--no-sandbox");  // Chromium refuses a sandbox to root; the page has no script
  arguments.push_back(FileUrl(html));
  const int status = Run(std::move(arguments));
  if (status != 0 || !fs::exists(pdf))
    throw std::runtime_error(pdf.string() + ": the browser could not print the page (exit code " +
                             std::to_string(status) + ")");
}

}  // namespace coach
