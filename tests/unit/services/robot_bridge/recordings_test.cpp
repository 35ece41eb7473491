#include "services/robot_bridge/recordings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <thread>

#include "common/configuration/yaml_reader.h"
#include "services/robot_bridge/speech_renderer.h"

namespace coach {
namespace {

using testing::HasSubstr;

class RecordingsTest : public testing::Test {
 protected:
  RecordingsTest() : folder_(std::filesystem::temp_directory_path() / ("coach_voices_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_ / "el");
  }
  ~RecordingsTest() override { std::filesystem::remove_all(folder_); }
  void Put(const std::string& name, const std::string& bytes) const { std::ofstream(folder_ / name) << bytes; }
  static std::string Sound(int rate = 16000) { return WavFile({0, rate, std::vector<int16_t>(160, 7), ""}); }
  static SpeechOrder Order(const std::string& text, const std::string& key, int wording) {
    return {3, text, "el", key, wording};
  }
  std::string Problem() const {
    try {
      const Recordings recordings(folder_);
    } catch (const ConfigurationError& error) {
      return error.what();
    }
    return "";
  }
  const std::filesystem::path folder_;
};

TEST_F(RecordingsTest, AreFoundByTheirWordsOrByPhraseAndWording) {
  Put("el/praise-2.wav", Sound());
  Put("el/first.wav", Sound());
  Put("el/first.txt", "Πάρε το  μπλε τουβλάκι.\n");
  const Recordings recordings(folder_);
  EXPECT_EQ(recordings.size(), 2u);
  EXPECT_EQ(recordings.Find(Order("whatever", "praise", 1)), folder_ / "el/praise-2.wav");
  EXPECT_EQ(recordings.Find(Order("Πάρε το μπλε τουβλάκι.", "step", 4)), folder_ / "el/first.wav");
  EXPECT_FALSE(recordings.Find(Order("whatever", "praise", 0)));
  EXPECT_FALSE(recordings.Find(Order("whatever", "", 0)));
  EXPECT_FALSE(recordings.Find({3, "whatever", "en", "praise", 1}));
  EXPECT_FALSE(Recordings().Find(Order("whatever", "praise", 1)));
}

TEST_F(RecordingsTest, WhatCantBePlayedIsSaidAtTheStart) {
  Put("el/praise-1.wav", "RIFF");
  EXPECT_THAT(Problem(), HasSubstr("praise-1.wav: WAV"));
  Put("el/praise-1.wav", Sound(11025));
  EXPECT_THAT(Problem(), HasSubstr("11025"));
  Put("el/praise-1.wav", Sound(48000));
  EXPECT_EQ(Problem(), "");
  EXPECT_THROW(Recordings(folder_ / "none"), ConfigurationError);
}

TEST_F(RecordingsTest, APersonsVoiceComesBeforeASynthesisedOne) {
  Put("el/praise-1.wav", Sound());
  SpeechRenderer renderer{Recordings(folder_)};
  EXPECT_TRUE(renderer.HasRecording(Order("x", "praise", 0)));
  EXPECT_TRUE(renderer.CanSay(Order("x", "praise", 0)));
  renderer.Order(Order("x", "praise", 0));
  std::vector<RenderedSpeech> rendered;
  for (int i = 0; i < 200 && rendered.empty(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    rendered = renderer.Take();
  }
  ASSERT_EQ(rendered.size(), 1u);
  EXPECT_EQ(rendered[0].id, 3);
  EXPECT_EQ(rendered[0].error, "");
  EXPECT_EQ(rendered[0].samples, std::vector<int16_t>(160, 7));
}

}  // namespace
}  // namespace coach
