#include "mjdiag/signals/loaded_module.h"

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>
#include <vector>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;

/// Of the program or library that this code was linked into.
fs::path OwnFolder() {
  Dl_info own{};
  std::error_code ignored;
  if (dladdr(reinterpret_cast<const void*>(&FunctionOf), &own) == 0) return {};
  // A program is named as it was called.
  const fs::path file = fs::canonical(own.dli_fname, ignored);
  return (file.empty() ? fs::read_symlink("/proc/self/exe", ignored) : file)
      .parent_path();
}

std::vector<fs::path> PlacesOf(const ModuleName& module) {
  if (const char* named = std::getenv(module.variable)) return {named};
  const fs::path own = OwnFolder();
  std::vector<fs::path> places = {own / module.file};
  for (fs::path above = own; above.has_relative_path(); above = above.parent_path())
    places.push_back(above / MJDIAG_LIBRARIES / "mjdiag" / module.file);
  places.push_back(fs::path(MJDIAG_INSTALLED_LIBRARIES) / "mjdiag" / module.file);
  return places;
}

std::string LastError() {
  const char* error = dlerror();
  return error == nullptr ? "cannot be loaded" : error;
}

}  // namespace

void* FunctionOf(const ModuleName& module, const std::string& needed) {
  const std::vector<fs::path> places = PlacesOf(module);
  for (const fs::path& file : places) {
    std::error_code ignored;
    if (!fs::exists(file, ignored)) continue;
    void* loaded =
        dlopen(file.c_str(), RTLD_NOW | (module.global ? RTLD_GLOBAL : RTLD_LOCAL));
    void* function = loaded == nullptr ? nullptr : dlsym(loaded, module.function);
    if (function == nullptr) throw InputError(file.string(), LastError(), needed);
    return function;
  }
  throw InputError(places.front().string(), "is not there", needed);
}

}  // namespace mjdiag
