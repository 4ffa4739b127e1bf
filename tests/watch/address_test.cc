#include "mjdiag/watch/stream/address.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/signals/error.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

using testing::HasSubstr;

std::string Again(const char* text) {
  return AddressText(ParseStreamAddress(text, "--source"));
}

TEST(AddressTest, ReadsWhatIsDocumented) {
  EXPECT_EQ(Again("-"), "stdin");
  EXPECT_EQ(Again("udp:9870"), "udp:127.0.0.1:9870");
  EXPECT_EQ(Again("udp:0.0.0.0:9870"), "udp:0.0.0.0:9870");
  EXPECT_EQ(Again("udp:[::1]:9870"), "udp:[::1]:9870");
  EXPECT_EQ(Again("mqtt:broker/plant/ticks"), "mqtt:broker:1883/plant/ticks");
  EXPECT_EQ(Again("mqtt://broker:2000/ticks"), "mqtt:broker:2000/ticks");
}

TEST(AddressTest, RefusesAnythingElseInOneLine) {
  for (const char* text : {"", "tcp:1", "udp:", "udp:host", "udp:host:x", "udp:1:70000",
                           "udp:0", "mqtt:host", "mqtt:/topic", "udp:[::1"}) {
    const std::string message =
        test::MessageOf<InputError>([&] { ParseStreamAddress(text, "--source"); });
    EXPECT_THAT(message, HasSubstr("--source")) << text;
    EXPECT_THAT(message, HasSubstr("; expected ")) << text;
  }
}

}  // namespace
}  // namespace mjdiag
