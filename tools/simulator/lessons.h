// Scenarios in which a child builds the task's structure; ScenarioNames() says what each is.
#pragma once

#include "tools/simulator/making.h"

namespace coach {

void Build(Making* m);
void Ready(Making* m);
void BuildWithJolts(Making* m);
void BuildOfShinyParts(Making* m);
void BuildOfOneColour(Making* m);
void BuildNoisy(Making* m);

}  // namespace coach
