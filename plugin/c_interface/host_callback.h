#pragma once
// The control callback of the program that loads the library. MuJoCo calls it for
// whatever data are stepped, and it takes them for the program's own machine; the twins
// and simulations of mjdiag are none of its business.

namespace mjdiag {

/// From now on it is called only for what the program itself steps. To be called before
/// anything of mjdiag is stepped; does something once a process.
void KeepHostCallbackOut();

}  // namespace mjdiag
