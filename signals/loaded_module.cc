#include "mjdiag/signals/loaded_module.h"

#include <dlfcn.h>
#include <link.h>

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
  link_map* map = nullptr;
  const bool found = dladdr1(reinterpret_cast<const void*>(&FunctionOf), &own,
                             reinterpret_cast<void**>(&map), RTLD_DL_LINKMAP) != 0;
  // Of the program the loader knows no more than how it was called, which may be the name
  // of something else in the folder where it runs; it is listed without a name.
  const bool is_library = found && map != nullptr && *map->l_name != '\0';
  std::error_code ignored;
  return fs::canonical(is_library ? map->l_name : "/proc/self/exe", ignored)
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
