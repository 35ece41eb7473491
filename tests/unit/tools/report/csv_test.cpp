#include "tools/report/csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace coach {
namespace {

using testing::ElementsAre;

TEST(Csv, QuotesSeparatorsAndLineEnds) {
  EXPECT_THAT(ParseCsv("a,\"b, \"\"c\"\"\nd\",\r\n\r\n1,,3"),
              ElementsAre(CsvRow{"a", "b, \"c\"\nd", ""}, CsvRow{"1", "", "3"}));
  EXPECT_THAT(ParseCsv("\xEF\xBB\xBFx;y", ';'), ElementsAre(CsvRow{"x", "y"}));
  EXPECT_THAT(ParseCsv(""), ElementsAre());
  EXPECT_THAT(ParseCsv("\"open"), ElementsAre(CsvRow{"open"}));
}

TEST(Csv, WhatIsWrittenIsReadAgain) {
  std::mt19937 random(3);
  const std::string letters = "ab,;\"\n' \tα";
  for (int i = 0; i < 500; ++i) {
    CsvRow row{"first"};
    for (int k = 0; k < 4; ++k) {
      std::string field = "x";
      for (auto n = random() % 6; n > 0; --n) field += letters[random() % letters.size()];
      row.push_back(field);
    }
    EXPECT_THAT(ParseCsv(CsvLine(row)), ElementsAre(row));
  }
}

TEST(Csv, NoFormulaIsHandedToASpreadsheet) {
  EXPECT_EQ(CsvLine({"=SUM(A1)", "-1.5", "@x", "+cmd", "-"}), "'=SUM(A1),-1.5,'@x,'+cmd,'-\n");
}

TEST(Csv, ColumnsAreFoundByAnyOfTheirNames) {
  const CsvRow header{"Observation id", " TIME ", "Modifiers"};
  EXPECT_EQ(FindColumn(header, {"time"}), 1);
  EXPECT_EQ(FindColumn(header, {"Modifier #1", "Modifiers"}), 2);
  EXPECT_EQ(FindColumn(header, {"Behavior"}), -1);
}

}  // namespace
}  // namespace coach
