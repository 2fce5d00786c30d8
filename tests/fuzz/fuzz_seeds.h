// What the makers of seeds share.
#pragma once

#include <filesystem>
#include <fstream>
#include <span>
#include <string>

namespace lumbrical::test {

inline void write(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

inline void write(const std::filesystem::path& path, const std::string& text) {
  write(path, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

}  // namespace lumbrical::test

/// Of Modbus, where that is built.
void write_modbus(const std::filesystem::path& folder);
