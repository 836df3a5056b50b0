// Sizing, calibration, campaigns and batches.
#pragma once

#include <pybind11/pybind11.h>

namespace twinchute::python {

void bind_studies(pybind11::module_& module);

}  // namespace twinchute::python
