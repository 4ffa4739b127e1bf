#pragma once
// Records as Python has them: immutable, so that their arrays can be views and any thread
// may read them while others work on them.

#include <pybind11/pybind11.h>

#include <filesystem>
#include <map>
#include <string>

#include "mjdiag/signals/record.h"

namespace mjdiag::python {

/// A str or an os.PathLike. InputError begins with `what`.
std::filesystem::path PathOf(pybind11::handle path, const std::string& what);

/// Whether it is one.
bool IsPath(pybind11::handle object);

/// A package that may not be installed; ImportError beginning with `for_what`.
pybind11::object Library(const char* name, const std::string& for_what);

/// What was noted about a file, as warnings.
void Warn(const std::vector<std::string>& notes);

}  // namespace mjdiag::python
