// Which build this is, for recordings and for reports of what differs between two.
#include <string>

#include "lumbrical/recording.h"

namespace lumbrical {

// Changes with tests/golden/golden_hashes.h, of which it is the hash; the test Golden.* says what it must be.
std::string_view arithmetic_version() { return "68e50284"; }

std::string build_text() {
  std::string text = "lumbrical " LUMBRICAL_VERSION;
#if defined(__clang__)
  text += ", clang " __clang_version__;
#elif defined(__GNUC__)
  text += ", gcc " __VERSION__;
#else
  text += ", unknown compiler";
#endif
  while (text.back() == ' ') text.pop_back();
#ifdef __OPTIMIZE__
  text += ", optimised";
#else
  text += ", not optimised";
#endif
#if defined(__x86_64__)
  return text + ", x86_64";
#elif defined(__aarch64__)
  return text + ", aarch64";
#elif defined(__wasm__)
  return text + ", WebAssembly";
#else
  return text + ", other processor";
#endif
}

}  // namespace lumbrical
