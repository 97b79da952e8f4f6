// The TOML parser, compiled once: elsewhere its headers only declare it.
#define TOML_IMPLEMENTATION
#include <toml++/toml.h>
