#include "mjdiag/studies/dataset/run_journal.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <boost/crc.hpp>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <utility>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/number_bytes.h"

namespace mjdiag {
namespace {

constexpr std::string_view kMagic = "mjdiag.journal/1\n";
constexpr std::uint32_t kMark = 0x6e75526d;  // "mRun"

struct Head {
  std::uint32_t mark = kMark;
  std::uint32_t checksum = 0;
  std::int64_t index = 0;
  std::uint64_t result = 0;
  std::uint64_t series = 0;
};
static_assert(sizeof(Head) == 32);

std::uint32_t Checksum(const Head& head, std::string_view body) {
  boost::crc_32_type crc;
  crc.process_bytes(&head.index, sizeof head - offsetof(Head, index));
  crc.process_bytes(body.data(), body.size());
  return crc.checksum();
}

std::string Text(const std::vector<std::string>& series) {
  std::string text;
  for (const std::string& one : series) {
    AppendBytes(static_cast<std::uint64_t>(one.size()), text);
    text += one;
  }
  return text;
}

/// False at the end of the file.
bool ReadAt(int descriptor, std::uint64_t offset, char* to, std::size_t size) {
  while (size > 0) {
    const ssize_t got = pread(descriptor, to, size, static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    to += got;
    offset += static_cast<std::uint64_t>(got);
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

bool WriteAll(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t put = write(descriptor, bytes.data(), bytes.size());
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(put));
  }
  return true;
}

std::string Beginning(const std::string& identity) {
  std::string text(kMagic);
  AppendBytes(static_cast<std::uint64_t>(identity.size()), text);
  return text + identity;
}

}  // namespace

RunJournal::RunJournal(std::filesystem::path file, const std::string& identity,
                       std::int64_t runs, Access access)
    : file_(std::move(file)), identity_(identity), runs_(runs), access_(access) {
  try {
    Open();
  } catch (...) {
    if (descriptor_ >= 0) close(descriptor_);
    throw;
  }
}

RunJournal::~RunJournal() { close(descriptor_); }

void RunJournal::Fail(const std::string& what, const std::string& expected) const {
  throw InputError(file_.string(), what, expected);
}

void RunJournal::Open() {
  constexpr mode_t kReadable = 0644;
  const bool writes = access_ == Access::kWrite;
  descriptor_ = open(file_.c_str(), (writes ? O_RDWR | O_CREAT : O_RDONLY) | O_CLOEXEC,
                     kReadable);
  if (descriptor_ < 0) {
    Fail(std::strerror(errno),
         writes ? "a file that can be written" : "a file that can be read");
  }
  if (writes && flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) Fail(std::strerror(errno), "a file system with flock");
    Fail("another process is at work on this study", "one at a time in a folder");
  }
  struct stat status {};
  if (fstat(descriptor_, &status) != 0) Fail(std::strerror(errno), "a file");
  const auto size = static_cast<std::uint64_t>(status.st_size);
  const std::string wanted = Beginning(identity_);
  std::string found(std::min<std::uint64_t>(size, wanted.size()), '\0');
  if (!ReadAt(descriptor_, 0, found.data(), found.size()))
    Fail("cannot be read", "a file");
  // One that was killed while it began has a part of that.
  if (!wanted.starts_with(found)) {
    Fail("holds runs of another plan, setup or version",
         "the same ones, another folder, or --restart");
  }
  end_ = wanted.size();
  if (found.size() == wanted.size()) ReadEntries(wanted.size(), size);
  if (!writes) return;
  if (found.size() < wanted.size() &&
      (ftruncate(descriptor_, 0) != 0 || !WriteAll(descriptor_, wanted))) {
    Fail(std::strerror(errno), "a disk with room");
  }
  const bool is_torn = end_ < size;
  if ((is_torn && ftruncate(descriptor_, static_cast<off_t>(end_)) != 0) ||
      lseek(descriptor_, static_cast<off_t>(end_), SEEK_SET) < 0) {
    Fail(std::strerror(errno), "a file that can be written");
  }
}

void RunJournal::ReadEntries(std::uint64_t from, std::uint64_t size) {
  std::string body;
  for (end_ = from; size - end_ >= sizeof(Head);) {
    Head head;
    if (!ReadAt(descriptor_, end_, reinterpret_cast<char*>(&head), sizeof head)) return;
    const std::uint64_t rest = size - end_ - sizeof head;
    if (head.mark != kMark || head.result > rest || head.series > rest - head.result ||
        head.index < 0 || head.index >= runs_) {
      return;
    }
    body.resize(head.result + head.series);
    if (!ReadAt(descriptor_, end_ + sizeof head, body.data(), body.size())) return;
    if (Checksum(head, body) != head.checksum) return;
    places_[head.index] = {end_ + sizeof head + head.result, head.series,
                           Unpacked(body.substr(0, head.result))};
    end_ += sizeof head + body.size();
  }
}

void RunJournal::Remove(const std::filesystem::path& file) {
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return;
  const bool is_free = flock(descriptor, LOCK_EX | LOCK_NB) == 0;
  if (is_free) std::filesystem::remove(file);
  close(descriptor);
  if (!is_free) {
    throw InputError(file.string(), "another process is at work on this study",
                     "one at a time in a folder");
  }
}

bool RunJournal::Has(std::int64_t index, bool with_series) const {
  const auto found = places_.find(index);
  if (found == places_.end()) return false;
  const Place& place = found->second;
  return !with_series || place.size > 0 || place.result.diverged();
}

std::vector<std::int64_t> RunJournal::Runs() const {
  std::vector<std::int64_t> runs;
  runs.reserve(places_.size());
  for (const auto& [run, place] : places_) runs.push_back(run);
  return runs;
}

void RunJournal::Append(std::int64_t index, const RunResult& result,
                        const std::string& series) {
  const std::string packed = Packed(result);
  Head head;
  head.index = index;
  head.result = packed.size();
  head.series = series.size();
  const std::string body = packed + series;
  head.checksum = Checksum(head, body);
  std::string entry;
  AppendBytes(head, entry);
  entry += body;
  RunResult kept = result;
  kept.series.clear();
  const std::lock_guard lock(mutex_);
  if (!WriteAll(descriptor_, entry)) Fail(std::strerror(errno), "a disk with room");
  places_[index] = {end_ + sizeof head + packed.size(), series.size(), std::move(kept)};
  end_ += entry.size();
}

void RunJournal::Add(std::int64_t index, const RunResult& result) {
  Append(index, result, Text(result.series));
}

const RunResult& RunJournal::Result(std::int64_t index) const {
  return places_.at(index).result;
}

std::vector<std::string> RunJournal::ReadSeries(std::int64_t index) const {
  const Place& place = places_.at(index);
  std::string text(place.size, '\0');
  if (!ReadAt(descriptor_, place.offset, text.data(), text.size())) {
    Fail("cannot be read", "the file as it was written");
  }
  std::vector<std::string> series;
  for (std::string_view rest = text; !rest.empty();) {
    const auto size = TakeNumber<std::uint64_t>(rest);
    series.emplace_back(rest.substr(0, size));
    rest.remove_prefix(series.back().size());
  }
  return series;
}

bool RunJournal::HoldsSeries() const {
  return std::ranges::any_of(places_,
                             [](const auto& place) { return place.second.size > 0; });
}

void RunJournal::Settle(const std::vector<const RunJournal*>& others) {
  std::map<std::int64_t, const RunResult*> results;
  for (const auto& [run, place] : places_) results.emplace(run, &place.result);
  for (const RunJournal* other : others) {
    for (const auto& [run, place] : other->places_) results.emplace(run, &place.result);
  }
  const std::filesystem::path part = file_.string() + ".part";
  std::filesystem::remove(part);
  {
    RunJournal settled(part, identity_, runs_);
    for (const auto& [run, result] : results) settled.Append(run, *result, {});
  }
  std::filesystem::rename(part, file_);
  // From here on that file is the one that is open.
  close(descriptor_);
  places_.clear();
  Open();
}

}  // namespace mjdiag
