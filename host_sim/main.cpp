#include "host_sim/commands/command_line.hpp"

int main(int argc, char** argv) { return host_sim::run_command_line(argc, argv); }
