// Function of the module cloudbow_mpi, which uses MPI, for ranks.cpp.
#pragma once

#include <memory>

#include "cloudbow/core/ranks.hpp"

namespace cloudbow {

struct MpiModule {
  /// Starts MPI, for the processes of one launcher. The destructor ends it, when all have come to it.
  std::unique_ptr<Ranks> (*start)();
};

}  // namespace cloudbow

/// The module's one symbol.
extern "C" const cloudbow::MpiModule cloudbow_mpi_module;
