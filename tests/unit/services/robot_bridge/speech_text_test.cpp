#include "services/robot_bridge/speech_text.h"

#include <gtest/gtest.h>

#include <random>

#include "services/robot_bridge/eye_colour.h"

namespace coach {
namespace {

TEST(SpeechTextTest, OrdersAndControlCharactersVanish) {
  EXPECT_EQ(CleanText("\\vol=100\\Hi ^start(animations/wave)"), "vol=100 Hi start(animations/wave)");
  EXPECT_EQ(CleanText("a\nb\tc\x07"
                      "d\x7f"),
            "a b c d");
  EXPECT_EQ(CleanText("<break time='9999s'/>"), "break time='9999s'/");
  EXPECT_EQ(CleanText(" \n "), "");
}

TEST(SpeechTextTest, GreekStays) { EXPECT_EQ(CleanText("Πού είναι το μπλε τουβλάκι;"), "Πού είναι το μπλε τουβλάκι;"); }

TEST(SpeechTextTest, BytesThatAreNoUtf8Vanish) {
  EXPECT_EQ(CleanText("a\xff\xc0\x80z"), "az");
  EXPECT_EQ(CleanText("\xed\xa0\x80x\xce"), "x");
  EXPECT_EQ(CleanText("a\xc2\x85z"), "a z");  // a control character of two bytes
}

TEST(SpeechTextTest, CleaningTwiceChangesNothing) {
  std::mt19937 random(1);
  for (int i = 0; i < 500; ++i) {
    std::string text;
    for (int j = 0; j < 40; ++j) text += static_cast<char>(random() % 256);
    const std::string clean = CleanText(text);
    EXPECT_EQ(CleanText(clean), clean);
  }
}

TEST(SpeechTextTest, SpeakingTimeCountsCharactersNotBytes) {
  EXPECT_NEAR(SpeakingTime("μπλε"), SpeakingTime("blue"), 1e-12);
  EXPECT_NEAR(SpeakingTime(std::string(140, 'a')), 10.5, 1e-9);
}

TEST(EyeColourTest, WordsOfTaskFiles) {
  EXPECT_EQ(HexOf(*EyeColourOf("blue")), "#2d73e6");
  EXPECT_EQ(EyeColourOf("Dark-Green"), EyeColourOf("green"));
  EXPECT_EQ(EyeColourOf("mauve"), std::nullopt);
  EXPECT_EQ(EyeColourOf(""), std::nullopt);
}

}  // namespace
}  // namespace coach
