#include "mjdiag/render/scene/image.h"

#include <png.h>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag {

std::string EncodePng(const Image& image) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  png.flags = PNG_IMAGE_FLAG_FAST;  // a clip may have a thousand of them
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&png, bytes.data(), &size, 0, image.rgb.data(), 0,
                                nullptr) == 0) {
    throw NumericalError(std::string("picture: ") + png.message);
  }
  bytes.resize(size);
  return bytes;
}

void WritePng(const std::filesystem::path& file, const Image& image) {
  WriteTextFile(file, EncodePng(image));
}

}  // namespace mjdiag
