// The fake NAO with a part in its right hand, and a tracker of station T that sees it at 30 Hz, for tests of the page.
// Prints the robot's address and then runs until its standard input is closed.
#include <poll.h>

#include <cstdio>

#include "drawn_tracker.h"

int main() {
  using namespace coach;
  const FakeQiServer robot;
  DrawnTracker tracker(robot, "T", MakePose(ExpRotation(Vector3(0.01, 0.03, 1.5)), Vector3(0.06, -0.48, 0.05)),
                       Vector3(0.02, -0.01, 0.015));
  std::printf("%s\n", robot.url().c_str());
  std::fflush(stdout);
  for (pollfd input{0, POLLIN, 0}; poll(&input, 1, 33) == 0;) tracker.Send();
  for (const std::string& violation : robot.Violations()) std::printf("violation: %s\n", violation.c_str());
}
