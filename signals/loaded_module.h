#pragma once
// Modules: parts of mjdiag that are loaded when they are asked for, because what they link
// is large or not everywhere.

#include <string>

namespace mjdiag {

struct ModuleName {
  const char* file;      ///< "libmjdiag-mpi.so"
  const char* variable;  ///< of the environment, which names another file
  const char* function;  ///< of extern "C"
  /// Whether the libraries that it links are seen by all that is loaded later: some load
  /// parts of themselves, which look for names of the whole.
  bool global = false;
};

/// The function of a module: beside the program or library that this code is in, or where
/// an installation has it, from there or as it was configured. InputError if it is not
/// there, or cannot be loaded. @param needed  what the error says was expected
void* FunctionOf(const ModuleName& module, const std::string& needed);

}  // namespace mjdiag
