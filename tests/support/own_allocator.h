// The program's own operator new and delete, which stand before the library's.
#pragma once

#include <atomic>

namespace lumbrical::test {

/// Asked before every allocation, of any thread, while there is one; false: there is no memory.
extern std::atomic<bool (*)()> may_allocate;

}  // namespace lumbrical::test
