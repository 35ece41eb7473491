// Pieces of an SVG picture, as text. Coordinates are written with one digit behind the point.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace coach::svg {

/// Safe between tags and within quotes of HTML and SVG; control characters and broken UTF-8 become U+FFFD.
std::string Escaped(std::string_view text);

/// At most so many characters, the last an ellipsis if some are left out.
std::string Shortened(std::string_view text, size_t characters);

/// Shapes take a class of the page's style sheet, and a title that is shown where the pointer rests (may be empty).
std::string Rect(double x, double y, double width, double height, const std::string& style,
                 const std::string& title = "");
std::string Line(double x1, double y1, double x2, double y2, const std::string& style);
std::string Circle(double x, double y, double radius, const std::string& style, const std::string& title = "");
/// M x,y then straight lines. @param closed back to the first point
std::string Path(const std::vector<std::pair<double, double>>& points, bool closed, const std::string& style,
                 const std::string& title = "");
std::string Text(double x, double y, std::string_view text, const std::string& style);
/// The picture, as wide as the page lets it be. @param label what it shows, for who can't see it
std::string Picture(double width, double height, const std::string& label, const std::string& content);

/// Steps between marks on an axis: 1, 2 or 5 times a power of ten, at most `most` marks over the range.
double RoundStep(double range, int most);
/// The same for times in s: 1, 2, 5, 10, 15, 30, 60, 120, 300 ..
double RoundTimeStep(double range, int most);

}  // namespace coach::svg
