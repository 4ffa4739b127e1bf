#pragma once
// OSMesa, loaded when the first picture is asked for: a machine without it can do all
// else, and is told in one line what is missing.

#include <GL/gl.h>
#include <GL/osmesa.h>

#include <string>
#include <vector>

namespace mjdiag {

struct OsMesaLibrary {
  decltype(&OSMesaCreateContextExt) create_context;
  decltype(&OSMesaMakeCurrent) make_current;
  decltype(&OSMesaDestroyContext) destroy_context;
  decltype(&glBindTexture) bind_texture;
  decltype(&glTexParameteri) set_texture_parameter;
};

/// Loads the first of the shared libraries that can be loaded, for all of the process,
/// which keeps it to its end. InputError if there is none, or if it lacks a function.
OsMesaLibrary LoadOsMesa(const std::vector<std::string>& names);

/// The one of this machine, loaded at the first call.
const OsMesaLibrary& OsMesa();

}  // namespace mjdiag
