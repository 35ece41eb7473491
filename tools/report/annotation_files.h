// Annotations in the files of other programs. Times there are seconds of a video; `origin` (us, data time) is where the
// video begins.
//
// ELAN, tab-delimited text: one line an annotation; tier, participant, begin, end, duration, annotation. BORIS, tabular
// events (csv): one row an event, with the columns Time, Behavior, Subject, Modifier #1 (or Modifiers) and Comment.
//
// What an annotation means: the tier's or behaviour's name is its kind (connect, wrong, disconnect, note; also
// connection, wrong_connect, mistake, undone), ELAN's annotation text or BORIS's modifier is the connection's name. A
// tier of another name may hold texts such as "connect corner_1". What is neither becomes a note. Participant or
// Subject is the annotator. Tiers and behaviours that begin with "Coach " are what Coach itself wrote there and are
// left out.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/assembly/assembly_state.h"
#include "tools/operator/annotations.h"

namespace coach {

struct ImportedAnnotations {
  std::vector<Annotation> annotations;  ///< by time
  int unreadable = 0;                   ///< lines without a time
};

/// With or without a line of column names; times as hh:mm:ss.mmm, seconds with a point, or whole milliseconds.
ImportedAnnotations ParseElan(std::string_view text, int64_t origin);

/// Lines before the one that names the columns are skipped. @throws std::invalid_argument if no line names a time and a
/// behaviour.
ImportedAnnotations ParseBoris(std::string_view text, int64_t origin);

/// The events of a recorded or simulated scene (JSON): {"events": [{"time": s, "type": "connect" | "wrong_connect" |
/// "disconnect", "connection": name}, ..]}. Other types are left out. @throws std::invalid_argument
ImportedAnnotations ParseSceneEvents(std::string_view text, int64_t origin);

/// People's annotations, and beside them what Coach decided and said (tiers "Coach ..").
std::string ElanText(const std::vector<Annotation>& annotations, const std::vector<GuidanceEvent>& events,
                     int64_t origin);
std::string BorisCsv(const std::vector<Annotation>& annotations, const std::vector<GuidanceEvent>& events,
                     int64_t origin, const std::string& observation);

}  // namespace coach
