// Google Benchmark's results say, too, which build they come of.
#include <benchmark/benchmark.h>

#include "origin.h"

namespace lumbrical::bench {
namespace {

bool add_origin() {
  for (const auto& [key, value] : build_origin()) benchmark::AddCustomContext(key, value);
  return true;
}

const bool added = add_origin();

}  // namespace
}  // namespace lumbrical::bench
