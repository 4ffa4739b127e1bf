#include "mjdiag/studies/dataset/run_journals.h"

#include <sys/resource.h>

#include <algorithm>
#include <utility>

namespace mjdiag {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBegin = "runs.";
constexpr std::string_view kEnd = ".journal";

/// Of ranks above 0, sorted by name.
std::vector<fs::path> OtherFiles(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, none)) {
    const std::string name = entry.path().filename().string();
    if (name.size() <= kBegin.size() + kEnd.size()) continue;
    if (!name.starts_with(kBegin) || !name.ends_with(kEnd)) continue;
    const std::string rank =
        name.substr(kBegin.size(), name.size() - kBegin.size() - kEnd.size());
    if (rank.find_first_not_of("0123456789") == rank.npos)
      files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

/// A file a rank is more than a process may have open, unless it asks for it.
void AllowOpenFiles(std::size_t count) {
  constexpr std::size_t kForTheRest = 256;
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = std::clamp<rlim_t>(count + kForTheRest, limit.rlim_cur,
                                      std::max(limit.rlim_cur, limit.rlim_max));
  setrlimit(RLIMIT_NOFILE, &limit);
}

}  // namespace

RunJournals::RunJournals(fs::path folder, std::string identity, std::int64_t runs)
    : folder_(std::move(folder)),
      identity_(std::move(identity)),
      runs_(runs),
      own_(FileOf(folder_, 0), identity_, runs) {
  ReadOthers();
}

fs::path RunJournals::FileOf(const fs::path& folder, int rank) {
  if (rank == 0) return folder / "runs.journal";
  return folder / ("runs." + std::to_string(rank) + ".journal");
}

void RunJournals::Remove(const fs::path& folder) {
  RunJournal::Remove(FileOf(folder, 0));
  for (const fs::path& file : OtherFiles(folder)) RunJournal::Remove(file);
}

void RunJournals::ReadOthers() {
  others_.clear();
  const std::vector<fs::path> files = OtherFiles(folder_);
  AllowOpenFiles(files.size());
  where_.assign(files.empty() ? 0 : static_cast<std::size_t>(runs_), nullptr);
  for (const fs::path& file : files) {
    others_.push_back(std::make_unique<RunJournal>(file, identity_, runs_,
                                                   RunJournal::Access::kRead));
    const RunJournal& other = *others_.back();
    for (const std::int64_t run : other.Runs()) {
      const RunJournal*& where = where_[static_cast<std::size_t>(run)];
      if (where == nullptr || !where->Has(run, true)) where = &other;
    }
  }
}

const RunJournal* RunJournals::Find(std::int64_t index, bool with_series) const {
  if (own_.Has(index, with_series)) return &own_;
  if (where_.empty()) return nullptr;
  const RunJournal* other = where_[static_cast<std::size_t>(index)];
  return other != nullptr && other->Has(index, with_series) ? other : nullptr;
}

bool RunJournals::Has(std::int64_t index, bool with_series) const {
  return Find(index, with_series) != nullptr;
}

const RunResult& RunJournals::Result(std::int64_t index) const {
  return Find(index, false)->Result(index);
}

std::vector<std::string> RunJournals::ReadSeries(std::int64_t index) const {
  const RunJournal* journal = Find(index, true);
  return journal == nullptr ? std::vector<std::string>{} : journal->ReadSeries(index);
}

void RunJournals::Settle() {
  if (others_.empty() && !own_.HoldsSeries()) return;
  std::vector<const RunJournal*> others;
  others.reserve(others_.size());
  for (const auto& other : others_) others.push_back(other.get());
  own_.Settle(others);
  where_.clear();
  others_.clear();
  for (const fs::path& file : OtherFiles(folder_)) fs::remove(file);
}

}  // namespace mjdiag
