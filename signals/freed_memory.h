#pragma once

namespace mjdiag {

/// For a program that makes runs one after the other: what they free is kept for the next
/// ones. A run has some megabytes; given back to the system, and taken from it again page
/// by page, they cost two or three times what a linear run computes. Settings of the whole
/// process, so a program calls this and no library. Does nothing but with glibc.
void KeepFreedMemory() noexcept;

}  // namespace mjdiag
