#include "mjdiag/signals/wide_product.h"

#include <array>
#include <cstring>
#include <utility>

// Of functions of another target only their own body may use its registers, so all that
// they call is inlined into them.
#define MJDIAG_INLINED [[gnu::always_inline]] inline

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// A register, by its doubles.
using Two = double __attribute__((vector_size(16)));
using Four = double __attribute__((vector_size(32)));
using Eight = double __attribute__((vector_size(64)));

/// Sums in some registers, each by its name: in a loop, or copied together, they would stay
/// in memory.
template <typename Register, typename Names>
struct Sums;
template <typename Register, std::size_t... r>
struct Sums<Register, std::index_sequence<r...>> {
  static constexpr Index kEach = sizeof(Register) / sizeof(double);
  static constexpr Index kRows = sizeof...(r) * kEach;
  Register sums[sizeof...(r)] = {};

  MJDIAG_INLINED void Read(const double* from) noexcept {
    (std::memcpy(&sums[r], from + r * kEach, sizeof(Register)), ...);
  }
  MJDIAG_INLINED void Write(double* to) const noexcept {
    (std::memcpy(to + r * kEach, &sums[r], sizeof(Register)), ...);
  }
  MJDIAG_INLINED void Add(const double* entries, double weight) noexcept {
    (AddTo(sums[r], entries + r * kEach, weight), ...);
  }

 private:
  MJDIAG_INLINED static void AddTo(Register& sum, const double* entries,
                                   double weight) noexcept {
    Register read;
    std::memcpy(&read, entries, sizeof read);
    sum += read * weight;
  }
};
template <typename Register, int kCount>
using SumsOf = Sums<Register, std::make_index_sequence<kCount>>;

/// What is tried next for the rows that are left; 24 in three registers of eight are common.
constexpr int Fewer(int registers) {
  return registers == 8 ? 6 : registers == 6 ? 3 : registers - 1;
}

/// The rows of kCount registers of a product, and of less if rows are left.
template <typename Register, int kCount>
MJDIAG_INLINED void ProductOf(const MatrixXd& matrix, Index row, const double* x,
                              double* result) noexcept {
  constexpr Index kRows = SumsOf<Register, kCount>::kRows;
  for (; row + kRows <= matrix.rows(); row += kRows) {
    SumsOf<Register, kCount> sums;
    const double* column = matrix.data() + row;
    for (Index j = 0; j < matrix.cols(); ++j, column += matrix.rows()) {
      sums.Add(column, x[j]);
    }
    sums.Write(result + row);
  }
  if constexpr (kCount > 1) ProductOf<Register, Fewer(kCount)>(matrix, row, x, result);
}

template <typename Register, int kCount>
MJDIAG_INLINED void AddTerms(std::span<const WideTerm> terms, const double* weights,
                             const MatrixXd& columns, Index row,
                             MatrixXd& sums) noexcept {
  constexpr Index kRows = SumsOf<Register, kCount>::kRows;
  for (; row + kRows <= columns.rows(); row += kRows) {
    auto term = terms.begin();
    while (term != terms.end()) {
      const Index into = term->into;
      double* const column = sums.data() + into * sums.rows() + row;
      SumsOf<Register, kCount> sum;
      sum.Read(column);
      for (; term != terms.end() && term->into == into; ++term) {
        sum.Add(columns.data() + term->from * columns.rows() + row,
                weights[term->weight]);
      }
      sum.Write(column);
    }
  }
  if constexpr (kCount > 1) {
    AddTerms<Register, Fewer(kCount)>(terms, weights, columns, row, sums);
  }
}

// Half of the registers hold sums.
constexpr int kRegisters = 8;

void ProductOfAny(const MatrixXd& matrix, const double* x, double* result) noexcept {
  ProductOf<Two, kRegisters>(matrix, 0, x, result);
}
void AddOfAny(std::span<const WideTerm> terms, const double* weights,
              const MatrixXd& columns, MatrixXd& sums) noexcept {
  AddTerms<Two, kRegisters>(terms, weights, columns, 0, sums);
}

#if defined(__x86_64__)
[[gnu::target("avx")]] void ProductOfAvx(const MatrixXd& matrix, const double* x,
                                         double* result) noexcept {
  ProductOf<Four, kRegisters>(matrix, 0, x, result);
}
[[gnu::target("avx")]] void AddOfAvx(std::span<const WideTerm> terms,
                                     const double* weights, const MatrixXd& columns,
                                     MatrixXd& sums) noexcept {
  AddTerms<Four, kRegisters>(terms, weights, columns, 0, sums);
}

[[gnu::target("avx512f")]] void ProductOfAvx512(const MatrixXd& matrix, const double* x,
                                                double* result) noexcept {
  ProductOf<Eight, kRegisters>(matrix, 0, x, result);
}
[[gnu::target("avx512f")]] void AddOfAvx512(std::span<const WideTerm> terms,
                                            const double* weights,
                                            const MatrixXd& columns,
                                            MatrixXd& sums) noexcept {
  AddTerms<Eight, kRegisters>(terms, weights, columns, 0, sums);
}
#endif

constexpr std::array kAll = {
    WideProducts{"any", ProductOfAny, AddOfAny},
#if defined(__x86_64__)
    WideProducts{"AVX", ProductOfAvx, AddOfAvx},
    WideProducts{"AVX-512", ProductOfAvx512, AddOfAvx512},
#endif
};

}  // namespace

std::span<const WideProducts> WideProductsHere() {
  std::size_t count = 1;
#if defined(__x86_64__)
  __builtin_cpu_init();  // others may ask before main
  if (__builtin_cpu_supports("avx")) count = 2;
  if (count == 2 && __builtin_cpu_supports("avx512f")) count = 3;
#endif
  return {kAll.data(), count};
}

namespace {
const WideProducts widest = WideProductsHere().back();
}  // namespace

void WideProduct(const MatrixXd& matrix, const double* x, double* result) noexcept {
  widest.product(matrix, x, result);
}

void WideAdd(std::span<const WideTerm> terms, const double* weights,
             const MatrixXd& columns, MatrixXd& sums) noexcept {
  widest.add(terms, weights, columns, sums);
}

}  // namespace mjdiag
