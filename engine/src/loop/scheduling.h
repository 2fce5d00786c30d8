// Which processors the calling thread may use, and how it stands before others.
#pragma once

#include <span>

namespace lumbrical {

/// False: not permitted, or there are no such processors.
bool stay_on(std::span<const int> cpus);

/// SCHED_FIFO. 0, or what pthread_setschedparam says.
int take_priority(int priority);

}  // namespace lumbrical
