#include "mjdiag/render/osmesa_library.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string RefusalOf(const std::vector<std::string>& names) {
  try {
    LoadOsMesa(names);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(OsMesaLibrary, ThatIsMissingIsNamedWithThePackageThatHasIt) {
  EXPECT_THAT(RefusalOf({"libThereIsNone.so"}),
              AllOf(HasSubstr("libThereIsNone.so"), HasSubstr("libosmesa6")));
}

TEST(OsMesaLibrary, ThatIsSomethingElseIsRefused) {
  EXPECT_THAT(RefusalOf({"libm.so.6"}), HasSubstr("OSMesaCreateContextExt"));
}

TEST(OsMesaLibrary, IsLookedForByEveryName) {
  EXPECT_NE(LoadOsMesa({"libThereIsNone.so", "libOSMesa.so.8", "libOSMesa.so.6"})
                .make_current,
            nullptr);
}

}  // namespace
}  // namespace mjdiag
