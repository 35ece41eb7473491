#include "services/capture/capture_options.h"

#include <gmock/gmock.h>

#include "services/capture/open_source.h"

namespace coach {
namespace {

using testing::HasSubstr;

CaptureOptions Read(const std::string& yaml) {
  return ReadCaptureOptions(YamlNode::Parse(yaml, "station.yaml"), "/etc/coach/A");
}

std::string ErrorOf(const std::string& yaml) {
  try {
    CheckSource(Read(yaml));
  } catch (const ConfigurationError& e) {
    return e.what();
  }
  return "";
}

TEST(CaptureOptions, AreReadWithDefaults) {
  const CaptureOptions none = Read("{}");
  EXPECT_EQ(none.source, "openni2:");
  EXPECT_FALSE(none.intrinsics);
  const CaptureOptions all = Read(
      "{source: 'scene:recordings/a', fps: 15, jpeg_quality: 80, intrinsics: {width: 640, height: 480, fx: 525, fy: "
      "526, cx: 319.5, cy: 239.5, "
      "distortion: [0.1, 0, 0, 0, 0]}}");
  EXPECT_EQ(all.source, "scene:/etc/coach/A/recordings/a");
  EXPECT_EQ(all.fps, 15);
  EXPECT_EQ(all.jpeg_quality, 80);
  ASSERT_TRUE(all.intrinsics);
  EXPECT_EQ(all.intrinsics->fy, 526);
  EXPECT_EQ(all.intrinsics->distortion[0], 0.1);
  EXPECT_EQ(Read("{source: 'oni:/data/x.oni'}").source, "oni:/data/x.oni");
}

TEST(CaptureOptions, MistakesAreNamed) {
  EXPECT_THAT(ErrorOf("{jpeg_quality: 101}"), HasSubstr("jpeg_quality"));
  EXPECT_THAT(ErrorOf("{colour: red}"), HasSubstr("colour"));
  EXPECT_THAT(ErrorOf("{source: 'usb:0'}"), testing::AllOf(HasSubstr("usb:0"), HasSubstr("scene:FOLDER")));
  EXPECT_THAT(ErrorOf("{source: 'scene:'}"), HasSubstr("scene:"));
  EXPECT_THAT(ErrorOf("{intrinsics: {width: 640, height: 480, fx: -1, fy: 1, cx: 1, cy: 1}}"), HasSubstr("intrinsics"));
  EXPECT_THAT(ErrorOf("{intrinsics: {width: 640, height: 480, fx: 500, fy: 500, cx: 320, cy: 240, distortion: [1]}}"),
              HasSubstr("5 numbers"));
}

}  // namespace
}  // namespace coach
