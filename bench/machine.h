// What a table of times has to say of the machine.
#pragma once

#include <fstream>
#include <string>

namespace lumbrical::bench {

/// The processor's name and model number as Linux has them; "unknown" elsewhere.
inline std::string cpu_name() {
  std::ifstream file("/proc/cpuinfo");
  std::string name, model;
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (colon == std::string::npos) continue;
    if (name.empty() && line.starts_with("model name")) name = line.substr(colon + 2);
    if (model.empty() && line.starts_with("model\t")) model = line.substr(colon + 2);
  }
  return name.empty() ? "unknown" : name + ", model " + model;
}

}  // namespace lumbrical::bench
