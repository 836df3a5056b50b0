// Exceptions of the toolkit as those of Python.
#pragma once

#include <pybind11/pybind11.h>

namespace twinchute::python {

struct RecordObject;

/// SceneError, UsageError, RecordError and WriteError become the exceptions of those names, which the package
/// defines.
void translate_errors();

/// Throws RunError, which holds the record, for a run that ended in a numerical failure.
void require_success(const RecordObject& record);

}  // namespace twinchute::python
