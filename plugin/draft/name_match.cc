#include "mjdiag/plugin/draft/name_match.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace mjdiag {
namespace {

constexpr double kImpossible = -1.0;
constexpr double kSame = 0.05;  // agreements that differ by less are the same

bool IsUnitless(const ColumnWords& column) {
  return !column.unit && column.unknown_unit.empty();
}

bool IsCalled(const ColumnWords& column, const std::string& name) {
  return Squeezed(column.name) == Squeezed(name);
}

/// Best agreement with one of the names.
double NameAgreement(const ColumnWords& column, const std::vector<std::string>& names) {
  if (names.empty()) return Agreement(column.place, {});
  double best = kImpossible;
  for (const std::string& name : names) {
    best = std::max(best, Agreement(column.place, ReadPlaceWords(name)));
  }
  return best;
}

double ReadingScore(const Reading& reading, const ColumnWords& column) {
  const bool fits = column.Dimension() == reading.unit || IsUnitless(column);
  if (!fits || column.role == ColumnRole::kOther ||
      column.role == ColumnRole::kReference) {
    return kImpossible;
  }
  // Sensor, or what stands for the one that is to be added: the joint.
  const bool own = !reading.names.empty() && IsCalled(column, reading.names.front());
  if (own && column.role != ColumnRole::kCommand) return 1.3;
  const bool component =
      !own && reading.joint < 0 &&
      std::ranges::any_of(reading.names, [&](const std::string& name) {
        return IsCalled(column, name);
      });
  if (component) return 1.2;
  if (reading.by_name_only || column.quantity != reading.quantity ||
      column.role == ColumnRole::kCommand) {
    return kImpossible;
  }
  return NameAgreement(column, reading.names);
}

bool IsForceUnit(const std::string& unit) { return unit == "N" || unit == "N m"; }

/// How natural a unit is for the control of an actuator; less is more.
int UnitRank(const Drive& drive, const ColumnWords& column) {
  const std::string unit = column.Dimension();
  if (drive.input == Input::kVoltage) return unit == "V" ? 0 : 1;
  if (drive.is_force) return unit == drive.unit || IsUnitless(column) ? 0 : 1;
  return 0;
}

int RoleRank(const Drive& drive, ColumnRole role) {
  const bool servo = drive.input == Input::kPosition || drive.input == Input::kVelocity;
  switch (role) {
    case ColumnRole::kMeasured:
      return servo ? 3 : 0;
    case ColumnRole::kPlain:
      return servo ? 2 : 1;
    case ColumnRole::kCommand:
      return servo ? 0 : 2;
    case ColumnRole::kReference:
      return servo ? 1 : 3;
    case ColumnRole::kOther:
      break;
  }
  return 9;
}

double DriveScore(const Drive& drive, const ColumnWords& column) {
  if (column.role == ColumnRole::kOther) return kImpossible;
  const std::string unit = column.Dimension();
  const bool own =
      drive.actuator >= 0 &&
      IsCalled(column, drive.names.empty() ? drive.element : drive.names.front());
  if (drive.input == Input::kPosition || drive.input == Input::kVelocity) {
    const Quantity wanted =
        drive.input == Input::kPosition ? Quantity::kPosition : Quantity::kVelocity;
    if (unit != drive.unit && !IsUnitless(column)) return kImpossible;
    const bool told =
        column.role == ColumnRole::kCommand || column.role == ColumnRole::kReference;
    const bool can =
        own ||
        (told && (column.quantity == wanted || column.quantity == Quantity::kUnknown ||
                  column.quantity == Quantity::kDrive)) ||
        (IsUnitless(column) && column.quantity == Quantity::kDrive);
    if (!can) return kImpossible;
  } else {
    const bool slide_and_torque =
        drive.unit == "N" && drive.joint >= 0 && unit == "N m";
    const bool hinge_and_force = drive.unit == "N m" && unit == "N";
    const bool pure = drive.input == Input::kPure && column.unit && unit == "1";
    const bool can = column.quantity == Quantity::kDrive || own ||
                     (column.quantity == Quantity::kUnknown &&
                      column.role == ColumnRole::kCommand && IsUnitless(column));
    if (!can || (slide_and_torque && drive.is_force) ||
        (hinge_and_force && drive.is_force)) {
      return kImpossible;
    }
    if (column.quantity != Quantity::kDrive && !IsUnitless(column) && !pure) {
      return kImpossible;
    }
    // Of a motor that is not there nobody knows what an ampere does.
    if (drive.actuator < 0 && !IsUnitless(column) && !IsForceUnit(unit)) {
      return kImpossible;
    }
  }
  if (own) return 1.3;
  return NameAgreement(column, drive.names);
}

// From this agreement on a name says it, and not only fails to contradict it.
constexpr double kSaid = 0.6;

/// The score of a place that the plant has not got yet: a sensor or a motor is added where
/// the column says that it is of there, or the plant has none of its kind.
double ScoreOfNew(double score, bool has_others) {
  return has_others && score < kSaid ? kImpossible : score;
}

/// Scores of places and columns, and what has been decided.
class Table {
 public:
  /// @param rank  orders columns that agree equally well with a place
  template <typename Score, typename Rank>
  Table(std::size_t places, std::size_t columns, const Score& score, const Rank& rank)
      : choices(places), used_(columns, false) {
    for (std::size_t p = 0; p < places; ++p) {
      scores_.emplace_back();
      ranks_.emplace_back();
      for (std::size_t c = 0; c < columns; ++c) {
        scores_.back().push_back(score(p, c));
        ranks_.back().push_back(rank(p, c));
      }
    }
  }

  double At(std::size_t place, std::size_t column) const {
    return scores_[place][column];
  }
  int RankAt(std::size_t place, std::size_t column) const {
    return ranks_[place][column];
  }
  bool IsOpen(std::size_t place) const { return !choices[place].column; }
  bool IsFree(std::size_t column) const { return !used_[column]; }
  void Close(std::size_t column) { used_[column] = true; }

  void Decide(std::size_t place, std::size_t column) {
    choices[place].column = column;
    used_[column] = true;
    for (std::size_t c = 0; c < used_.size(); ++c) {
      if (c != column && IsFree(c) && scores_[place][c] > 0.0 &&
          scores_[place][c] >= scores_[place][column] - kSame) {
        choices[place].others.push_back(c);
      }
    }
  }

  /// The best pairs first, as long as one is best for both of its sides.
  void DecideBest() {
    while (DecideOne()) {
    }
    for (std::size_t p = 0; p < choices.size(); ++p) {
      if (!IsOpen(p)) continue;
      double best = 0.0;
      for (std::size_t c = 0; c < used_.size(); ++c) {
        if (IsFree(c)) best = std::max(best, scores_[p][c]);
      }
      if (best <= 0.0) continue;
      for (std::size_t c = 0; c < used_.size(); ++c) {
        if (IsFree(c) && scores_[p][c] >= best - kSame) choices[p].others.push_back(c);
      }
    }
  }

  std::vector<ColumnChoice> choices;

 private:
  /// The columns that agree best with a place, of the first rank.
  std::vector<std::size_t> BestOf(std::size_t place) const {
    double best = 0.0;
    for (std::size_t c = 0; c < used_.size(); ++c) {
      if (IsFree(c)) best = std::max(best, scores_[place][c]);
    }
    std::vector<std::size_t> columns;
    if (best <= 0.0) return columns;
    int first = 1000;
    for (std::size_t c = 0; c < used_.size(); ++c) {
      if (!IsFree(c) || scores_[place][c] < best - kSame) continue;
      if (ranks_[place][c] < first) columns.clear();
      first = std::min(first, ranks_[place][c]);
      if (ranks_[place][c] == first) columns.push_back(c);
    }
    return columns;
  }

  bool DecideOne() {
    std::optional<std::pair<std::size_t, std::size_t>> best;
    for (std::size_t p = 0; p < choices.size(); ++p) {
      if (!IsOpen(p)) continue;
      const std::vector<std::size_t> columns = BestOf(p);
      if (columns.size() != 1) continue;
      const std::size_t c = columns.front();
      bool contested = false;
      for (std::size_t q = 0; q < choices.size(); ++q) {
        contested =
            contested || (q != p && IsOpen(q) && scores_[q][c] > scores_[p][c] - kSame);
      }
      if (contested) continue;
      if (!best || scores_[p][c] > scores_[best->first][best->second]) best = {p, c};
    }
    if (!best) return false;
    Decide(best->first, best->second);
    return true;
  }

  std::vector<std::vector<double>> scores_;
  std::vector<std::vector<int>> ranks_;
  std::vector<bool> used_;
};

/// Columns that differ in one number alone: that number and the column.
using Row = std::map<int, std::size_t>;

std::vector<Row> RowsOf(const std::vector<ColumnWords>& columns) {
  std::map<std::vector<std::string>, Row> rows;
  std::set<std::vector<std::string>> doubtful;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const ColumnWords& column = columns[c];
    if (column.place.numbers.size() != 1) continue;
    std::string stem;
    for (const char letter : column.name) {
      if (letter < '0' || letter > '9') stem += letter;
    }
    const std::vector<std::string> key{stem, column.Dimension()};
    if (!rows[key].emplace(column.place.numbers.front(), c).second)
      doubtful.insert(key);
  }
  std::vector<Row> found;
  for (const auto& [key, row] : rows) {
    const bool whole =
        row.rbegin()->first - row.begin()->first + 1 == static_cast<int>(row.size());
    if (row.size() > 1 && whole && !doubtful.contains(key)) found.push_back(row);
  }
  return found;
}

/// The number that a place is known by: that of a name that has it and no other words.
std::optional<int> NumberOf(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const PlaceWords place = ReadPlaceWords(name);
    if (place.numbers.size() == 1) return place.numbers.front();
  }
  return std::nullopt;
}

/// Rows whose numbers are not those of the places: from 0 where places begin at 1, or of
/// places without numbers, as many as there are.
template <typename Place, typename Able>
void DecideRows(const std::vector<Place>& places,
                const std::vector<std::size_t>& series, const std::vector<Row>& rows,
                const Able& able, Table& table) {
  if (series.empty()) return;
  std::set<int> numbers;
  bool numbered = true;
  for (const std::size_t p : series) {
    const std::optional<int> number = NumberOf(places[p].names);
    numbered = numbered && number && numbers.insert(*number).second;
  }
  std::vector<Row> ordered = rows;
  std::ranges::stable_sort(ordered, {}, [&](const Row& row) {
    return table.RankAt(series.front(), row.begin()->second);
  });
  for (const Row& row : ordered) {
    if (row.size() != series.size()) continue;
    bool fits = true;
    std::size_t at = 0;
    for (const auto& [number, c] : row) {
      fits = fits && table.IsFree(c) && table.IsOpen(series[at]) && able(series[at], c);
      ++at;
    }
    // Where the numbers are the same the names say it themselves.
    if (!fits || (numbered && row.begin()->first == *numbers.begin())) continue;
    if (numbered &&
        static_cast<int>(numbers.size()) != *numbers.rbegin() - *numbers.begin() + 1) {
      continue;
    }
    std::vector<std::size_t> order = series;
    if (numbered) {
      std::ranges::sort(order, {},
                        [&](std::size_t p) { return NumberOf(places[p].names); });
    }
    at = 0;
    for (const auto& [number, c] : row) {
      table.Decide(order[at], c);
      table.choices[order[at]].by_order = !numbered;
      ++at;
    }
    return;
  }
}

/// One place and one column that can be it: then their names may differ.
template <typename Able>
void DecideTheOnlyPair(const std::vector<std::size_t>& series, std::size_t columns,
                       const Able& able, Table& table) {
  if (series.size() != 1 || !table.IsOpen(series.front())) return;
  std::vector<std::size_t> found;
  for (std::size_t c = 0; c < columns; ++c) {
    if (table.IsFree(c) && able(series.front(), c)) found.push_back(c);
  }
  if (found.size() != 1) return;
  table.choices[series.front()].others.clear();
  table.Decide(series.front(), found.front());
  table.choices[series.front()].by_elimination = true;
}

}  // namespace

std::vector<ColumnChoice> MatchReadings(const std::vector<Reading>& readings,
                                        const std::vector<ColumnWords>& columns) {
  const bool has_encoders = std::ranges::any_of(readings, [](const Reading& reading) {
    return reading.exists && reading.joint >= 0 &&
           reading.quantity == Quantity::kPosition;
  });
  Table table(
      readings.size(), columns.size(),
      [&](std::size_t p, std::size_t c) {
        const double score = ReadingScore(readings[p], columns[c]);
        return readings[p].exists ? score : ScoreOfNew(score, has_encoders);
      },
      [&](std::size_t, std::size_t c) {
        const int measured = columns[c].role == ColumnRole::kMeasured ? 0 : 1;
        return 2 * measured + (IsUnitless(columns[c]) ? 1 : 0);
      });
  // Positions of joints first: speeds stand behind them, as logs mostly make them of those.
  std::vector<std::size_t> joints;
  for (std::size_t p = 0; p < readings.size(); ++p) {
    if (readings[p].joint >= 0 && readings[p].quantity == Quantity::kPosition) {
      joints.push_back(p);
    }
  }
  const auto able = [&](std::size_t p, std::size_t c) {
    const ColumnWords& column = columns[c];
    return column.quantity == readings[p].quantity &&
           (column.role == ColumnRole::kPlain ||
            column.role == ColumnRole::kMeasured) &&
           (IsUnitless(column) || column.Dimension() == readings[p].unit);
  };
  DecideRows(readings, joints, RowsOf(columns), able, table);
  table.DecideBest();
  DecideTheOnlyPair(joints, columns.size(), able, table);
  std::set<int> read;
  for (const std::size_t p : joints) {
    if (table.choices[p].column) read.insert(readings[p].joint);
  }
  for (std::size_t p = 0; p < readings.size(); ++p) {
    const bool speed = readings[p].quantity == Quantity::kVelocity;
    if (speed && read.contains(readings[p].joint)) table.choices[p] = {};
  }
  return table.choices;
}

std::vector<ColumnChoice> MatchDrives(const std::vector<Drive>& drives,
                                      const std::vector<ColumnWords>& columns,
                                      const std::vector<bool>& taken) {
  const bool has_motors = std::ranges::any_of(
      drives, [](const Drive& drive) { return drive.actuator >= 0; });
  Table table(
      drives.size(), columns.size(),
      [&](std::size_t p, std::size_t c) {
        if (taken[c]) return kImpossible;
        const double score = DriveScore(drives[p], columns[c]);
        return drives[p].actuator >= 0 ? score : ScoreOfNew(score, has_motors);
      },
      [&](std::size_t p, std::size_t c) {
        return 20 * UnitRank(drives[p], columns[c]) +
               2 * RoleRank(drives[p], columns[c].role) +
               (IsUnitless(columns[c]) ? 1 : 0);
      });
  std::vector<std::size_t> motors;
  for (std::size_t p = 0; p < drives.size(); ++p) {
    if (drives[p].actuator >= 0) motors.push_back(p);
  }
  if (motors.empty()) {
    for (std::size_t p = 0; p < drives.size(); ++p) motors.push_back(p);
  }
  const auto able = [&](std::size_t p, std::size_t c) {
    ColumnWords column = columns[c];
    column.place = {};
    return !taken[c] && DriveScore(drives[p], column) > kImpossible &&
           RoleRank(drives[p], column.role) < 3;
  };
  DecideRows(drives, motors, RowsOf(columns), able, table);
  table.DecideBest();
  DecideTheOnlyPair(motors, columns.size(), able, table);
  return table.choices;
}

}  // namespace mjdiag
