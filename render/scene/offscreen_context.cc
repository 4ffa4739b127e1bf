#include "mjdiag/render/scene/offscreen_context.h"

#include "mjdiag/render/scene/osmesa_library.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

constexpr int kDepthBits = 24;
constexpr int kStencilBits = 8;

[[noreturn]] void Refused(const char* what) {
  throw InputError("OSMesa", what, "a working libOSMesa (Debian package libosmesa6)");
}

}  // namespace

OffscreenContext::OffscreenContext()
    : context_(
          OsMesa().create_context(OSMESA_RGBA, kDepthBits, kStencilBits, 0, nullptr)) {
  if (context_ == nullptr) Refused("cannot create an OpenGL context");
  MakeCurrent();
}

OffscreenContext::~OffscreenContext() { OsMesa().destroy_context(context_); }

void OffscreenContext::MakeCurrent() {
  if (OsMesa().make_current(context_, default_framebuffer_.data(), GL_UNSIGNED_BYTE,
                            kSide, kSide) != GL_TRUE) {
    Refused("cannot make its OpenGL context current");
  }
}

}  // namespace mjdiag
