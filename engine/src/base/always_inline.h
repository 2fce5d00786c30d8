// Marks what kernels of an instruction set take from elsewhere. Registers would be spilled round every call;
// and what is left as a function of its own could be the copy that the linker keeps for the whole program.
#pragma once

#define LUMBRICAL_INLINE __attribute__((always_inline))
