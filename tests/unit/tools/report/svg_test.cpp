#include "tools/report/svg.h"

#include <gtest/gtest.h>

namespace coach::svg {
namespace {

TEST(Svg, NothingEscapesFromAText) {
  EXPECT_EQ(Escaped("<script>\"a\" & 'b'</script>"), "&lt;script&gt;&quot;a&quot; &amp; &#39;b&#39;&lt;/script&gt;");
  EXPECT_EQ(Escaped("Μπράβο!\n"), "Μπράβο!\n");
  EXPECT_EQ(Escaped("a\x01z"), "a\xEF\xBF\xBDz");
}

TEST(Svg, BrokenUtf8IsReplacedByteByByte) {
  const std::string sign = "\xEF\xBF\xBD";
  EXPECT_EQ(Escaped("\xC3"), sign);
  EXPECT_EQ(Escaped("\xC0\xAF"), sign + sign);             // overlong
  EXPECT_EQ(Escaped("\xED\xA0\x80"), sign + sign + sign);  // a surrogate
  EXPECT_EQ(Escaped("\xF4\x90\x80\x80"), sign + sign + sign + sign);
  EXPECT_EQ(Escaped("\xF0\x9F\x99\x82"), "\xF0\x9F\x99\x82");
}

TEST(Svg, TextsAreShortenedByCharacters) {
  EXPECT_EQ(Shortened("αβγδε", 5), "αβγδε");
  EXPECT_EQ(Shortened("αβγδε", 4), "αβγ…");
  EXPECT_EQ(Shortened("", 3), "");
}

TEST(Svg, MarksOfAnAxisAreRound) {
  EXPECT_DOUBLE_EQ(RoundStep(100, 5), 20);
  EXPECT_DOUBLE_EQ(RoundStep(0.7, 5), 0.2);
  EXPECT_DOUBLE_EQ(RoundStep(0, 5), 1);
  EXPECT_DOUBLE_EQ(RoundTimeStep(58, 14), 5);
  EXPECT_DOUBLE_EQ(RoundTimeStep(3000, 8), 600);
}

TEST(Svg, TitlesAreEscaped) {
  EXPECT_EQ(Circle(1, 2, 3, "made", "<b>"),
            "<circle class=\"made\" cx=\"1.0\" cy=\"2.0\" r=\"3.0\"><title>&lt;b&gt;</title></circle>");
  EXPECT_EQ(Path({}, true, "x"), "");
}

}  // namespace
}  // namespace coach::svg
