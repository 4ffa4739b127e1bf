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

/// Variables of version 5: what they say of their size has to be backed by their bytes,
/// for matio makes room for it at once.
class Mat5Variables {
 public:
  Mat5Variables(const std::filesystem::path& file, Bytes& bytes, bool big_endian)
      : file_(file), bytes_(bytes), big_endian_(big_endian) {}

  /// Checks a matrix element. @param begin, end  of what is behind its tag
  void Check(std::uint64_t begin, std::uint64_t end) { CheckMatrix(begin, end, 0); }

 private:
  enum Type : std::uint32_t { kInt8 = 1, kInt32 = 5, kUint32 = 6 };
  enum Class : std::uint32_t { kCell = 1, kStruct = 2, kSparse = 5, kLastNumeric = 15 };
  static constexpr int kDeepest = 32;
  static constexpr std::uint64_t kMostDimensions = 16;

  /// A part of a matrix element: its tag has been read.
  struct Part {
    std::uint32_t type = 0;
    std::uint64_t begin = 0;  ///< of its data
    std::uint64_t size = 0;
    std::uint64_t next = 0;  ///< where the next one begins
  };

  std::uint32_t Number(std::string_view bytes) const {
    const std::uint32_t value = LittleEndian32(bytes);
    return big_endian_ ? Reverse(value) : value;
  }

  Part PartAt(std::uint64_t at, std::uint64_t end) {
    if (at > end || end - at < kTagBytes) ThrowDamaged(file_, at);
    const std::string tag = bytes_.Get(at, kTagBytes);
    const std::uint32_t first = Number(tag);
    Part part{first, at + kTagBytes, Number(std::string_view(tag).substr(4)), 0};
    part.next = part.begin + (part.size + 7) / 8 * 8;
    if (const std::uint32_t size = first >> 16; size > 0) {  // all of it in the tag
      if (size > 4) ThrowDamaged(file_, at);
      part = {first & 0xFFFFU, at + 4, size, at + kTagBytes};
    }
    if (part.size > end - part.begin) ThrowDamaged(file_, at);
    return part;
  }

  Part PartAt(std::uint64_t at, std::uint64_t end, std::uint32_t type) {
    const Part part = PartAt(at, end);
    if (part.type != type) ThrowDamaged(file_, at);
    return part;
  }

  /// Number of elements; at most as many as there are bytes.
  std::uint64_t Count(const Part& dimensions, std::uint64_t most) {
    if (dimensions.size < 8 || dimensions.size > 4 * kMostDimensions) {
      ThrowDamaged(file_, dimensions.begin);
    }
    const std::string bytes = bytes_.Get(dimensions.begin, dimensions.size);
    std::uint64_t count = 1;
    std::uint64_t all = 1;  // of those that are not 0
    for (std::size_t i = 0; i + 4 <= bytes.size(); i += 4) {
      const std::uint64_t one = Number(std::string_view(bytes).substr(i));
      count *= one;
      if (one > 0) all *= one;
      if (count > most || all > kMostWithoutBytes)
        ThrowDamaged(file_, dimensions.begin);
    }
    return count;
  }

  void CheckMatrix(std::uint64_t begin, std::uint64_t end, int depth) {
    if (depth > kDeepest) ThrowDamaged(file_, begin);
    if (begin == end) return;  // an empty one within another
    const Part flags = PartAt(begin, end, kUint32);
    if (flags.size != 8) ThrowDamaged(file_, begin);
    const std::string kinds = bytes_.Get(flags.begin, 8);
    const std::uint32_t kind = Number(kinds) & 0xFFU;
    if (kind == 0 || kind > kLastNumeric || kind == 3) return;  // objects, functions
    const Part dimensions = PartAt(flags.next, end, kInt32);
    const Part name = PartAt(dimensions.next, end, kInt8);
    const std::uint64_t rest = end > name.next ? end - name.next : 0;
    if (kind == kSparse && Number(std::string_view(kinds).substr(4)) > rest) {
      ThrowDamaged(file_, flags.begin);
    }
    const std::uint64_t count =
        Count(dimensions, kind == kSparse ? kMostWithoutBytes : rest);
    if (kind != kCell && kind != kStruct) CheckData(name.next, end);
    if (kind == kCell) CheckMatrices(count, name.next, end, depth);
    if (kind == kStruct) CheckStruct(count, name.next, end, depth);
  }

  /// Real and imaginary parts; of sparse ones where they stand, too.
  void CheckData(std::uint64_t at, std::uint64_t end) {
    while (at < end && end - at >= kTagBytes) at = PartAt(at, end).next;
  }

  void CheckStruct(std::uint64_t count, std::uint64_t at, std::uint64_t end,
                   int depth) {
    const Part length = PartAt(at, end, kInt32);
    if (length.size != 4) ThrowDamaged(file_, at);
    const std::uint32_t longest = Number(bytes_.Get(length.begin, 4));
    const Part names = PartAt(length.next, end, kInt8);
    if (longest == 0 || names.size % longest != 0) ThrowDamaged(file_, length.begin);
    CheckMatrices(count * (names.size / longest), names.next, end, depth);
  }

  void CheckMatrices(std::uint64_t count, std::uint64_t at, std::uint64_t end,
                     int depth) {
    for (; count > 0; --count) {
      const Part matrix = PartAt(at, end, kMatrixElement);
      CheckMatrix(matrix.begin, matrix.begin + matrix.size, depth + 1);
      at = matrix.next;
    }
  }

  /// Of arrays with nothing in them.
  static constexpr std::uint64_t kMostWithoutBytes = std::uint64_t{1} << 31;

  const std::filesystem::path& file_;
  Bytes& bytes_;
  bool big_endian_;
};

void RequireCompleteMat5(const std::filesystem::path& file, Bytes& bytes) {
  const std::uint64_t size = bytes.size();
  const std::string header = bytes.Get(0, kHeaderBytes);
  if (header.size() < kHeaderBytes) {
    ThrowCutOff(file, size, "at least the header's 128");
  }
  const bool big_endian = header.compare(kByteOrderMarkAt, 2, "MI") == 0;
  Mat5Variables variables(file, bytes, big_endian);
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
    const std::uint64_t begin = position + kTagBytes;
    position = begin + count;
    if (position > size) {
      ThrowCutOff(file, size, std::to_string(position) + " or more");
    }
    if (type == kMatrixElement) variables.Check(begin, position);
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
