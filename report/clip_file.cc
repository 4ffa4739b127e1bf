#include "mjdiag/report/clip_file.h"

#include <array>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/quantity.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::uint64_t BigEndian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (const char byte : bytes) value = value << 8 | static_cast<unsigned char>(byte);
  return value;
}

/// The movie header of an MP4, a chain of boxes: size (4 bytes), type (4), and where
/// the size is 1 the real one in 8 bytes more. Checks that the chain ends with the
/// file.
std::string_view MovieHeader(const std::string& file, std::string_view bytes) {
  const auto refuse = [&](const std::string& what) {
    throw InputError(file, what, "a whole MP4 as mjdiag render writes it");
  };
  if (bytes.empty()) refuse("empty");
  if (bytes.size() < 8 || bytes.substr(4, 4) != "ftyp") refuse("not an MP4");
  std::string_view header;
  bool has_pictures = false;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::string_view rest = bytes.substr(at);
    std::uint64_t size =
        rest.size() < 8 ? rest.size() + 1 : BigEndian(rest.substr(0, 4));
    if (size == 1 && rest.size() >= 16) size = BigEndian(rest.substr(8, 8));
    if (size == 0) size = rest.size();
    if (size < 8 || size > rest.size()) {
      refuse("broken off or damaged at byte " + std::to_string(at));
    }
    if (rest.substr(4, 4) == "moov") header = rest.substr(0, size);
    if (rest.substr(4, 4) == "mdat") has_pictures = true;
    at += size;
  }
  if (header.empty() || !has_pictures) refuse("broken off: no movie in it");
  return header;
}

std::string CodecOf(std::string_view header) {
  for (const char* codec : {"avc1", "mp4v", "hvc1", "hev1", "vp09", "av01"}) {
    if (header.find(codec) != header.npos) return codec;
  }
  return "an unknown codec";
}

json ReadDescription(const fs::path& file) {
  if (!fs::exists(file)) return json::object();
  json description = json::parse(ReadTextFile(file), nullptr, false);
  if (description.is_object()) return description;
  throw InputError(file.string(), "broken off or damaged",
                   "what mjdiag render writes beside a clip");
}

std::string TextOf(const json& description, const char* key) {
  const auto found = description.find(key);
  return found != description.end() && found->is_string() ? found->get<std::string>()
                                                          : std::string();
}

/// 1.2 and 5000, not 1.20000 and 5.00e3.
std::string Plain(double value) {
  std::array<char, 32> digits{};
  std::snprintf(digits.data(), digits.size(), "%.6g", value);
  return digits.data();
}

/// "zeta_x = 1.2, coulomb_friction at X": what the second machine of the clip has.
std::string ChangesText(const json& description) {
  std::string text;
  for (const char* kind : {"faults", "effects"}) {
    const auto found = description.find(kind);
    if (found == description.end() || !found->is_array()) continue;
    for (const json& change : *found) {
      if (!change.is_object()) continue;
      const std::string name = TextOf(change, "name");
      text +=
          (text.empty() ? "" : ", ") + (name.empty() ? TextOf(change, "effect") : name);
      if (change.contains("value") && change["value"].is_number()) {
        text += " = " + Plain(change["value"]);
      }
      const std::string site = TextOf(change, "site");
      if (!site.empty()) text += " at " + site;
    }
  }
  return text;
}

std::string SpeedText(const json& description) {
  const auto speed = description.find("speed");
  if (speed == description.end() || !speed->is_number()) return "";
  const double times = speed->get<double>();
  if (!(times > 0.0)) return "";
  if (times == 1.0) return "; at real speed";
  return times < 1.0 ? "; " + FormatNumber(1.0 / times) + " times slower than real"
                     : "; " + FormatNumber(times) + " times faster than real";
}

/// "amplified 5000 times: r1, u3; 10 times: X".
std::string AmplificationText(const json& description) {
  const auto found = description.find("amplification");
  if (found == description.end() || !found->is_object()) return "";
  std::map<double, std::string, std::greater<>> joints;
  for (const auto& [joint, factor] : found->items()) {
    if (!factor.is_number() || factor == 1.0) continue;
    std::string& names = joints[factor];
    names += (names.empty() ? "" : ", ") + joint;
  }
  std::string text;
  for (const auto& [factor, names] : joints) {
    text += (text.empty() ? "; amplified " : "; ") + Plain(factor) + " times: " + names;
  }
  return text;
}

std::string Caption(const json& description) {
  const std::string setup = TextOf(description, "setup");
  const std::string changes = ChangesText(description);
  return (setup.empty() ? "The machine" : setup) +
         (changes.empty() ? "" : ", healthy and with " + changes) +
         SpeedText(description) + AmplificationText(description) + ".";
}

}  // namespace

std::optional<ClipFile> ReadClipOf(const fs::path& folder) {
  const fs::path file = folder / "clip.mp4";
  if (!fs::exists(file)) return std::nullopt;
  const json description = ReadDescription(folder / "render.json");
  ClipFile clip;
  clip.name = file.filename().string();
  clip.bytes = ReadTextFile(file);
  clip.codec = CodecOf(MovieHeader(file.string(), clip.bytes));
  clip.caption = Caption(description);
  clip.command = TextOf(description, "command");
  return clip;
}

}  // namespace mjdiag
