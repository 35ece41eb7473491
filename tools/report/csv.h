// Tables of text, as spreadsheets and annotation programs write them (RFC 4180).
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace coach {

using CsvRow = std::vector<std::string>;

/// Rows of `text`; empty lines are left out. Quoted fields may hold separators, line breaks and doubled quotes. Line
/// ends may be LF or CRLF; a byte order mark is skipped; an open quote ends with the text.
std::vector<CsvRow> ParseCsv(std::string_view text, char separator = ',');

/// One line with its end. A field that begins like a formula (= + - @) and is no number gets a leading apostrophe, so
/// that no spreadsheet runs what somebody typed.
std::string CsvLine(const CsvRow& row, char separator = ',');

/// Column whose name is one of `names` (case and surrounding blanks don't matter); -1 none.
int FindColumn(const CsvRow& header, const std::vector<std::string>& names);

/// Without blanks at both ends.
std::string Trimmed(std::string_view text);
/// ASCII letters in lower case.
std::string Lowered(std::string_view text);

}  // namespace coach
