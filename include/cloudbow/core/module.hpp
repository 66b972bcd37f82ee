// Modules: parts of the program that are loaded when they are first needed. Their libraries take longer to load than
// many commands take.
#pragma once

#include <cstdint>
#include <string>

namespace cloudbow {

struct ModuleNeeds {
  std::string library;             ///< that the module uses, as messages name it
  std::string use;                 ///< of the module: "reads and writes OpenVDB files"
  std::uint64_t memory_bytes = 0;  ///< of the libraries, and of a small piece of their work
  std::uint64_t threads = 0;       ///< that they start, each with a stack
  /// Symbols are sought in the module's own libraries first. That is faster if there are many of them.
  bool own_symbols_first = false;
};

/// A symbol of a module, which stays loaded. The run path of the program leads to the module: in its build folder, or
/// in lib/cloudbow beside its bin/.
/// @param file name of the module without folder.
/// @throws InputError if it cannot be loaded, or if the limits of this process leave less memory than it needs. Such
/// libraries end the program, or never return, if they get no memory.
const void* load_module(const char* file, const char* symbol, const ModuleNeeds& needs);

}  // namespace cloudbow
