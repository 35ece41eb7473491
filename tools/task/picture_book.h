// The steps of a task as pictures for children: one page a step, the new part set off from what is there.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "common/assembly/task.h"

namespace coach {

/// A part of a picture.
struct DrawnPart {
  int type = 0;                  ///< index into Task::types
  Pose X_FP = Pose::Identity();  ///< metres; z up
  bool is_new = false;           ///< drawn strong, with a rim; the others pale, if there is a new one
};

/// Parts from above at a slant, on white. CV_8UC3, `width` px wide and as high as it needs.
cv::Mat DrawParts(const Task& task, const std::vector<DrawnPart>& parts, int width);

struct BookPage {
  std::string name;  ///< cover, step_1, step_2, ...
  std::string svg;   ///< whole file, pictures inside
};

/// The finished structure and all parts, as SVG.
std::string CoverOf(const Task& task);

/// The cover, then a page for each step of the task's own connections (Task::steps), then the whole.
std::vector<BookPage> PictureBook(const Task& task);

/// All pages in one HTML file, one a sheet when printed.
std::string BookHtml(const Task& task, const std::vector<BookPage>& pages);

}  // namespace coach
