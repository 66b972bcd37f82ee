#include "cloudbow/app/command_line.hpp"

int main(int argc, char** argv) { return cloudbow::run_command_line(argc, argv); }
