#pragma once
// Draws of a case: the same name and seed, the same draws, whatever other cases there are.

#include <cmath>
#include <cstdint>
#include <random>
#include <string>

namespace mjdiag::test {

class CaseDice {
 public:
  CaseDice(const std::string& name, std::uint64_t seed) {
    std::uint64_t hash = 14695981039346656037ull;  // FNV-1a, the same everywhere
    for (const char letter : name) {
      hash = (hash ^ static_cast<unsigned char>(letter)) * 1099511628211ull;
    }
    // Neighbours among seeds would begin alike (splitmix64).
    hash += seed * 0x9e3779b97f4a7c15ull;
    hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9ull;
    hash = (hash ^ (hash >> 27)) * 0x94d049bb133111ebull;
    generator_.seed(hash ^ (hash >> 31));
    generator_.discard(16);
  }
  /// Evenly in [low, high).
  double Even(double low, double high) {
    return low + (high - low) * static_cast<double>(generator_() >> 11) * 0x1p-53;
  }
  /// About a size, up to half as much again or two thirds of it, evenly in the logarithm.
  double About(double size) { return size * std::pow(1.5, Even(-1.0, 1.0)); }
  double Sign() { return Even(-1.0, 1.0) < 0.0 ? -1.0 : 1.0; }

 private:
  std::mt19937_64 generator_;
};

}  // namespace mjdiag::test
