#include "mjdiag/plugin/setup/xml_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/signals/error.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;

constexpr const char* kText = R"(<?xml version="1.0"?>
<!-- <a> -->
<root>
  <a x='1'  y="&lt;2"><!-- > --><b/></a>

  <c
    z="3"/>
</root>
)";

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST(XmlText, FindsElementsAndAttributesInDocumentOrder) {
  const XmlText xml("test", kText);
  std::vector<std::string> tags;
  for (const XmlElement& element : xml.elements()) tags.push_back(element.tag);
  EXPECT_EQ(tags, (std::vector<std::string>{"root", "a", "b", "c"}));
  EXPECT_EQ(xml.ParentTag(xml.At(2)), "a");
  EXPECT_EQ(xml.ParentTag(xml.At(0)), "");
  EXPECT_EQ(*xml.At(1).Find("y"), "<2");
  EXPECT_EQ(xml.At(1).Find("z"), nullptr);
  EXPECT_EQ(xml.Content(xml.At(1)), "<!-- > --><b/>");
}

TEST(XmlText, IsItselfWithoutChanges) {
  EXPECT_EQ(XmlText("test", kText).Text(), kText);
}

TEST(XmlText, ChangesWhatIsAskedAndNothingElse) {
  const auto changed = [](const auto& change) {
    XmlText xml("test", kText);
    change(xml);
    return xml.Text();
  };
  EXPECT_EQ(changed([](XmlText& xml) { xml.SetAttribute(1, "x", "a\"b"); }),
            Replaced(kText, "x='1'", "x='a&quot;b'"));
  EXPECT_EQ(changed([](XmlText& xml) { xml.SetAttribute(3, "w", "4"); }),
            Replaced(kText, "z=\"3\"/>", R"(z="3" w="4"/>)"));
  EXPECT_EQ(changed([](XmlText& xml) {
              xml.InsertLast(2, {"<d/>", "<e/>"});
            }),
            Replaced(kText, "<b/>", "<b>\n  <d/>\n  <e/>\n</b>"));
  EXPECT_EQ(changed([](XmlText& xml) { xml.InsertLast(1, {"<d/>"}); }),
            Replaced(kText, "<b/></a>", "<b/><d/></a>"));
  EXPECT_EQ(changed([](XmlText& xml) { xml.InsertLast(0, {"<d/>"}); }),
            Replaced(kText, "</root>", "  <d/>\n</root>"));
  EXPECT_EQ(changed([](XmlText& xml) { xml.InsertFirst(0, "<d/>"); }),
            Replaced(kText, "<root>", "<root>\n  <d/>"));
  EXPECT_EQ(changed([](XmlText& xml) { xml.Remove(3); }),
            Replaced(kText, "  <c\n    z=\"3\"/>\n", ""));
  EXPECT_EQ(changed([](XmlText& xml) { xml.Remove(2); }), Replaced(kText, "<b/>", ""));
}

TEST(XmlText, SaysOnWhichLineItIsNotWellFormed) {
  const auto message = [](const char* text) {
    return test::MessageOf<InputError>([&] { XmlText("plant.xml", text); });
  };
  EXPECT_THAT(message("<a>\n<b></a>"), HasSubstr("plant.xml:2: <b> has another end"));
  EXPECT_THAT(message("<a>\n<b x=1/></a>"), HasSubstr("plant.xml:2: a value without"));
  EXPECT_THAT(message("<a x/>"), HasSubstr("an attribute has no value"));
  EXPECT_THAT(message("<a x=\"1/>"), HasSubstr("follows"));
  EXPECT_THAT(message("<a>"), HasSubstr("an element has no end"));
  EXPECT_THAT(message("</a>"), HasSubstr("an end without a beginning"));
  EXPECT_THAT(message("<!-- <a>"), HasSubstr("follows"));
  EXPECT_THAT(message("<a"), HasSubstr("an attribute has no value"));
  EXPECT_THAT(message("<"), HasSubstr("an attribute has no value"));
  EXPECT_THAT(message("nothing"), HasSubstr("no element"));
}

}  // namespace
}  // namespace mjdiag
