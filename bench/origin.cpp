// See origin.h. The only file that knows the commit, so that a new one compiles nothing else.
#include "origin.h"

#include <array>
#include <cstdlib>

#include "commit_generated.h"
#include "lumbrical/recording.h"
#include "print.h"

namespace lumbrical::bench {

std::vector<std::pair<std::string, std::string>> build_origin() {
  std::vector<std::pair<std::string, std::string>> origin = {
      {"commit", LUMBRICAL_COMMIT}, {"arithmetic", std::string(arithmetic_version())}};
  if (std::getenv("LUMBRICAL_BENCH_QUICK") != nullptr) origin.emplace_back("quick", "yes");
  return origin;
}

std::string origin_words() {
  std::string words;
  for (const auto& [key, value] : build_origin()) words += (words.empty() ? "" : ", ") + key + " " + value;
  return words;
}

std::string origin_members() {
  std::string members;
  for (const auto& [key, value] : build_origin()) members += quoted(key) + ": " + quoted(value) + ", ";
  std::array<double, 3> load{};
  if (::getloadavg(load.data(), 3) == 3)
    members += print("\"load_avg\": [%.2f, %.2f, %.2f], ", load[0], load[1], load[2]);
  return members + "\n";
}

}  // namespace lumbrical::bench
