// Does the thread sanitizer see what our parallel work does? With "race" all pieces add to one number, which
// it must report; without, each writes slots of its own, which it must not. In the tsan preset only.
#include <chrono>
#include <cstdio>
#include <string_view>
#include <thread>
#include <vector>

#include "base/parallel.h"

int main(int count, char** words) {
  const bool races = count > 1 && std::string_view(words[1]) == "race";
  std::vector<std::size_t> slot(100);
  std::size_t sum = 0;
  lumbrical::parallel_pieces(slot.size(), 1, 4, [&](std::size_t piece, std::size_t, std::size_t) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));  // or one thread might do it all
    slot[piece] = piece;
    if (races) sum += piece;
  });
  for (const std::size_t number : slot) sum += number;
  std::printf("%zu\n", sum);
}
