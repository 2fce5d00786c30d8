// See version.h. The only file that knows the commit, so that a new one compiles nothing else.
#include "version.h"

#include "commit_generated.h"
#include "lumbrical/recording.h"

namespace lumbrical::tool {

std::string version_text() {
  return "lumbrical " LUMBRICAL_VERSION ", commit " LUMBRICAL_COMMIT ", arithmetic " +
         std::string(arithmetic_version());
}

}  // namespace lumbrical::tool
