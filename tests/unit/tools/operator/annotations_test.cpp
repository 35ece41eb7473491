#include "tools/operator/annotations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

namespace coach {
namespace {

using testing::HasSubstr;

std::filesystem::path Fresh(const std::string& name) {
  const auto file = std::filesystem::temp_directory_path() / (name + std::to_string(getpid()) + ".jsonl");
  std::filesystem::remove(file);
  return file;
}

Annotation Event(const std::string& subject) { return {5'000'000, 0, "M", "connect", subject, "", 0}; }

TEST(AnnotationBook, GoesOnWhereTheFileEnds) {
  const auto file = Fresh("goes_on");
  int64_t first = 0;
  {
    AnnotationBook book(file);
    first = book.Add(Event("c1"), 100).id;
    EXPECT_EQ(first, 100);
  }
  AnnotationBook book(file);
  const Annotation second = book.Add(Event("<b>c2</b>\n\"γ\""), 50);
  EXPECT_GT(second.id, first) << "ids grow even if the clock was set back";
  const auto current = AnnotationBook(file).Current(10);
  ASSERT_EQ(current.size(), 2u);
  EXPECT_EQ(current[0].subject, "c1");
  EXPECT_EQ(current[1].subject, "<b>c2</b>\n\"γ\"");
  std::filesystem::remove(file);
}

TEST(AnnotationBook, ACorrectionTakesThePlaceOfWhatItCorrects) {
  AnnotationBook book("");
  const Annotation first = book.Add(Event("c1"), 1);
  Annotation later = first;
  later.utime += 500'000;
  later.replaces_id = first.id;
  const Annotation second = book.Add(later, 2);
  ASSERT_EQ(book.Current(10).size(), 1u);
  EXPECT_EQ(book.Current(10)[0].utime, 5'500'000);
  Annotation gone = second;
  gone.kind = "removed";
  gone.replaces_id = second.id;
  book.Add(gone, 3);
  EXPECT_TRUE(book.Current(10).empty());
}

TEST(AnnotationBook, KeepsTheNewestOfMany) {
  AnnotationBook book("");
  for (int k = 0; k < 20; ++k) book.Add(Event(std::to_string(k)), k);
  const auto current = book.Current(3);
  ASSERT_EQ(current.size(), 3u);
  EXPECT_EQ(current[0].subject, "17");
  EXPECT_EQ(current[2].subject, "19");
}

TEST(AnnotationBook, ABrokenLineIsCountedAndTheRestIsRead) {
  const auto file = Fresh("broken");
  AnnotationBook(file).Add(Event("c1"), 1);
  std::ofstream(file, std::ios::app) << "{\"utime\": \n{\"id\": 3}\n";
  AnnotationBook book(file);
  EXPECT_EQ(book.unreadable_lines(), 2u);
  EXPECT_EQ(book.Current(10).size(), 1u);
  std::filesystem::remove(file);
}

TEST(AnnotationBook, SaysWhichFileCantBeWrittenAndKeepsNothing) {
  AnnotationBook book("/nonexistent/folder/notes.jsonl");
  try {
    book.Add(Event("c1"), 1);
    FAIL();
  } catch (const std::runtime_error& e) {
    EXPECT_THAT(e.what(), HasSubstr("/nonexistent/folder/notes.jsonl"));
  }
  EXPECT_TRUE(book.Current(10).empty());
}

TEST(AnnotationBook, OnlyKnownKindsAndTextsOfSomeLength) {
  EXPECT_EQ(ProblemOf(Event("c1")), "");
  Annotation odd = Event("c1");
  odd.kind = "explode";
  EXPECT_NE(ProblemOf(odd), "");
  EXPECT_NE(ProblemOf(Event(std::string(5000, 'x'))), "");
}

}  // namespace
}  // namespace coach
