// Does the thread sanitizer see what our parallel work does? With "race" all chunks add to one number, which
// it must report; without, each writes a slot of its own, which it must not. Built and run in the tsan preset
// only.
#include <cstdio>
#include <string_view>
#include <vector>

#include "base/parallel.h"

int main(int count, char** words) {
  const bool races = count > 1 && std::string_view(words[1]) == "race";
  std::vector<std::size_t> slot(10000);
  std::size_t sum = 0;
  lumbrical::parallel_pieces(slot.size(), 10, 4, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      slot[i] = i;
      if (races) sum += i;
    }
  });
  for (const std::size_t number : slot) sum += number;
  std::printf("%zu\n", sum);
}
