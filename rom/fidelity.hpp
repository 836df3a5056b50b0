// The reduced-order model as a row for whoever runs or compares models.
#pragma once

#include "lib/solve/fidelity.hpp"

namespace twinchute::rom {

/// Rigid two-body trajectory with filling-time inflation; named "rom".
const Fidelity& rom_fidelity();

}  // namespace twinchute::rom
