#include "mjdiag/signals/mat_container.h"

#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

constexpr std::size_t kHeaderBytes = 128;
constexpr std::size_t kByteOrderMarkAt = 126;
constexpr std::size_t kTagBytes = 8;
constexpr std::uint32_t kMatrixElement = 14;
constexpr std::uint32_t kCompressedElement = 15;
/// MATLAB puts its text header into a user block of this size before the superblock.
constexpr std::size_t kSuperblockAt = 512;
constexpr std::string_view kHdf5Signature("\211HDF\r\n\032\n", 8);

class Bytes {
 public:
  explicit Bytes(const std::filesystem::path& file)
      : stream_(file, std::ios::binary | std::ios::ate),
        size_(stream_ ? static_cast<std::uint64_t>(stream_.tellg()) : 0) {}

  std::uint64_t size() const { return size_; }

  /// The bytes there, fewer than asked for at the end of the file.
  std::string Get(std::uint64_t at, std::size_t count) {
    std::string bytes(count, '\0');
    stream_.clear();
    stream_.seekg(static_cast<std::streamoff>(at));
    stream_.read(bytes.data(), static_cast<std::streamsize>(count));
    bytes.resize(static_cast<std::size_t>(stream_.gcount()));
    return bytes;
  }

 private:
  std::ifstream stream_;
  std::uint64_t size_;
};

[[noreturn]] void ThrowCutOff(const std::filesystem::path& file, std::uint64_t size,
                              const std::string& what) {
  throw InputError(file.string(),
                   "truncated MAT file, " + std::to_string(size) + " bytes", what);
}

[[noreturn]] void ThrowDamaged(const std::filesystem::path& file,
                               std::uint64_t position) {
  throw InputError(file.string(),
                   "damaged MAT file at byte " + std::to_string(position),
                   "a file that MATLAB can load");
}

std::uint32_t LittleEndian32(std::string_view bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) {
    value = value << 8 | static_cast<unsigned char>(bytes[i]);
  }
  return value;
}

std::uint64_t LittleEndian64(std::string_view bytes) {
  return LittleEndian32(bytes) |
         static_cast<std::uint64_t>(LittleEndian32(bytes.substr(4))) << 32;
}

std::uint32_t Reverse(std::uint32_t value) {
  return value >> 24 | (value >> 8 & 0xFF00U) | (value << 8 & 0xFF0000U) | value << 24;
}

void RequireCompleteMat5(const std::filesystem::path& file, Bytes& bytes) {
  const std::uint64_t size = bytes.size();
  const std::string header = bytes.Get(0, kHeaderBytes);
  if (header.size() < kHeaderBytes) {
    ThrowCutOff(file, size, "at least the header's 128");
  }
  const bool big_endian = header.compare(kByteOrderMarkAt, 2, "MI") == 0;
  std::uint64_t position = kHeaderBytes;
  while (position < size) {
    const std::string tag = bytes.Get(position, kTagBytes);
    if (tag.size() < kTagBytes) {
      ThrowCutOff(file, size, std::to_string(position + kTagBytes) + " or more");
    }
    std::uint32_t type = LittleEndian32(tag);
    std::uint32_t count = LittleEndian32(std::string_view(tag).substr(4));
    if (big_endian) {
      type = Reverse(type);
      count = Reverse(count);
    }
    if (type != kMatrixElement && type != kCompressedElement) {
      ThrowDamaged(file, position);
    }
    position += kTagBytes + count;
    if (position > size) {
      ThrowCutOff(file, size, std::to_string(position) + " or more");
    }
  }
}

/// Address of the end of the file in a superblock of 8-byte addresses.
std::uint64_t EndOfHdf5(std::string_view superblock) {
  const bool old_layout = superblock[8] < 2;
  return LittleEndian64(superblock.substr(old_layout ? 40 : 28));
}

void RequireCompleteMat73(const std::filesystem::path& file, Bytes& bytes) {
  constexpr std::size_t kSuperblockBytes = 48;
  const std::string superblock = bytes.Get(kSuperblockAt, kSuperblockBytes);
  if (superblock.size() < kSuperblockBytes) {
    ThrowCutOff(file, bytes.size(),
                std::to_string(kSuperblockAt + kSuperblockBytes) + " or more");
  }
  if (!superblock.starts_with(kHdf5Signature)) ThrowDamaged(file, kSuperblockAt);
  const std::uint64_t end = EndOfHdf5(superblock);
  if (end > bytes.size()) ThrowCutOff(file, bytes.size(), std::to_string(end));
}

}  // namespace

std::optional<MatVersion> DetectMatVersion(const std::filesystem::path& file) {
  const std::string header = Bytes(file).Get(0, kHeaderBytes);
  if (header.starts_with("MATLAB 7.3")) return MatVersion::k73;
  if (header.starts_with("MATLAB 5.0")) return MatVersion::k5;
  if (header.size() < kHeaderBytes) {
    return header.starts_with("MATLAB") ? std::optional(MatVersion::k5) : std::nullopt;
  }
  // Foreign writers put other text there; the last four bytes are fixed.
  const std::string_view mark = std::string_view(header).substr(kByteOrderMarkAt - 2);
  using std::string_view_literals::operator""sv;
  if (mark == "\x00\x01IM"sv || mark == "\x01\x00MI"sv) return MatVersion::k5;
  if (mark == "\x00\x02IM"sv || mark == "\x02\x00MI"sv) return MatVersion::k73;
  return std::nullopt;
}

void RequireCompleteMat(const std::filesystem::path& file, MatVersion version) {
  Bytes bytes(file);
  if (version == MatVersion::k5) {
    RequireCompleteMat5(file, bytes);
  } else {
    RequireCompleteMat73(file, bytes);
  }
}

}  // namespace mjdiag
