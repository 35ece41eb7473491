// Scenarios of one hard case each; ScenarioNames() says what each is.
#pragma once

#include "tools/simulator/making.h"

namespace coach {

void HiddenStill(Making* m);
void HiddenMoving(Making* m);
void PassOver(Making* m);
void Touching(Making* m);
void Fast(Making* m);
void LeaveAndReturn(Making* m);
void HandedOver(Making* m);
void HalfCovered(Making* m);

}  // namespace coach
