#include "tools/report/annotation_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace coach {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr int64_t kOrigin = 1'700'000'000'000'000;

std::string Told(const Annotation& a) {
  return std::to_string((a.utime - kOrigin) / 1000) + " " + a.kind + "|" + a.subject + "|" + a.value + "|" +
         a.annotator;
}
std::vector<std::string> Told(const ImportedAnnotations& imported) {
  std::vector<std::string> out;
  for (const Annotation& a : imported.annotations) out.push_back(Told(a));
  return out;
}

TEST(Elan, AsItExportsWithoutColumnNames) {
  // tier, participant, begin and end each as hh:mm:ss.ms, ss.msec and ms, then duration, then the text
  const auto imported = ParseElan(
      "connect\tAK\t00:01:02.500\t62.5\t62500\t00:01:03.000\t63.0\t63000\t00:00:00.500\t0.5\t500\tcorner_1\r\n"
      "Mistake\tAK\t00:00:05.250\t5.25\t5250\t00:00:06.000\t6.0\t6000\t00:00:00.750\t0.75\t750\t\n"
      "child\t\t00:00:07.000\t7.0\t7000\t00:00:08.000\t8.0\t8000\t00:00:01.000\t1.0\t1000\tdisconnect corner_1\n"
      "child\t\t00:00:09.000\t9.0\t9000\t00:00:10.000\t10.0\t10000\t00:00:01.000\t1.0\t1000\tsays \"look\n"
      "Coach connect\tCoach\t00:00:01.000\t00:00:02.000\t00:00:01.000\tcorner_2\n",
      kOrigin);
  EXPECT_EQ(imported.unreadable, 0);
  EXPECT_THAT(Told(imported), ElementsAre("5250 wrong|unknown||AK", "7000 disconnect|corner_1||",
                                          "9000 note||child: says \"look|", "62500 connect|corner_1||AK"));
}

TEST(Elan, ColumnNamesSayWhatIsWhere) {
  const auto imported = ParseElan(
      "\"#lesson.eaf -- offset: 0\"\nTier\tBegin Time - msec\tEnd Time - "
      "msec\tAnnotation\nmade\t1500\t1600\tcorner_2\nmade\t?\t\tx\n",
      kOrigin);
  EXPECT_THAT(Told(imported), ElementsAre("1500 connect|corner_2||"));
  EXPECT_EQ(imported.unreadable, 1);
}

TEST(Boris, OldAndNewColumnsAfterAPreamble) {
  const auto imported = ParseBoris(
      "Observation id,lesson\nMedia file(s),,\n\nTime,Media file path,Subject,Behavior,Behavioral "
      "category,Modifiers,Comment,Status\n"
      "3.25,x.mp4,No focal subject,connect,,corner_1,,POINT\n"
      "9.5,x.mp4,child,talks,,,\"says, "
      "\"\"hi\"\"\",START\n10.5,x.mp4,child,talks,,,,STOP\nlate,x.mp4,,connect,,,,POINT\n",
      kOrigin);
  EXPECT_THAT(Told(imported), ElementsAre("3250 connect|corner_1||", "9500 note||talks: says, \"hi\"|child"));
  EXPECT_EQ(imported.unreadable, 1);
  EXPECT_THAT(Told(ParseBoris("Observation id\tSubject\tBehavior\tModifier #1\tBehavior type\tTime\tComment\n"
                              "o\tAK\twrong\tm\tPOINT\t1\twhy\n",
                              kOrigin)),
              ElementsAre("1000 wrong|m|why|AK"));
  EXPECT_THROW(ParseBoris("a,b\n1,2\n", kOrigin), std::invalid_argument);
  EXPECT_THROW(ParseBoris("", kOrigin), std::invalid_argument);
}

TEST(SceneEvents, OnlyConnectionsCount) {
  EXPECT_THAT(Told(ParseSceneEvents(R"({"events": [{"time": 2.5, "type": "grasp"},
      {"time": 3, "type": "wrong_connect", "connection": "m"}, {"time": 1, "type": "connect", "connection": "c1"}]})",
                                    kOrigin)),
              ElementsAre("1000 connect|c1||scene", "3000 wrong|m||scene"));
  EXPECT_THROW(ParseSceneEvents("[", kOrigin), std::invalid_argument);
  EXPECT_THROW(ParseSceneEvents(R"({"events": [{"type": "connect"}]})", kOrigin), std::invalid_argument);
}

std::vector<Annotation> Some() {
  return {{kOrigin + 1'250'000, 1, "AK", "connect", "corner_1", "", 0},
          {kOrigin + 2'000'000, 2, "AK", "wrong", "unknown", "", 0},
          {kOrigin + 3'000'000, 3, "AK", "disconnect", "corner_1", "", 0},
          {kOrigin + 3'500'000, 4, "AK", "note", "", "tabs\tand <b>, \"quotes\"", 0}};
}
std::vector<GuidanceEvent> Decisions() {
  GuidanceEvent e;
  e.utime = kOrigin + 2'000'000;
  e.since = kOrigin + 1'300'000;
  e.kind = "connect";
  e.subject = "corner_1";
  GuidanceEvent say = e;
  say.kind = "say";
  say.reason = "Well done,\nbuilder!";
  GuidanceEvent phase = e;
  phase.kind = "phase";
  return {e, say, phase};
}

TEST(Elan, WhatIsExportedComesBackWithoutWhatCoachWrote) {
  const std::string text = ElanText(Some(), Decisions(), kOrigin);
  EXPECT_THAT(text, HasSubstr("Coach connect\tCoach\t00:00:01.300\t00:00:01.800\t0.500\tcorner_1\n"));
  EXPECT_THAT(text, HasSubstr("Coach say\tCoach\t00:00:02.000\t00:00:02.500\t0.500\tWell done, builder!\n"));
  EXPECT_THAT(text, Not(HasSubstr("phase")));
  EXPECT_THAT(Told(ParseElan(text, kOrigin)),
              ElementsAre("1250 connect|corner_1||AK", "2000 wrong|unknown||AK", "3000 disconnect|corner_1||AK",
                          "3500 note||tabs and <b>, \"quotes\"|AK"));
}

TEST(Boris, WhatIsExportedComesBackWithoutWhatCoachWrote) {
  const std::string text = BorisCsv(Some(), Decisions(), kOrigin, "lesson");
  EXPECT_THAT(text, HasSubstr("lesson,Coach,Coach connect,Coach,corner_1,POINT,1.300,\n"));
  EXPECT_THAT(Told(ParseBoris(text, kOrigin)),
              ElementsAre("1250 connect|corner_1||AK", "2000 wrong|unknown||AK", "3000 disconnect|corner_1||AK",
                          "3500 note||tabs\tand <b>, \"quotes\"|AK"));
}

TEST(AnnotationFiles, NoTimeIsTooOddToBeRead) {
  for (const char* time : {"-1", "1:2:3:4", "1e99", "", ":", "x"}) {
    EXPECT_EQ(ParseElan(std::string("Tier\tBegin Time\tAnnotation\nconnect\t") + time + "\tc\n", kOrigin).unreadable, 1)
        << time;
  }
}

}  // namespace
}  // namespace coach
