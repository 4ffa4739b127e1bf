#pragma once
// How many threads work takes (oneTBB).

#include <functional>

namespace mjdiag {

/// The cores that this process may use.
int CoresOfProcess();

/// work(), in which loops (parallel.h) take at most so many threads, this one among them;
/// more than there are cores, too. 0: as many as there are cores for this process.
void OnThreads(int count, const std::function<void()>& work);

}  // namespace mjdiag
