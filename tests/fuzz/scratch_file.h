// For readers that want a path: a folder of this process alone, in memory.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

/// Made at the first use, removed at the end of the process.
inline const std::filesystem::path& ScratchFolder() {
  struct Folder {
    std::filesystem::path path = "/dev/shm/coach-fuzz-" + std::to_string(getpid());
    Folder() { std::filesystem::create_directories(path); }
    ~Folder() {
      std::error_code error;
      std::filesystem::remove_all(path, error);
    }
  };
  static const Folder folder;
  return folder.path;
}

inline std::filesystem::path ScratchFile(const char* name, const uint8_t* data, size_t size) {
  const std::filesystem::path file = ScratchFolder() / name;
  std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  return file;
}
