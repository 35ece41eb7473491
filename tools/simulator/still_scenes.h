// Scenarios without a child: the parts lie still; ScenarioNames() says what each is.
#pragma once

#include "tools/simulator/making.h"

namespace coach {

void Fig4(Making* m);
void Start(Making* m);

}  // namespace coach
