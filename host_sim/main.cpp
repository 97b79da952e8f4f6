#include <malloc.h>

#include "host_sim/commands/command_line.hpp"

int main(int argc, char** argv) {
#ifdef __GLIBC__
  // A diagnosis takes and gives back signals of a megabyte thousands of times. What goes back to the kernel comes
  // cleared, page by page: a tenth of the time.
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 512 << 20);
#endif
  return host_sim::run_command_line(argc, argv);
}
