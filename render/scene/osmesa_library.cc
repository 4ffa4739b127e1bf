#include "mjdiag/render/scene/osmesa_library.h"

#include <dlfcn.h>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

[[noreturn]] void Missing(const std::string& what) {
  throw InputError("OSMesa", what, "libOSMesa (Debian package libosmesa6)");
}

std::string LastError() {
  const char* error = dlerror();
  return error == nullptr ? "cannot be loaded" : error;
}

template <typename Function>
void Find(void* library, const char* name, Function*& function) {
  function = reinterpret_cast<Function*>(dlsym(library, name));
  if (function == nullptr) Missing(LastError());
}

}  // namespace

OsMesaLibrary LoadOsMesa(const std::vector<std::string>& names) {
  void* library = nullptr;
  std::string refusal = "no name to look for";
  for (const std::string& name : names) {
    // MuJoCo looks its OpenGL functions up among the symbols of the whole process.
    library = dlopen(name.c_str(), RTLD_NOW | RTLD_GLOBAL);
    if (library != nullptr) break;
    refusal = LastError();
  }
  if (library == nullptr) Missing(refusal);
  OsMesaLibrary functions{};
  Find(library, "OSMesaCreateContextExt", functions.create_context);
  Find(library, "OSMesaMakeCurrent", functions.make_current);
  Find(library, "OSMesaDestroyContext", functions.destroy_context);
  Find(library, "glBindTexture", functions.bind_texture);
  Find(library, "glTexParameteri", functions.set_texture_parameter);
  return functions;
}

const OsMesaLibrary& OsMesa() {
  static const OsMesaLibrary library =
      LoadOsMesa({"libOSMesa.so", "libOSMesa.so.6", "libOSMesa.so.8"});
  return library;
}

}  // namespace mjdiag
