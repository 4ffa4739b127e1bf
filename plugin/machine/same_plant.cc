#include "mjdiag/plugin/machine/same_plant.h"

#include <mujoco/mjxmacro.h>

#include <cstddef>
#include <cstring>

namespace mjdiag {
namespace {

bool HaveSameSizes(const mjModel& a, const mjModel& b) {
#define X(name) \
  if (a.name != b.name) return false;
  MJMODEL_INTS
#undef X
  return true;
}

bool HaveSameOptions(const mjOption& a, const mjOption& b) {
#define X(type, name) \
  if (a.name != b.name) return false;
  MJOPTION_SCALARS
#undef X
#define X(name, count) \
  if (std::memcmp(a.name, b.name, (count) * sizeof(mjtNum)) != 0) return false;
  MJOPTION_VECTORS
#undef X
  return true;
}

}  // namespace

bool AreSamePlant(const mjModel& a, const mjModel& b) {
  if (&a == &b) return true;
  if (!HaveSameSizes(a, b) || !HaveSameOptions(a.opt, b.opt)) return false;
  const auto* m = &a;  // of which the list takes numbers of columns
  MJMODEL_POINTERS_PREAMBLE(m)
#define X(type, name, rows, columns)                                \
  if (std::memcmp(a.name, b.name,                                   \
                  sizeof(type) * static_cast<std::size_t>(a.rows) * \
                      static_cast<std::size_t>(columns)) != 0) {    \
    return false;                                                   \
  }
  MJMODEL_POINTERS
#undef X
  return true;
}

}  // namespace mjdiag
