#include "mjdiag/render/scene/osmesa_library.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/signals/error.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(OsMesaLibrary, ThatIsMissingIsNamedWithThePackageThatHasIt) {
  EXPECT_THAT(test::MessageOf<InputError>([] { LoadOsMesa({"libThereIsNone.so"}); }),
              AllOf(HasSubstr("libThereIsNone.so"), HasSubstr("libosmesa6")));
}

TEST(OsMesaLibrary, ThatIsSomethingElseIsRefused) {
  EXPECT_THAT(test::MessageOf<InputError>([] { LoadOsMesa({"libm.so.6"}); }),
              HasSubstr("OSMesaCreateContextExt"));
}

TEST(OsMesaLibrary, IsLookedForByEveryName) {
  EXPECT_NE(LoadOsMesa({"libThereIsNone.so", "libOSMesa.so.8", "libOSMesa.so.6"})
                .make_current,
            nullptr);
}

}  // namespace
}  // namespace mjdiag
