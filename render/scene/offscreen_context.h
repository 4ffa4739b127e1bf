#pragma once
// An OpenGL context without a window: OSMesa renders on the processor, so pictures
// need neither a display nor a graphics card, and come out the same everywhere.
//
// MuJoCo looks its OpenGL functions up in whichever platform library the process has
// loaded. This one loads OSMesa, which must be the only such library.

#include <GL/osmesa.h>

#include <array>
#include <cstddef>

namespace mjdiag {

class OffscreenContext {
 public:
  /// Makes a context and makes it current. InputError if OSMesa is not there or
  /// refuses.
  OffscreenContext();
  ~OffscreenContext();
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;

  /// Several contexts may live in a thread: call this before using any GL object that
  /// belongs to this one. InputError if OSMesa refuses.
  void MakeCurrent();

 private:
  static constexpr int kSide = 8;  // of the unused default framebuffer [px]
  OSMesaContext context_;
  std::array<unsigned char, std::size_t{4} * kSide * kSide> default_framebuffer_{};
};

}  // namespace mjdiag
