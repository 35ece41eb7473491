// A report on a fixed lesson is what it was, byte for byte. Where it has changed on purpose: look at it, then copy what
// the failing test names over tests/unit/tools/report/golden.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "temporary_folder.h"
#include "tools/report/annotation_files.h"
#include "tools/report/page.h"
#include "tools/report/report.h"
#include "tools/report/session_files.h"
#include "tools/report/tables.h"
#include "written_lesson.h"

namespace coach {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

const fs::path kGolden = COACH_SOURCE_DIR "/tests/unit/tools/report/golden";

std::map<std::string, std::string> Files(const std::vector<fs::path>& sessions) {
  std::vector<Session> read;
  for (const fs::path& s : sessions) read.push_back(ReadSession(s));
  const auto answers = ParseQuestionnaire("participant,Was it fun?\nc1,5\nc2,4\nc3,5\n");
  const Report report = MakeReport(std::move(read), answers, {1, 200});
  const Session& first = report.sessions[0].session;
  return {{"events.csv", EventsCsv(report)},
          {"trials.csv", TrialsCsv(report)},
          {"table1.csv", Table1Csv(report)},
          {"incidents.csv", IncidentsCsv(report)},
          {"questionnaire.csv", QuestionnaireCsv(report.questionnaire)},
          {"annotations.elan.txt", ElanText(first.annotations, first.events, first.begin)},
          {"annotations.boris.csv", BorisCsv(first.annotations, first.events, first.begin, first.name)},
          {"report.html", PageHtml(report)}};
}

class GoldenTest : public testing::Test {
 protected:
  GoldenTest() { WrittenLesson(log_).Play(); }
  const TemporaryFolder folder_;
  const fs::path log_ = folder_.path() / "lesson <1>.lcm";
};

TEST_F(GoldenTest, TheReportIsWhatItWas) {
  const fs::path actual = fs::temp_directory_path() / "coach-report-actual";
  for (const auto& [name, text] : Files({log_})) {
    fs::path file = kGolden / name;
    const std::string expected = fs::exists(file) ? ReadFile(file) : "";
    if (text == expected) continue;
    fs::create_directories(actual);
    std::ofstream(actual / name, std::ios::binary) << text;
    ADD_FAILURE() << name << " has changed; compare " << file << " with " << actual / name;
  }
}

TEST_F(GoldenTest, TheSameLogGivesTheSameBytesAndSoDoTwoOfThem) {
  EXPECT_EQ(Files({log_}), Files({log_}));
  const fs::path second = folder_.path() / "second.lcm";
  fs::copy(log_, second);
  const auto both = Files({log_, second});
  EXPECT_EQ(both, Files({log_, second}));
  EXPECT_THAT(both.at("table1.csv"), HasSubstr("bootstrap"));
}

TEST_F(GoldenTest, NoNameBecomesMarkup) {
  const std::string page = Files({log_}).at("report.html");
  for (const char* bad : {"<script", "<b>test", "<child>", "<is>", "lesson <1>", "onerror", "http://", "https://"})
    EXPECT_THAT(page, Not(HasSubstr(bad)));
  EXPECT_THAT(page, HasSubstr("rectangle_&lt;b&gt;test"));
  EXPECT_THAT(page, HasSubstr("Μαρία &amp; co"));
}

TEST_F(GoldenTest, EmptyCutAndForeignLogsGiveAPageThatSaysSo) {
  const fs::path empty = folder_.path() / "empty.lcm";
  { LogWriter writer(empty); }
  EXPECT_THAT(Files({empty}).at("report.html"), HasSubstr("the recording is empty"));
  fs::resize_file(log_, fs::file_size(log_) / 2);
  const std::string cut = Files({log_}).at("report.html");
  EXPECT_THAT(cut, HasSubstr("cut off or damaged"));
  EXPECT_THAT(cut, HasSubstr("not completed"));
}

}  // namespace
}  // namespace coach
